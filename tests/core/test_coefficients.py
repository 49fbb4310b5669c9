"""The coefficients of the integrators satisfy the equations that define them, to the digits that they have.

Order conditions by rooted trees: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.2.
Numbers are exact fractions, so that a coefficient off by 1e-25 is seen.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import prod

import pytest

from tests.core.tables import Tree, density, tables, trees

DIGITS = Fraction(1, 10**22)  # tables have 25 digits or more; sums of 16 products lose two or three


class Dop853:
    """An explicit tableau of 16 stages: 12 of the step, its end, and 3 of the interpolant."""

    def __init__(self) -> None:
        row, column, value, self.c, *errors, self.dense = tables("dop853")
        spans = [range(int(first), int(last)) for first, last in pairwise(row)]
        rows = [{int(column[k]): value[k] for k in span} for span in spans]
        self.fifth, self.third = (
            [dict(zip(map(int, columns), weights, strict=True)).get(j, Fraction(0)) for j in range(12)]
            for columns, weights in (errors[:2], errors[2:])
        )
        self.b = [rows[12].get(j, Fraction(0)) for j in range(12)]
        self.A = [[rows[i].get(j, Fraction(0)) for j in range(16)] for i in range(16)]

    @cache  # noqa: B019
    def derivative(self, tree: Tree) -> list[Fraction]:
        """The elementary weights of all stages, of the product over the branches."""
        branches = [self.derivative(branch) for branch in tree]
        inner = [[_dot(row, branch) for row in self.A] for branch in branches]
        return [prod((values[i] for values in inner), start=Fraction(1)) for i in range(16)]


def _dot(row: list[Fraction], values: list[Fraction]) -> Fraction:
    return sum((a * v for a, v in zip(row, values, strict=True) if a), start=Fraction(0))


def _padded(weights: list[Fraction]) -> list[Fraction]:
    return [*weights, *[Fraction(0)] * (16 - len(weights))]


@pytest.fixture(scope="module")
def dop853() -> Dop853:
    return Dop853()


def test_the_times_of_stages_are_the_sums_of_their_rows(dop853: Dop853) -> None:
    assert all(abs(sum(row) - c) < DIGITS for row, c in zip(dop853.A, dop853.c, strict=True))


@pytest.mark.parametrize("order", range(1, 9))
def test_the_step_satisfies_all_conditions_of_order_eight(dop853: Dop853, order: int) -> None:
    weights = _padded(dop853.b)
    for tree in trees(order):
        assert abs(_dot(weights, dop853.derivative(tree)) - Fraction(1, density(tree))) < DIGITS


@pytest.mark.parametrize(("name", "most"), [("fifth", 5), ("third", 3)])
def test_what_estimates_the_error_vanishes_up_to_its_order(dop853: Dop853, name: str, most: int) -> None:
    """Weights of the step less those of an embedded method, of which the second table has minus its own."""
    given = dop853.fifth if name == "fifth" else [b + e for b, e in zip(dop853.b, dop853.third, strict=True)]
    for order in range(1, most + 1):
        for tree in trees(order):
            assert abs(_dot(_padded(given), dop853.derivative(tree))) < DIGITS
    assert max(abs(_dot(_padded(given), dop853.derivative(tree))) for tree in trees(most + 1)) > 1e-5


def _powers(rows: list[list[Fraction]]) -> list[list[Fraction]]:
    """Per power 0..7 of theta the weights of theta (r0 + (1 - theta) (r1 + theta (r2 + ...)))."""
    width = len(rows[0])
    y = [[Fraction(0)] * width for _ in range(8)]
    for k in range(6, -1, -1):
        y[0] = [a + b for a, b in zip(y[0], rows[k], strict=True)]
        raised = [[Fraction(0)] * width, *y[:7]]
        y = (
            [[a - b for a, b in zip(p, q, strict=True)] for p, q in zip(y, raised, strict=True)]
            if k % 2
            else raised
        )
    return y


@pytest.mark.parametrize("order", range(1, 8))
def test_the_interpolant_satisfies_all_conditions_of_order_seven(dop853: Dop853, order: int) -> None:
    """sum_i b_i(theta) Phi_i(t) = theta^r / gamma(t) for each tree t of r vertices, by powers of theta."""
    zero, b = Fraction(0), _padded(dop853.b)
    first, last = ([Fraction(int(j == at)) for j in range(16)] for at in (0, 12))
    rows = [
        b,
        [f - e for f, e in zip(first, b, strict=True)],
        [2 * e - f - g for e, f, g in zip(b, first, last, strict=True)],
        *dop853.dense,
    ]
    for tree in trees(order):
        weights = dop853.derivative(tree)
        for power, row in enumerate(_powers(rows)):
            expected = Fraction(1, density(tree)) if power == order else zero
            assert abs(_dot(row, weights) - expected) < 1000 * DIGITS


@pytest.fixture(scope="module")
def radau() -> list[list]:
    return tables("radau")


def test_radau_integrates_and_differentiates_powers(radau: list[list]) -> None:
    time, weight, _, slope = radau
    for q in range(7):
        for c, integral, derivative in zip(time, weight, slope, strict=True):
            values = [node**q for node in time]
            assert abs(_dot(integral, values) - c ** (q + 1) / (q + 1)) < DIGITS
            exact = q * c ** (q - 1) if q else Fraction(0)
            assert abs(_dot(derivative, values) - exact) < 1000 * DIGITS


def test_radau_reaches_order_thirteen_at_the_end(radau: list[list]) -> None:
    """Its nodes are those of quadrature exact to degree 12, the last of them the end."""
    time, weight = radau[0], radau[1]
    assert time[-1] == 1
    for q in range(13):
        assert abs(_dot(weight[-1], [c**q for c in time]) - Fraction(1, q + 1)) < DIGITS


def test_radau_interpolates_powers(radau: list[list]) -> None:
    """From the increments theta^q at the nodes it makes theta^q."""
    time, dense = radau[0], radau[2]
    for q in range(1, 8):
        rows = [[_dot(row, [c**q for c in time])] for row in dense]
        for power, (value,) in enumerate(_powers(rows)):
            assert abs(value - (power == q)) < 10**5 * DIGITS
