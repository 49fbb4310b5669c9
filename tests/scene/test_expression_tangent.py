"""Derivatives of expressions beside those that CasADi makes of the same trees, and kinks."""

from __future__ import annotations

from math import isfinite

import casadi as ca
import numpy as np
import pytest

from modelgen.errors import ExpressionError
from modelgen.geometry.expression_translation import lower
from modelgen.scene.expression import parse_expression
from modelgen.scene.expression_tangent import tangent

NAMES = ("a", "b", "c")
ONE = (
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "sqrt",
    "abs",
    "sign",
)
TWO = ("min", "max", "atan2")


def drawn(random: np.random.Generator, depth: int) -> str:
    """The text of a random expression."""
    if depth == 0 or random.random() < 0.15:
        return str(random.choice([*NAMES, f"{random.uniform(0.1, 2):.3f}"]))
    kind = random.integers(4)
    one, two = drawn(random, depth - 1), drawn(random, depth - 1)
    if kind == 0:
        return f"{random.choice(ONE)}({one})"
    if kind == 1:
        return f"{random.choice(TWO)}({one}, {two})"
    if kind == 2:
        return f"({one})**{random.choice(['2', '3', '-1', '0.5', '(' + two + ')'])}"
    return f"(({one}) {random.choice(list('+-*/'))} ({two}))"


def test_derivatives_are_those_of_casadi() -> None:
    random, compared = np.random.default_rng(5), 0
    symbols = {name: ca.SX.sym(name) for name in NAMES}
    where = ca.vertcat(*symbols.values())
    for _ in range(600):
        try:
            expression = parse_expression(drawn(random, 4), NAMES)
        except ExpressionError:  # a part without names has no value
            continue
        at, rates = random.uniform(-1.5, 1.5, 3), random.uniform(-1, 1, 3)
        value = lower(expression, symbols)
        expected = ca.Function("f", [where], [value, ca.jtimes(value, where, ca.DM(rates))])(at)
        number, slope = map(float, expected)
        if not (isfinite(number) and isfinite(slope) and abs(slope) < 1e8):
            continue
        try:
            found = tangent(
                expression,
                dict(zip(NAMES, map(float, at), strict=True)),
                dict(zip(NAMES, map(float, rates), strict=True)),
            )
        except ExpressionError:  # log of a number that CasADi multiplies by zero
            continue
        if found.is_kink:
            continue
        compared += 1
        assert found.value == pytest.approx(number, rel=1e-9, abs=1e-12), expression.text
        assert found.rate == pytest.approx(slope, rel=1e-7, abs=1e-9), expression.text
    assert compared > 250


@pytest.mark.parametrize(
    ("text", "is_kink"),
    [
        ("max(s, 0.1)", True), ("max(s, 0.1001)", False), ("max(s, 2*s - 0.1)", True), ("max(s, s)", False),
        ("min(3*s, 0.3)", True), ("abs(s - 0.1)", True), ("abs(s - 0.1) + abs(0.1)", True), ("abs(0)", False),
        ("sign(10*s - 1)", True), ("sqrt(s - 0.1)", True), ("asin(10*s)", True), ("(s - 0.1)**0.5", True),
        ("(s - 0.1)**2", False), ("atan2(s - 0.1, -1)", True), ("atan2(s - 0.1, 1)", False),
        ("abs((s + 0.2) - 0.3)", True), ("sin(2000*s)", False), ("max(sin(s - 0.1), 0)*0", True),
    ],
)  # fmt: skip
def test_kinks_are_told(text: str, is_kink: bool) -> None:
    assert tangent(parse_expression(text, ["s"]), {"s": 0.1}, {"s": 1.0}).is_kink == is_kink
