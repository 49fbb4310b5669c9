"""Boxes that fall on each other by time-stepping: none is in another, by separating axes of their poses."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.running import library_of

EDGE, BOXES = 0.07, 5


@cache
def pile() -> Library:
    rng = np.random.default_rng(7)
    boxes = [
        make.dynamic(
            f"b{i}",
            make.box(EDGE, EDGE, EDGE),
            density=1000.0,
            position=[*map(float, rng.uniform(-0.02, 0.02, 2)), 0.06 + 0.11 * i],
            rpy=[*map(float, rng.uniform(-0.6, 0.6, 3))],
        )
        for i in range(BOXES)
    ]
    bodies = [make.fixed("floor", make.plane()), *boxes]
    return library_of(make.scene("pile", bodies, contacts={"between": "all", "friction": 0.5}))


def thrown(seed: int) -> Library:
    """The pile with random velocities at the start, downwards in the mean."""
    rng, library = np.random.default_rng(seed), pile()
    u = np.array(library.manifest.instance["initial_u"], dtype=float)
    for i in range(BOXES):
        fall = -rng.uniform(0.0, 0.5 * (i + 1))
        u[6 * i : 6 * i + 6] = [*rng.uniform(-0.5, 0.5, 2), fall, *rng.normal(0, 4, 3)]
    return library.with_instance(library.manifest.instance | {"initial_u": u.tolist()})


def depth(p: np.ndarray, R: np.ndarray, other_p: np.ndarray, other_R: np.ndarray) -> float:
    """m: by how much two cubes overlap along the axis along which they do so least; negative where apart."""
    axes = [*R.T, *other_R.T, *(np.cross(a, b) for a in R.T for b in other_R.T)]
    least = np.inf
    for axis in axes:
        size = np.linalg.norm(axis)
        if size < 1e-6:
            continue
        n = axis / size
        reach = EDGE / 2 * (np.abs(R.T @ n).sum() + np.abs(other_R.T @ n).sum())
        least = min(least, reach - abs(n @ (other_p - p)))
    return float(least)


def deepest(path: Trajectory) -> float:
    """m: the deepest penetration at the end of the last step; samples between lie on chords."""
    at = [path.body_names.index(f"b{i}") for i in range(BOXES)]
    p, R = path.p[-1, at], Rotation.from_quat(path.quaternion[-1, at], scalar_first=True).as_matrix()
    below = max(EDGE / 2 * np.abs(R[i][2]).sum() - p[i][2] for i in range(BOXES))
    return max(below, *(depth(p[i], R[i], p[j], R[j]) for i, j in combinations(range(BOXES), 2)))


CASES = [(1, 0.003, 0.2), (2, 0.005, 0.2), (3, 0.003, 0.2), (3, 0.005, 0.14), (5, 0.002, 0.16)]


@pytest.mark.parametrize(("seed", "step", "end"), CASES)
def test_no_box_is_in_another(seed: int, step: float, end: float) -> None:
    path = simulate(
        thrown(seed),
        until=end,
        method="time-stepping",
        step=step,
        accuracy="fast",
        samples=1,
        estimate=False,
    )
    assert path.outcome.succeeded
    assert path.penetration_max < 1e-9
    assert deepest(path) < 1e-9
