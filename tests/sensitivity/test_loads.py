"""Loads with kinks and jumps are differentiated over them; loads that keep to a jump are told."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import gradient, sensitivity
from modelgen.codegen.library import Library
from modelgen.runtime.finite_differences import run_differences
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


OF = ["ball.position", "ball.velocity"]


@pytest.mark.parametrize(
    "force",
    [
        "-3*sign(x)", "-3*sign(x)*push", "sign(vx - 0.9) - 2", "-3*sign(x - 0.3*t)", "1e-3*sign(x)",
        "-3*sign(x - 0.1*push)", "-4*abs(x)*sign(x - 0.05)", "-3*sign(abs(x) - 0.1)", "-max(sign(x), 0.5*x)",
        "atan2(x - 0.05, -1 - x)", "-3*sign(t - 0.3)*x",
    ],
)  # fmt: skip
@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
def test_a_load_that_jumps_is_differentiated_over_the_jump(force: str, accuracy: str) -> None:
    """Against differences of runs; backwards against forwards."""
    library = pushed(force)
    found = sensitivity(library, 0.5, of=OF, by=BY, accuracy=accuracy)
    assert found.verdict
    expected = run_differences(library, 0.5, of=OF, by=BY, accuracy="tight")
    assert np.allclose(found.jacobian, expected, rtol=0, atol=2e-8)
    assert found.error is not None
    assert np.max(np.abs(found.jacobian - expected)) <= np.max(found.error) + 1e-8
    values = ca.MX.sym("values", 1, 6)
    loss = ca.Function("loss", [values], [values[0] + 0.3 * values[3]])
    back = gradient(library, [0.5], loss, of=OF, by=BY, accuracy=accuracy)
    assert np.allclose(back.gradient, found.jacobian[0, 0] + 0.3 * found.jacobian[0, 3], rtol=0, atol=1e-12)


@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
def test_the_time_of_a_jump_is_differentiated(accuracy: str) -> None:
    """3 N speed 2 kg up as far as x = 0.1 push, and brake them from there on."""
    t = 0.5

    def place(heavy: complex, place: complex, fast: complex, push: complex) -> complex:
        a = 3 / heavy
        way = 0.1 * push - place
        after = np.sqrt(fast**2 + 2 * a * way)
        left = t - (after - fast) / a
        return 0.1 * push + after * left - a * left**2 / 2

    found = sensitivity(
        pushed("-3*sign(x - 0.1*push)"), t, of=["ball.position"], by=BY, accuracy=accuracy, estimate=False
    )
    assert found.verdict
    expected = complex_step(place, [*BALL_VALUES.values(), 1.0])
    assert np.allclose(found.jacobian[0, 0], expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("force", ["5*tanh(500*x)", "5*exp(-300*t) + 3*sin(200*t)*x"])
@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
def test_a_load_that_changes_fast_does_not_jump(force: str, accuracy: str) -> None:
    assert sensitivity(pushed(force), 0.5, of=OF, by=["fast"], accuracy=accuracy, estimate=False).verdict


def test_a_load_that_keeps_to_its_jump_is_told() -> None:
    """Dry friction has stopped the ball: loads between those of both sides are not differentiated."""
    found = sensitivity(pushed("-9*sign(vx)"), [0.1, 0.5], of=OF, by=["fast"], estimate=False)
    assert found.verdicts[0]
    assert not found.verdict
    assert found.verdict.reason == "a load jumps where the motion takes it"
