"""The normal of a contact that presses parts the two bodies, if these are convex: by their corners."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import linprog

from modelgen import simulate
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.benchmarks.many_contacts import DOMINO, dominoes, heap
from tests.running import library_of

CHORD = 2e-3  # m: samples within steps lie on chords, with the forces of the step
CORNERS = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T


def overlap_along_normals(path: Trajectory, sizes: dict[str, tuple[float, float, float]]) -> float:
    """m: the largest overlap of two boxes, or of a box and the floor, along the normal of a contact that
    presses, at any sample."""
    index, found = {name: k for k, name in enumerate(path.body_names)}, []
    names = [re.split("[:#]", name)[0].split("-") for name in path.contact_names]
    for k, i in np.argwhere(path.force > 0):
        if not set(names[i]) <= {*sizes, "floor"}:
            continue
        ranges = [along(path, k, index[name], sizes.get(name), path.normals[k, i]) for name in names[i]]
        (low, high), (other_low, other_high) = ranges
        found.append(min(high - other_low, other_high - low))
    assert len(found) > 20
    return float(max(found))


def along(
    path: Trajectory, sample: int, body: int, size: tuple[float, float, float] | None, normal: np.ndarray
) -> tuple[float, float]:
    """m: the least and the largest height of a box, or of the ground below z = 0, along a normal."""
    if size is None:  # along any other normal it has no end
        assert abs(normal[2]) > 1 - 1e-12
        return (-np.inf, 0.0) if normal[2] > 0 else (0.0, np.inf)
    R = rotation_of(path.quaternion[sample, body].tolist())
    heights = (path.p[sample, body] + (CORNERS * size) @ R.T) @ normal
    return float(heights.min()), float(heights.max())


def depth(path: Trajectory, sample: int, pair: tuple[int, int]) -> float:
    """m: the radius of the largest ball in both of two dominoes; negative where they are apart."""
    sides = []
    for body in pair:
        R = rotation_of(path.quaternion[sample, body].tolist())
        normals = np.vstack([R.T, -R.T])
        sides.append((normals, normals @ path.p[sample, body] + np.array([*DOMINO, *DOMINO]) / 2))
    A, b = np.vstack([each[0] for each in sides]), np.concatenate([each[1] for each in sides])
    found = linprog([0, 0, 0, -1], np.column_stack([A, np.ones(len(A))]), b, bounds=[(None, None)] * 4)
    return float(-found.fun)


@pytest.mark.cases(12)
@pytest.mark.parametrize("seed", range(24))
def test_in_a_row_of_dominoes(seed: int) -> None:
    """Their sides are flush to 1e-13 to 1e-3 m and rad: a corner that leaves a face there comes on none that
    it does not face, and no contact is lost."""
    rng, count = np.random.default_rng(seed), 6
    scene = dominoes(count, 10.0 ** rng.uniform(-13, -3) * rng.normal(size=(count, 2)))
    path = simulate(
        library_of(scene), until=1.5, accuracy="fast", method="time-stepping", step=0.005, samples=300,
        estimate=False,
    )  # fmt: skip
    assert path.outcome.succeeded
    assert path.penetration_max < 1e-9
    assert overlap_along_normals(path, {f"d{i}": DOMINO for i in range(count)}) < CHORD
    first = path.body_names.index("d0")
    for k in range(0, len(path.t), 20):
        assert max(depth(path, k, (first + i, first + i + 1)) for i in range(count - 1)) < CHORD


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(4))
def test_in_a_heap(seed: int) -> None:
    scene = heap(6, seed, "box")
    path = simulate(
        library_of(scene), until=0.8, accuracy="fast", method="time-stepping", step=0.005, samples=80,
        estimate=False,
    )  # fmt: skip
    names = [body.name for body in scene.bodies if body.motion == "dynamic"]
    assert path.outcome.succeeded
    assert overlap_along_normals(path, dict.fromkeys(names, (0.07, 0.07, 0.07))) < CHORD


@pytest.mark.cases(3)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("method", ["time-stepping", "dop853"])
def test_no_corner_leaves_a_room(seed: int, method: str) -> None:
    """A box in a hollow box: its walls are planes whose material is on the side of their axis."""
    rng, room = np.random.default_rng(seed), 0.5
    q = rng.normal(size=4)
    box = make.dynamic(
        "box", make.box(*DOMINO), density=1000.0, quaternion=(q / np.linalg.norm(q)).tolist(),
        velocity=rng.uniform(-1, 1, 3).tolist(), angular_velocity=rng.uniform(-4, 4, 3).tolist(),
    )  # fmt: skip
    hollow = make.fixed("hollow", make.box(room, room, room, cavity=True))
    scene = make.scene("room", [hollow, box], contact=[{"between": ["box", "hollow"], "friction": 0.3}])
    step = 0.003 if method == "time-stepping" else None
    path = simulate(
        library_of(scene), until=0.5, accuracy="fast", method=method, step=step, samples=100, estimate=False
    )
    assert path.outcome.succeeded
    body, deepest = path.body_names.index("box"), 0.0
    for p, quaternion in zip(path.p[:, body], path.quaternion[:, body], strict=True):
        corners = p + (CORNERS * DOMINO) @ rotation_of(tuple(quaternion.tolist())).T
        deepest = max(deepest, float(np.abs(corners).max()) - room / 2)
    assert (path.force > 0).any()
    assert deepest < (CHORD if step else 1e-6)
