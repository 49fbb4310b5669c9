"""Loads with kinks and jumps: the first are differentiated where they are met, the second are told."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import gradient, sensitivity
from modelgen.codegen.library import Library
from tests.sensitivity.test_closed_forms import built, complex_step

BALL = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "ball"
mass = "heavy"
inertia = [0.008, 0.009, 0.01]
position = ["place", 0.0, 0.0]
velocity = ["fast", 0.0, 0.0]

[[input]]
name = "push"
default = 1.0

[[force]]
body = "ball"
force = ["FORCE", "0.0", "0.0"]
"""
BALL_VALUES = {"heavy": 2.0, "place": -0.2, "fast": 1.0}
BY = [*BALL_VALUES, "push"]


def pushed(force: str) -> Library:
    return built(BALL.replace("FORCE", force), BALL_VALUES)


@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
@pytest.mark.parametrize("t", [0.37, 0.5, 1.1])
def test_a_ball_that_runs_into_a_spring_and_out_of_it(t: float, accuracy: str) -> None:
    """The spring only pushes: free flight, half a sine, free flight."""

    def position(heavy: complex, place: complex, fast: complex, push: complex) -> complex:
        meets, w = -place / fast, np.sqrt(30 * push / heavy)
        leaves = meets + np.pi / w
        if t > leaves.real:
            return -fast * (t - leaves)
        return fast / w * np.sin(w * (t - meets))

    found = sensitivity(
        pushed("-30*push*max(0, x)"), t, of=["ball.position"], by=BY, accuracy=accuracy, estimate=False
    )
    assert found.verdict
    expected = complex_step(position, [*BALL_VALUES.values(), 1.0])
    assert np.allclose(found.jacobian[0, 0], expected, rtol=0, atol=2e-8 * np.max(np.abs(expected)))


MOTOR = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "wheel"
mass = 1.0
inertia = [0.5, 0.5, "heavy"]
angular_velocity = [0.0, 0.0, "spin"]

[[input]]
name = "stiff"
default = 2.0

[[joint]]
name = "motor"
kind = "revolute"
between = ["world", "wheel"]
position = [0.0, 0.0, 0.0]

[[actuator]]
joint = "motor"
force = "-stiff*rate"
limits = [-1.0, 1.0]
"""


@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
def test_an_actuator_at_its_limit(accuracy: str) -> None:
    """It brakes at its limit, then in proportion to the rate."""
    t, values = 1.3, {"heavy": 0.7, "spin": 1.9}

    def rate(heavy: complex, spin: complex, stiff: complex) -> complex:
        freed = (spin - 1 / stiff) * heavy
        return np.exp(-stiff / heavy * (t - freed)) / stiff

    library = built(MOTOR, values)
    by = [*values, "stiff"]
    found = sensitivity(library, t, of=["wheel.angular_velocity"], by=by, accuracy=accuracy, estimate=False)
    assert found.verdict
    expected = complex_step(rate, [*values.values(), 2.0])
    assert np.allclose(found.jacobian[0, 2], expected, rtol=0, atol=2e-8)
    numbers = ca.MX.sym("values", 1, 3)
    loss = ca.Function("loss", [numbers], [numbers[2]])
    slope = gradient(library, [t], loss, of=["wheel.angular_velocity"], by=by, accuracy=accuracy)
    assert slope.forward_difference < 1e-11
    assert np.allclose(slope.gradient, expected, rtol=0, atol=2e-8)


@pytest.mark.parametrize(
    ("force", "jumps"),
    [
        ("-3*sign(x)", True),
        ("-3*sign(x)*push", True),
        ("sign(vx - 0.9) - 2", True),
        ("-3*sign(x - 0.3*t)", True),
        ("1e-3*sign(x)", True),
        ("-3*sign(t - 0.3)", False),
        ("-3*sign(t - 0.3)*x", False),
        ("5*tanh(500*x)", False),
        ("5*exp(-300*t) + 3*sin(200*t)*x", False),
    ],
)
@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
def test_a_load_that_jumps_where_the_motion_takes_it(force: str, jumps: bool, accuracy: str) -> None:
    found = sensitivity(
        pushed(force), [0.05, 0.5], of=["ball.position"], by=["fast"], accuracy=accuracy, estimate=False
    )
    assert found.verdicts[0]
    assert bool(found.verdict) != jumps
    if jumps:
        assert found.verdict.reason == "a load jumps where the motion takes it"
        assert 0.05 < found.verdict.t < 0.5
