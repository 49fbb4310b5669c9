"""A companion comes as far as its run, or stops because of its cost and says so."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.simulate_lanes import run_lanes
from modelgen.scene import python_scenes as make
from tests.benchmarks.companions import KINDS, toss
from tests.running import library_of, scene_of, with_velocity

CHEAP = Accuracy.balanced().with_thresholds(companion_cost=0.5)


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_the_companion_of_a_tossed_solid_does_not_end_before_its_run(kind: str, seed: int) -> None:
    each = toss(kind, seed)
    assert each.path.outcome.succeeded
    assert not each.stopped
    assert each.cost < 2.2


@cache
def spinning_ball() -> Library:
    ball = make.dynamic("ball", make.sphere(0.1), density=500.0, position=[0.0, 0.0, 0.1005])
    bodies = [make.fixed("floor", make.plane()), ball]
    return library_of(
        make.scene("spinning_ball", bodies, contacts={"between": "all", "friction": 0.3, "restitution": 1.0})
    )


@pytest.mark.parametrize("seed", range(4))
def test_the_error_of_steps_from_bounce_to_bounce_shows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    spin = [0.0, 0.0, rng.uniform(15.0, 25.0)]  # about the normal, where a point has no friction
    library = with_velocity(spinning_ball(), "ball", [0.0, 0.0, -rng.uniform(0.2, 0.4), *spin])
    path = simulate(library, until=1.0, samples=6, accuracy="fast")
    assert sum(event.kind == "impact" for event in path.events) > 0.8 * path.steps
    turns = Rotation.from_rotvec(np.outer(path.t, spin)).as_quat(scalar_first=True)
    sign = np.sign((path.quaternion[:, 1] * turns).sum(axis=1, keepdims=True))
    off = 4 * np.arcsin(np.linalg.norm(path.quaternion[:, 1] - sign * turns, axis=1) / 2)
    assert off.max() > 1e-9
    assert (off < path.rotation_error).all()
    assert (path.rotation_error < 10 * np.maximum.accumulate(off) + 1e-14).all()


def test_a_companion_that_costs_too_much_stops_and_the_run_is_not_trusted() -> None:
    path, full = (
        simulate(scene_of("rattleback"), until=5.0, samples=20, accuracy=accuracy)
        for accuracy in (CHEAP, Accuracy.balanced())
    )
    assert path.estimate is not None
    assert full.estimate is not None
    assert path.estimate.rhs_evals < 0.7 * full.estimate.rhs_evals
    assert any("the companion run was stopped at" in doubt for doubt in path.doubts)
    assert not any("was stopped" in doubt for doubt in full.doubts)
    known = np.isfinite(path.position_error)
    assert known.any()
    assert not known.all()


def test_the_companion_of_a_lane_stops_where_that_of_a_run_does() -> None:
    library = scene_of("rattleback")
    alone = simulate(library, until=5.0, samples=1, accuracy=CHEAP)
    (lane,) = run_lanes([library], until=5.0, accuracies=[CHEAP]).results()
    assert lane.doubts == alone.doubts
