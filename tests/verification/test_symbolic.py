"""A function written as formulas computes what the function computes."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from modelgen.errors import ModelgenError
from modelgen.verification.sympy_translation import Line, component, definition, leading_to

UNARY = (
    *(ca.sin, ca.cos, ca.tan, ca.asin, ca.acos, ca.atan, ca.sinh, ca.cosh, ca.tanh, ca.exp, ca.log),
    *(ca.sqrt, ca.fabs, ca.sign, ca.floor, ca.ceil, ca.log1p, ca.expm1, ca.asinh, ca.atanh),
)
BINARY = (ca.plus, ca.minus, ca.times, ca.rdivide, ca.power, ca.atan2, ca.fmin, ca.fmax, ca.hypot)
X, Y = ca.SX.sym("x", 2), ca.SX.sym("y", 3)


def evaluate(lines: tuple[Line, ...], values: dict[str, float]) -> dict[str, float]:
    known = dict(values)
    for line in lines:
        arguments = sorted(str(symbol) for symbol in line.value.free_symbols)
        value = sp.lambdify([sp.Symbol(a, real=True) for a in arguments], line.value)(
            *(known[a] for a in arguments)
        )
        known[str(line.target)] = float(value)
    return known


def assert_same(f: ca.Function, x: np.ndarray, y: np.ndarray) -> None:
    names = {f"x_{i + 1}": x[i] for i in range(2)} | {f"y_{i + 1}": y[i] for i in range(3)}
    got = evaluate(definition(f), names)
    expected = f(x, y).full().ravel()
    size = len(expected)
    np.testing.assert_allclose(
        [got[str(component("z", i, size, {}))] for i in range(size)], expected, rtol=1e-12
    )


@pytest.mark.parametrize("operation", UNARY, ids=lambda f: f.__name__)
def test_unary_operation(operation: object) -> None:
    f = ca.Function("f", [X, Y], [operation(X)], ["x", "y"], ["z"])  # type: ignore[operator]
    assert_same(f, np.array([0.3, 0.8]), np.zeros(3))


@pytest.mark.parametrize("operation", BINARY, ids=lambda f: f.__name__)
def test_binary_operation(operation: object) -> None:
    f = ca.Function("f", [X, Y], [operation(X, Y[:2])], ["x", "y"], ["z"])  # type: ignore[operator]
    assert_same(f, np.array([0.3, 0.8]), np.array([1.7, 0.4, 0.0]))


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(0.1, 3.0), min_size=5, max_size=5), st.integers(1, 6))
def test_shared_terms_and_long_sums(numbers: list[float], depth: int) -> None:
    term = ca.norm_2(Y) + X[0] / X[1]
    for _ in range(depth):
        term = ca.sqrt(1 + term * term) - 2 * Y[1] / term + ca.sumsqr(X) * ca.dot(Y, Y)
    f = ca.Function("f", [X, Y], ca.cse([ca.vertcat(term, term**2, -term, 3.0, X[0])]), ["x", "y"], ["z"])
    assert_same(f, np.array(numbers[:2]), np.array(numbers[2:]))


def test_components_of_known_vectors_have_their_letters() -> None:
    names = [str(component("pose_o", i, 12, {})) for i in (0, 3, 4, 11)]
    assert names == ["p_o_x", "R_o_xx", "R_o_yx", "R_o_zz"]
    assert str(component("twist_f", 5, 6, {})) == "omega_f_z"
    assert str(component("d", 0, 1, {})) == "d"
    assert str(component("parameters", 1, 2, {"parameters": ("a", "b")})) == "b"


def test_values_used_once_are_written_in_place() -> None:
    f = ca.Function("f", [X, Y], [ca.sin(X[0] + Y[0])], ["x", "y"], ["z"])
    lines = definition(f)
    assert [str(line.target) for line in lines] == ["z"]


def test_a_value_that_is_an_output_has_its_name_from_there_on() -> None:
    total = ca.sin(X[0] + Y[0])
    f = ca.Function("f", [X, Y], [total, total**2 + total], ["x", "y"], ["total", "z"])
    assert [str(line.value) for line in definition(f)] == ["sin(x_1 + y_1)", "total**2 + total"]


def test_steps_that_are_numbers_or_other_names_are_not_written() -> None:
    f = ca.Function("f", [X, Y], [ca.SX(2), X[0], X[0] * Y[0]], ["x", "y"], ["two", "same", "z"])
    assert [str(line.target) for line in definition(f)] == ["z", "two", "same"]
    assert [str(line.target) for line in definition(f, steps=("two", "same"))] == ["z"]


def test_one_quantity_stands_with_what_leads_to_it() -> None:
    root = ca.sqrt(X[0] + Y[0])
    f = ca.Function("f", [X, Y], [root, ca.exp(Y[1]), root * X[1]], ["x", "y"], ["root", "other", "z"])
    assert [line.output for line in leading_to(definition(f), "z")] == ["root", "z"]


def test_operation_without_notation_is_refused() -> None:
    f = ca.Function("f", [X, Y], [ca.erf(X[0])], ["x", "y"], ["z"])
    with pytest.raises(ModelgenError, match="no notation"):
        definition(f)
