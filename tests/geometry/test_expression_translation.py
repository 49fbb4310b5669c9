"""An expression that is translated to CasADi has the value of the expression itself."""

from __future__ import annotations

import casadi as ca
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from modelgen.errors import ExpressionError
from modelgen.geometry.expression_translation import lower
from modelgen.scene.expression import evaluate, parse_expression
from modelgen.scene.expression_functions import FUNCTIONS

VALUES = st.floats(-3, 3)
ATOMS = st.sampled_from(["x", "y", "0.5", "2", "pi"])
UNARY = sorted(name for name, function in FUNCTIONS.items() if function.arity == 1)
BINARY = sorted(name for name, function in FUNCTIONS.items() if function.arity == 2)


def grown(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    operation = st.builds(lambda a, op, b: f"({a} {op} {b})", inner, st.sampled_from("+-*/"), inner)
    power = st.builds(lambda a, n: f"({a})**{n}", inner, st.integers(0, 3))
    minus = st.builds(lambda a: f"-({a})", inner)
    one = st.builds(lambda f, a: f"{f}({a})", st.sampled_from(UNARY), inner)
    two = st.builds(lambda f, a, b: f"{f}({a}, {b})", st.sampled_from(BINARY), inner, inner)
    return st.one_of(operation, power, minus, one, two)


@given(st.recursive(ATOMS, grown, max_leaves=6), VALUES, VALUES)
def test_lowering_keeps_the_value(text: str, x: float, y: float) -> None:
    try:
        expression = parse_expression(text, ("x", "y"))
        expected = evaluate(expression, {"x": x, "y": y})
    except ExpressionError:
        assume(False)
    symbols = {"x": ca.SX.sym("x"), "y": ca.SX.sym("y")}
    found = float(ca.Function("f", list(symbols.values()), [lower(expression, symbols)])(x, y))
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_name_without_symbol_is_refused() -> None:
    with pytest.raises(ExpressionError, match="no symbol for 'y'"):
        lower(parse_expression("x + y", ("x", "y")), {"x": ca.SX.sym("x")})
