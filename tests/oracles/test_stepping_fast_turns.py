"""Closest points in time-stepping where bodies turn so far in a step that they are found anew."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, start
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.scene import python_scenes as make
from tests.running import library_of

AXES = {"blade": (0.1, 0.01, 0.005), "disc": (0.1, 0.08, 0.005)}  # m
STEP, STEPS = 0.01, 40  # s, and their number
OTHERS = 5  # stones far away, so that there are more pairs of features than contacts before the pair
TURN = 2.6  # rad, of a body in a step


def separation(towards: Array, span: Array, turned: list[tuple[Array, Array]]) -> float:
    """Distance of two planes across a direction that enclose the gap of two ellipsoids, m."""
    n = towards / np.linalg.norm(towards)
    return float(span @ n) - sum(float(np.linalg.norm(axes * (R.T @ n))) for R, axes in turned)


def gap(span: Array, turned: list[tuple[Array, Array]]) -> float:
    """Distance of two ellipsoids that are apart: their largest separation over all directions, m."""
    directions = np.random.default_rng(0).normal(size=(400, 3))
    best = max(directions, key=lambda n: separation(n, span, turned))
    rules = {"xatol": 1e-9, "fatol": 1e-15, "maxiter": 4000}
    found = minimize(lambda n: -separation(n, span, turned), best, method="Nelder-Mead", options=rules)
    return -float(found.fun)


@pytest.mark.cases(1)
@pytest.mark.parametrize("scheme", ["stewart-trinkle", "moreau"])
def test_the_gap_of_two_ellipsoids_that_turn_fast_is_their_distance(scheme: str) -> None:
    """The pair with the bowl comes first and has several contacts, so that contacts and pairs of features are
    counted differently."""
    bodies = [
        make.dynamic(
            name,
            make.ellipsoid(*axes),
            density=500.0,
            position=[0.0, 0.12 * k, 0.5],
            angular_velocity=[TURN / STEP * (1 - 2 * k), 0.0, 0.3 * TURN / STEP],
        )
        for k, (name, axes) in enumerate(AXES.items())
    ]
    stones = [
        make.dynamic(f"stone{k}", make.ellipsoid(0.05, 0.04, 0.06), density=500.0, position=[3.0 + k, 0, 9.0])
        for k in range(OTHERS)
    ]
    contact = [{"between": ["bowl", name]} for name in AXES]
    contact += [{"between": list(pair)} for pair in combinations([*AXES, *(b.name for b in stones)], 2)]
    scene = make.scene(
        "turning",
        [make.fixed("bowl", make.paraboloid(1.0, 1.0)), *bodies, *stones],
        gravity=[0.0, 0.0, 0.0],
        contact=contact,
    )
    record = Accuracy.balanced().time_stepping(STEP, scheme)  # type: ignore[arg-type]
    sim = start(library_of(scene), accuracy=record)
    places = [body["q"] for body in sim.session.library.manifest.instance["bodies"][1:3]]
    for step in range(1, STEPS + 1):
        sim.step(until=step * STEP)
        p, q = zip(*[(sim.state[at : at + 3], sim.state[at + 3 : at + 7]) for at in places], strict=True)
        rotations = [Rotation.from_quat(each, scalar_first=True).as_matrix() for each in q]
        exact = gap(p[1] - p[0], list(zip(rotations, map(np.array, AXES.values()), strict=True)))
        assert sim.contacts["blade-disc"].gap == pytest.approx(exact, abs=1e-8), step
