"""Composed expressions: their text reads back as themselves, and substitution is evaluation at a value."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from modelgen.errors import ExpressionError
from modelgen.scene.expression import Expression, Name, evaluate, number, parse_expression
from modelgen.scene.expression_algebra import expression_of, substitute, text_of
from tests.geometry.test_expression_translation import ATOMS, VALUES, grown

TEXTS = st.recursive(ATOMS, grown, max_leaves=8)


def parsed(text: str) -> Expression:
    try:
        return parse_expression(text, ("x", "y"))
    except ExpressionError:
        assume(False)
        raise


@given(TEXTS)
def test_the_text_of_a_tree_reads_back_as_the_tree(text: str) -> None:
    expression = parsed(text)
    again = expression_of(expression.tree)
    assert parse_expression(again.text, ("x", "y")).tree == expression.tree
    assert again.names == expression.names


@given(TEXTS, VALUES, VALUES)
def test_a_name_replaced_by_its_value_gives_the_value(text: str, x: float, y: float) -> None:
    expression = parsed(text)
    try:
        expected = evaluate(expression, {"x": x, "y": y})
    except ExpressionError:
        assume(False)
    held = expression_of(substitute(expression.tree, {"x": number(x)}))
    assert "x" not in held.names
    assert evaluate(held, {"y": y}) == expected


@pytest.mark.parametrize(
    "text",
    ["-(a + b)*c", "(a + b)*(c - d)", "a - (b - c)", "(a*b)**c", "(-a)**2", "-a**2", "a**b**c", "a/(b*c)"],
)
def test_parentheses_stand_where_they_are_needed(text: str) -> None:
    assert text_of(parse_expression(text, tuple("abcd")).tree) == text


def test_names_are_exchanged_at_once() -> None:
    swapped = substitute(parse_expression("x - y", ("x", "y")).tree, {"x": Name("y"), "y": Name("x")})
    assert text_of(swapped) == "y - x"
