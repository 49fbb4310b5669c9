"""Wheels that roll at a step, straight or not: their sides are parallel to those of the step, far away."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, ran

WHEELS = {
    "disc": {"kind": "disc", "radius": 0.1},
    "ring": {"kind": "circle", "radius": 0.1},
    "roller": {"kind": "cylinder", "radius": 0.1, "length": 0.05},
}


def rolled(wheel: Mapping[str, object], yaw: float) -> Trajectory:
    """At 1.5 m/s, from 0.3 m before the step to its edge."""
    step = make.fixed("step", make.box(1.0, 1.0, 0.02), position=[0.8, 0, 0.01], rpy=[0, 0, yaw])
    body = make.dynamic(
        "wheel", make.shape(**wheel), mass=1.0, inertia=[2.5e-3, 2.5e-3, 5e-3],  # type: ignore[arg-type]
        position=[0, 0, 0.1], rpy=[np.pi / 2, 0, 0], velocity=[1.5, 0, 0], angular_velocity=[0, 15.0, 0],
    )  # fmt: skip
    contact = [{"between": ["wheel", "table"], "friction": 0.5}, {"between": ["wheel", "step"]}]
    return ran([TABLE, step, body], 0.15, contact, Accuracy.balanced(), samples=5)


@pytest.mark.parametrize("wheel", WHEELS)
def test_a_wheel_that_rolls_straight_at_a_step_takes_no_shorter_steps(wheel: str) -> None:
    straight, askew = (rolled(WHEELS[wheel], yaw) for yaw in (0.0, 1e-3))
    for path in (straight, askew):
        assert path.outcome.succeeded
        assert path.p[-1, -1] == pytest.approx([0.225, 0.0, 0.1], abs=1e-12)
    assert straight.steps <= 2 * askew.steps
