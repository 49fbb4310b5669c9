"""Where slip ends, changes of its direction are quotients of two numbers that vanish."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from modelgen import sensitivity
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable, shipped

SPEED, MU, GRAVITY = 3.0, 0.2, 9.81
END = 2 * SPEED / (7 * MU * GRAVITY)  # s: from then on the ball rolls


@pytest.mark.parametrize("t", [END - 1e-2, END - 1e-4, END - 1e-6, 2 * END])
def test_derivatives_hold_shortly_before_the_end_of_slip_and_after_it(t: float) -> None:
    """Slip of a ball keeps its direction, so that friction slows a velocity across it as it slows the slip;
    how the ball is turned makes no difference."""
    library = shipped("sphere_slide_to_roll")
    of, by = ["ball.velocity"], ["ball.velocity", "ball.orientation"]
    found = sensitivity(library, [t], of=of, by=by, accuracy="tight")
    left = 1 - MU * GRAVITY * min(t, END) / SPEED
    assert found.verdict
    assert found.jacobian[0, 1] == pytest.approx([0, left, 0, 0, 0, 0], abs=1e-9)
    assert found.jacobian[0, 1, 1] == pytest.approx(left, rel=1e-12)


SHAPES = {  # shape; how much faster than its centre its slip is slowed; by what runs are differentiable
    "ball": ('{ kind = "sphere", radius = 0.1 }', 3.5, ["body.velocity", "mu"]),
    "block": (
        '{ kind = "box", size = [0.4, 0.4, 0.2] }',
        1.0,
        ["mu"],
    ),  # slip across does not die with the other
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("seed", range(3))
def test_slip_that_ends_on_a_moving_floor(shape: str, seed: int) -> None:
    """The floor moves by x(t) along the slip and by z(t) upwards. With the slip s0 at the start, the velocity
    is v0 - mu (g t + z') until k mu (g t + z') = s0 - x' + x'(0), and then v0 - s0/k + (x' - x'(0))/k."""
    kind, k, by = SHAPES[shape]
    random = np.random.default_rng(seed)
    speed, mu, X, wx, Z, wz = random.uniform(
        [0.5, 0.2, 0.01, 4, 0.003, 4], [0.8, 0.3, 0.03, 10, 0.01, 10]
    ).tolist()
    text = f"""
[[body]]
name = "plate"
motion = "driven"
shape = {{ kind = "plane" }}
path = {{ position = ["{X!r}*sin({wx!r}*t)", "0.0", "{Z!r}*(1 - cos({wz!r}*t))"] }}

[[body]]
name = "body"
shape = {kind}
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = [0.0, 0.0, 0.1]
velocity = [{speed!r}, 0.0, 0.0]

[[contact]]
between = ["body", "plate"]
friction = "mu"

[[parameter]]
name = "mu"
value = {mu!r}
"""

    def normal(t: float) -> float:
        """The impulse of the normal force, of the mass."""
        return GRAVITY * t + Z * wz * np.sin(wz * t)

    def slip(t: float) -> float:
        return speed - X * wx * np.cos(wx * t) - k * mu * normal(t)

    end = brentq(slip, 0, 0.5, xtol=1e-17)
    fallen = GRAVITY * end**2 / 2 + Z * (1 - np.cos(wz * end))
    slowed = X * wx**2 * np.sin(wx * end) - k * mu * (GRAVITY + Z * wz**2 * np.cos(wz * end))
    left = 1 - 1 / k  # of a change of velocity
    t = end + 0.3
    of, columns = ["body.position", "body.velocity"], [0, 3][: len(by)]
    found = sensitivity(differentiable(read_text(text, "scene.toml")), [t], of=of, by=by, accuracy="tight")
    assert found.verdict
    right = np.array([[end + left * (t - end), -fallen], [left, 0]])[:, -len(by) :]
    assert found.jacobian[0, [0, 3]][:, columns] == pytest.approx(right, abs=1e-11)
    times = next(event.by for event in found.events if abs(event.t - end) < 1e-9)
    assert times[columns] == pytest.approx([-1 / slowed, k * normal(end) / slowed][-len(by) :], rel=1e-9)
