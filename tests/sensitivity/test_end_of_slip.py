"""Where slip ends, changes of its direction are quotients of two numbers that vanish."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

from modelgen import sensitivity
from modelgen.runtime import sensitivity as sensitivity_module
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


SHAPES = {  # shape, and how much faster its slip than its centre is slowed by friction
    "ball": ('{ kind = "sphere", radius = 0.1 }', 3.5),
    "block": ('{ kind = "box", size = [0.4, 0.4, 0.2] }', 1.0),
}


def scene(shape: str, speed: float, mu: float, along: str, up: str) -> str:
    """A body of 2 kg that slides on a floor, and the motion of this floor."""
    return f"""
[[body]]
name = "plate"
motion = "driven"
shape = {{ kind = "plane" }}
path = {{ position = ["{along}", "0.0", "{up}"] }}

[[body]]
name = "body"
shape = {shape}
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


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("seed", range(3))
def test_slip_that_ends_on_a_moving_floor(shape: str, seed: int) -> None:
    """The floor moves by x(t) along the slip and by z(t) upwards. With the slip s0 at the start, the velocity
    is v0 - mu (g t + z') until k mu (g t + z') = s0 - x' + x'(0), and then v0 - s0/k + (x' - x'(0))/k."""
    kind, k = SHAPES[shape]
    random = np.random.default_rng(seed)
    speed, mu, X, wx, Z, wz = random.uniform(
        [0.5, 0.2, 0.01, 4, 0.003, 4], [0.8, 0.3, 0.03, 10, 0.01, 10]
    ).tolist()
    text = scene(kind, speed, mu, f"{X!r}*sin({wx!r}*t)", f"{Z!r}*(1 - cos({wz!r}*t))")

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
    of, by = ["body.position", "body.velocity"], ["mu", "body.velocity"]
    if shape == "block":
        del by[1]  # it turns where slip across it is left
    found = sensitivity(differentiable(read_text(text, "scene.toml")), [t], of=of, by=by, accuracy="tight")
    columns = slice(len(by))  # by mu, and by the velocity along the slip
    assert found.verdict
    expected = np.array([[-fallen, end + left * (t - end)], [0, left]])[:, columns]
    assert found.jacobian[0, [0, 3], columns] == pytest.approx(expected, abs=1e-11)
    (event,) = found.events
    expected_times = np.array([k * normal(end) / slowed, -1 / slowed])
    exact = 1e-9 if shape == "ball" else 1e-6  # a block stops once it slips no faster than `slip_speed`
    assert event.t == pytest.approx(end, rel=exact)
    assert event.by[columns] == pytest.approx(expected_times[columns], rel=exact)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("steps", [1, sensitivity_module.STEPS])
def test_changes_across_slip_that_ends_on_a_moving_floor(
    seed: int, steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Slip s of a ball over a floor that moves along it. A slip c across it changes by c' = -k mu g c/s, so
    that c is a power of the time left, times a regular function; the velocity across changes by c'/k."""
    monkeypatch.setattr(sensitivity_module, "STEPS", steps)
    kind, k = SHAPES["ball"]
    random = np.random.default_rng(seed)
    speed, mu, X, w = random.uniform([0.5, 0.1, 0.01, 4], [0.8, 0.2, 0.03, 12]).tolist()
    text = scene(kind, speed, mu, f"{X!r}*sin({w!r}*t)", "0.0")
    slowed = k * mu * GRAVITY

    def slip(t: mp.mpf) -> mp.mpf:
        return speed - X * w * mp.cos(w * t) - slowed * t

    end = mp.findroot(slip, (speed - X * w) / slowed)
    power = slowed / (slowed - X * w**2 * mp.sin(w * end))

    def across(t: mp.mpf) -> mp.mpf:
        left = (1 - t / end) ** power
        return (
            left * mp.exp(mp.quad(lambda at: power / (end - at) - slowed / slip(at), [0, t]))
            if left
            else left
        )

    t = float(end) + 0.3
    of = ["body.position", "body.velocity"]
    library = differentiable(read_text(text, "scene.toml"))
    found = sensitivity(library, [t], of=of, by=["body.velocity"], accuracy="tight", estimate=False)
    assert found.verdict
    moved = float(t - (t - mp.quad(across, [0, end])) / k)
    assert found.jacobian[0, [1, 4], 1] == pytest.approx([moved, 1 - 1 / k], abs=1e-11)
