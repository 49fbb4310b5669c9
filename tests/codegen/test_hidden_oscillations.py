"""What is a polynomial of low degree in time is told from what may oscillate between samples."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from modelgen.codegen.hidden_oscillations import SEEN, degree, may_oscillate

TERMS = st.lists(st.tuples(st.integers(0, 4), st.integers(-3, 3)), min_size=1, max_size=4)


def of_time(expression: Callable[[ca.SX, ca.SX], ca.SX]) -> ca.Function:
    t, x = ca.SX.sym("t"), ca.SX.sym("x")
    return ca.Function("f", [x, t], [expression(t, x)], ["x", "t"], ["value"])


@given(TERMS, TERMS)
def test_the_degree_is_at_least_that_of_the_polynomial(
    first: list[tuple[int, int]], second: list[tuple[int, int]]
) -> None:
    """And is it where nothing cancels."""

    def written(t: ca.SX, x: ca.SX) -> ca.SX:
        return sum(k * t**n * ca.cos(x) for n, k in first) * sum(k * t**n for n, k in second) / (2 + x)

    t = sp.Symbol("t")
    whole = sp.Poly(sum(k * t**n for n, k in first), t) * sp.Poly(sum(k * t**n for n, k in second), t)
    assert degree(of_time(written), [1]) >= max(whole.degree(), 0)
    highest = sum(max((n for n, k in terms if k), default=0) for terms in (first, second))
    assert degree(of_time(written), [1]) <= highest or highest > SEEN


@pytest.mark.parametrize(
    "waves",
    [
        lambda t, x: ca.sin(t), lambda t, x: ca.fmax(0, t - 1), lambda t, x: ca.fabs(t),
        lambda t, x: ca.sign(t - x), lambda t, x: x / (1 + t), lambda t, x: ca.sqrt(t),
        lambda t, x: t**4, lambda t, x: ca.if_else(t > 1, x, 0), lambda t, x: ca.floor(t),
        lambda t, x: ca.exp(-(t**2)), lambda t, x: x**t, lambda t, x: ca.atan2(t, x),
    ],
)  # fmt: skip
def test_what_is_no_low_polynomial_may_hide(waves: Callable[[ca.SX, ca.SX], ca.SX]) -> None:
    assert may_oscillate(of_time(waves), "t")


@pytest.mark.parametrize(
    "plain",
    [
        lambda t, x: 2 * t, lambda t, x: -t + x, lambda t, x: ca.sin(x), lambda t, x: ca.fabs(x) * t**2,
        lambda t, x: t**3 / x, lambda t, x: 3 * (t - 1) * (t + x), lambda t, x: ca.SX(7),
    ],
)  # fmt: skip
def test_a_polynomial_of_low_degree_does_not(plain: Callable[[ca.SX, ca.SX], ca.SX]) -> None:
    assert not may_oscillate(of_time(plain), "t")


def test_the_degree_counts_all_inputs_that_are_asked_for() -> None:
    f = of_time(lambda t, x: t**2 * x**2)
    assert not may_oscillate(f, "t")
    assert may_oscillate(f, "t", "x")
