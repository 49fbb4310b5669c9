"""Gradients by going back equal derivatives by going forward."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import gradient, sensitivity
from modelgen.errors import SimulationError
from modelgen.scene.read import read_text
from tests.running import NAMES
from tests.sensitivity.differences import differentiable, shipped
from tests.sensitivity.test_closed_forms import BALL, BLOCK, DISC, ROD, built
from tests.sensitivity.test_differences import moving
from tests.stories.test_parameters import NUMBERS, with_parameter

SLOPPY = ("cube_toss", "painleve_rod", "ellipsoids_in_bowl")  # not differentiable
NUMBER = 1e-3  # the numbers of these scenes are larger, but for a few
ALIKE = 1e-11  # of the largest derivative; both are sums of the same numbers in another order


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", [name for name in NAMES if name not in SLOPPY])
def test_backward_equals_forward(name: str) -> None:
    library = shipped(name)
    bodies = moving(library)[:2]
    of = [f"{body}.{quantity}" for body in bodies for quantity in ("position", "velocity")]
    by = [f"{bodies[0]}.position", f"{bodies[-1]}.velocity"]
    until = float(library.manifest.instance["run"].get("until") or 1.0)
    times = [0.2 * until, 0.5 * until]
    forward = sensitivity(library, times, of=of, by=by)
    weights = np.random.default_rng(3).normal(size=forward.value.shape)
    values = ca.MX.sym("values", *forward.value.shape)
    loss = ca.Function("loss", [values], [ca.sum1(ca.sum2(weights * ca.sin(values)))])
    found = gradient(library, times, loss, of=of, by=by)
    expected = np.einsum("ij,ijk->k", weights * np.cos(forward.value), forward.jacobian)
    rounding = np.finfo(float).eps * np.abs(weights).sum()  # where all derivatives are zero
    allowed = ALIKE * np.max(np.abs(expected)) + rounding
    assert np.allclose(found.gradient, expected, rtol=0, atol=allowed)


@pytest.mark.cases(1)
@pytest.mark.parametrize("case", [case for case in NUMBERS if case != "end of the run"])
def test_backward_equals_forward_by_numbers_of_a_scene(case: str) -> None:
    library = differentiable(read_text(with_parameter(case), "scene.toml"))
    of = [f"{body}.{quantity}" for body in moving(library) for quantity in ("position", "velocity")]
    forward = sensitivity(library, [0.25], of=of, by=["number"])
    values = ca.MX.sym("values", *forward.value.shape)
    loss = ca.Function("loss", [values], [ca.sumsqr(values)])
    found = gradient(library, [0.25], loss, of=of, by=["number"])
    expected = 2 * np.einsum("ij,ijk->k", forward.value, forward.jacobian)
    size = 2 * np.sum(np.abs(forward.value * forward.jacobian[:, :, 0]))
    rounding = 1e-14 * np.sum(forward.value**2) / NUMBER  # where all parts of the derivative cancel
    assert abs(found.gradient[0] - expected[0]) <= ALIKE * size + rounding


@pytest.mark.parametrize(
    ("text", "values"),
    [(BALL.replace('"high"', "0.1"), {"up": -2.0, "bounce": 0.6}), (ROD, {"turn": 0.5, "kick": 1.7})],
)
def test_backward_equals_forward_over_corrections_of_the_start(text: str, values: dict[str, float]) -> None:
    library = built(text, values)
    (body,) = moving(library)
    by = [*values, f"{body}.velocity", f"{body}.position"]
    numbers = ca.MX.sym("values", 1, 6)
    loss = ca.Function("loss", [numbers], [ca.sumsqr(numbers)])
    found = gradient(library, [0.2], loss, of=[f"{body}.position", f"{body}.velocity"], by=by)
    assert found.verdict
    assert found.forward_difference < 1e-12


@pytest.mark.parametrize(
    ("text", "values"), [(BLOCK, {"heavy": 1.2, "rough": 0.4, "smooth": 0.3}), (DISC, {"rough": 0.3})]
)
def test_backward_equals_forward_while_faces_slip(text: str, values: dict[str, float]) -> None:
    moved = text.replace("[[contact]]", "velocity = [0.3, 0.1, 0.0]\n\n[[contact]]") if text == DISC else text
    library = built(moved, values)
    (body,) = moving(library)
    numbers = ca.MX.sym("values", 1, 9)
    loss = ca.Function("loss", [numbers], [ca.sumsqr(numbers)])
    of = [f"{body}.{quantity}" for quantity in ("position", "velocity", "angular_velocity")]
    t = 0.3 if text == DISC else 1.9
    found = gradient(library, [t], loss, of=of, by=[*values, f"{body}.orientation"], accuracy="tight")
    assert found.verdict
    assert found.forward_difference < 1e-10


def test_a_loss_that_is_no_function_of_the_values_is_refused() -> None:
    library = shipped("bouncing_ball")
    values = ca.MX.sym("values", 2, 2)
    for loss in (3.0, ca.Function("loss", [values], [ca.sumsqr(values)])):
        with pytest.raises(SimulationError, match="loss"):
            gradient(library, [0.1], loss, of=["ball.position"], by=["ball.velocity"])
