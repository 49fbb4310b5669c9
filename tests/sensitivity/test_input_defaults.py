"""A parameter reaches a load through the default of an input, as long as the run is given no other value."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import fit, gradient, sensitivity
from modelgen.runtime.finite_differences import run_differences
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

SCENE = """
gravity = [0, 0, 0]
[[body]]
name = "ball"
mass = 1.6
inertia = [0.004, 0.004, 0.004]
[[parameter]]
name = "amp"
value = {amp}
[[parameter]]
name = "slope"
value = {slope}
[[input]]
name = "thrust"
default = "amp*amp + 0.3"
[[input]]
name = "drag"
default = "slope - 2*amp"
hold = "linear"
[[force]]
body = "ball"
force = ["thrust", "drag*t", "thrust*thrust"]
[[sensor]]
name = "p"
of = "ball.position"
"""
BY = ["amp", "slope", "thrust"]


def expected(t: float, amp: float, thrust: float, given: bool) -> Array:
    """Derivatives (3, 3) of the place of a mass that starts at rest: t^2/2m of a force, t^3/6m of t*force."""
    by_amp, half, sixth = 0.0 if given else 2 * amp, t**2 / 2 / 1.6, t**3 / 6 / 1.6
    return np.array(
        [
            [by_amp * half, 0, half],
            [-2 * sixth, sixth, 0],
            [2 * thrust * by_amp * half, 0, 2 * thrust * half],
        ]
    )


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_defaults_of_inputs_follow_from_parameters(seed: int, given: bool) -> None:
    random = np.random.default_rng(seed)
    amp, slope, t = random.uniform(0.2, 2.0, 3)
    library = differentiable(read_text(SCENE.format(amp=amp, slope=slope), "pushed.toml"))
    thrust = 0.7 if given else amp**2 + 0.3
    inputs = {"thrust": thrust} if given else None
    right = expected(t, amp, thrust, given)
    found = sensitivity(library, t, by=BY, inputs=inputs, accuracy="tight")
    assert found.verdict
    assert np.allclose(found.jacobian[0], right, rtol=1e-9, atol=1e-12)
    differences = run_differences(library, t, by=BY, inputs=inputs, accuracy="tight")
    assert np.allclose(differences[0], right, rtol=1e-7, atol=1e-9)
    values = ca.MX.sym("values", 1, 3)
    loss = ca.Function("loss", [values], [ca.mtimes(values, ca.DM([1.0, 2.0, 3.0]))])
    slope_of_loss = gradient(library, t, loss, by=BY, inputs=inputs, accuracy="tight").gradient
    assert np.allclose(slope_of_loss, [1, 2, 3] @ right, rtol=1e-9, atol=1e-12)


def test_a_fit_sees_a_parameter_through_an_input() -> None:
    library = differentiable(read_text(SCENE.format(amp=0.5, slope=0.2), "pushed.toml"))
    t = np.linspace(0.1, 1.0, 10)
    found = fit(library, {"t": t, "p_x": (0.9**2 + 0.3) * t**2 / 2 / 1.6}, by=["amp"])
    assert found.values == pytest.approx([0.9], abs=1e-8)
    assert np.all(np.isfinite(found.confidence.half_width))
