"""Lanes that run to their ends are runs of `start`, with the estimate and the doubts of `simulate`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, simulate, start
from modelgen.errors import SimulationError
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.simulate_lanes import run_lanes
from modelgen.runtime.trajectory import Outcome, Trajectory
from tests.parameter_study.scenes import ball
from tests.running import scene_of

SCENES = ("ellipsoid_on_plane", "cube_toss", "newton_cradle", "box_dropped", "balancing_wheel", "gears")
ROUNDING = 1e-9  # relative, of samples that are interpolated to the end, and of what follows from them


def whole(path: Trajectory) -> dict[str, Any]:
    """What a run says, without what it cost, warnings, and rounding of its state."""
    said = path.summary()
    estimate = said["estimate"] or {}
    kept = ("outcome", "events", "steps", "rejected", "trusted", "gap_max", "penetration_max", "energy_drift")
    return {name: said[name] for name in kept} | {"status": estimate.get("status")}


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", SCENES)
def test_a_lane_is_the_run_of_start_and_simulate(name: str) -> None:
    library = scene_of(name)
    instance = library.manifest.instance
    accuracy, until = accuracy_of(instance, None, {}), min(0.3, instance["run"]["until"])
    runs = run_lanes([library] * 2, until=until, accuracies=[accuracy] * 2)
    first, second = runs.results()
    assert isinstance(first, Trajectory)
    assert isinstance(second, Trajectory)
    assert whole(first) == whole(second)
    alone = start(library)
    events = alone.step(until)
    for key, at in (("p", "q"), ("v", "u")):
        for k, body in enumerate(instance["bodies"]):
            if body["motion"] in ("point", "free"):
                place = body[at] + (instance["n_q"] if at == "u" else 0)
                assert (getattr(first, key)[-1, k] == alone.state[place : place + 3]).all()
    assert len(first.events) == len(events)
    path = simulate(library, until=until, samples=1)
    assert whole(first) == whole(path)
    assert np.allclose(first.p, path.p, rtol=ROUNDING, atol=ROUNDING)
    assert np.allclose(first.sensors, path.sensors, rtol=1e-6, atol=1e-6, equal_nan=True)
    for key in ("position_error", "velocity_error", "spin_error", "rotation_error"):
        mine, theirs = getattr(first, key)[-1], getattr(path, key)[-1]
        assert mine == pytest.approx(theirs, rel=0.5, abs=1e-12)


def test_lanes_have_their_own_inputs_and_starts() -> None:
    library = ball()
    accuracy = Accuracy.balanced()
    place = library.manifest.instance["n_q"]  # of the first component of the velocity
    pushes, speeds = np.array([0.0, 1.0, -2.0]), np.array([0.5, 1.0, 0.7])
    runs = run_lanes(
        [library] * 3, until=0.4, accuracies=[accuracy] * 3, inputs={"push": pushes}, starts={place: speeds}
    )
    for path, push, speed in zip(runs.results(), pushes, speeds, strict=True):
        assert isinstance(path, Trajectory)
        assert path.inputs == {"push": push}
        instance = library.manifest.instance
        own = library.with_instance(instance | {"initial_u": [speed, *instance["initial_u"][1:]]})
        alone = simulate(own, until=0.4, samples=1, inputs={"push": float(push)}, accuracy=accuracy)
        assert np.allclose(path.p[-1], alone.p[-1], rtol=ROUNDING, atol=ROUNDING)
        assert replace(alone, estimate=None).outcome is path.outcome


def test_lanes_that_cannot_start_or_fail_leave_the_others_alone() -> None:
    library = ball()
    n_q = library.manifest.instance["n_q"]
    starts = {2: np.array([0.3, 0.02, 0.3]), n_q: np.array([1.0, 1.0, 2.0])}
    runs = run_lanes([library] * 3, until=0.5, accuracies=[Accuracy.balanced()] * 3, starts=starts)
    good, low, fast = runs.results()
    assert isinstance(good, Trajectory)
    assert good.outcome is Outcome.DONE
    assert isinstance(low, SimulationError)
    assert "interpenetrate" in str(low)
    assert "run 1" not in str(low)
    assert isinstance(fast, Trajectory)
    assert fast.outcome is Outcome.NOT_FINITE
    assert fast.p[-1, 1, 0] == pytest.approx(0.6, abs=0.05)  # of the last finite state
    assert fast.doubts
