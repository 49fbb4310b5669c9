"""Derivatives of tables: two differences of linear functions, else extrapolated; kinks and jumps are told."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np
import pytest

from modelgen.errors import SimulationError
from modelgen.runtime.table_derivatives import LEVELS, Found, Tables
from modelgen.runtime.tables.ctypes_structures import Array

EPSILON = float(np.finfo(float).eps)


def counted(function: Callable[[float], list[float]]) -> tuple[list[float], Callable[[float], Array]]:
    asked: list[float] = []

    def called(step: float) -> Array:
        asked.append(step)
        return np.asarray(function(step))

    return asked, called


def of(function: Callable[[float], float]) -> Found:
    return Tables(lambda h: np.array([function(h)]), 1.0, 1.0, EPSILON).derivative()


def test_a_linear_function_takes_two_differences() -> None:
    asked, function = counted(lambda h: [3.0 + 0.7 * h, -2e3 * h, 5.0, 1e300])
    found = Tables(function, 1.0, 1.0, EPSILON).derivative()
    assert found.is_smooth
    assert found.value == pytest.approx([0.7, -2e3, 0.0, 0.0], rel=1e-12)
    assert len(asked) == 5


def test_another_function_takes_all_and_is_exact_to_rounding() -> None:
    """1/(1 + h) has the error h^8 of the extrapolation, 4e-18 here, and rounding over the least step."""
    asked, function = counted(lambda h: [1 / (1 + h), 0.7 * h])
    found = Tables(function, 1.0, 1.0, EPSILON).derivative()
    assert found.is_smooth
    assert found.value == pytest.approx([-1.0, 0.7], rel=1e-12)
    assert len(asked) == 2 * LEVELS + 1


@pytest.mark.parametrize("at", [2e-5, 3e-4, 2e-3, -1e-3])
def test_steps_become_shorter_than_the_way_to_a_kink(at: float) -> None:
    found = of(lambda h: abs(h - at) + np.exp(h))
    assert found.is_smooth
    assert found.value == pytest.approx([1 - np.sign(at)], abs=1e-8)


@pytest.mark.parametrize(
    "function",
    [
        abs,
        lambda h: max(h, 2 * h),
        lambda h: np.exp(h) + 1e-3 * abs(h),
        lambda h: float(h > 0),
        lambda h: sqrt(abs(h)),
    ],
    ids=["abs", "max", "hidden", "step", "root"],
)
def test_kinks_and_jumps_are_told(function: Callable[[float], float]) -> None:
    assert not of(function).is_smooth


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_the_end_of_a_range_the_other_side_counts(side: float) -> None:
    def ended(h: float) -> float:
        if side * h < 0:
            raise SimulationError("parameters", "out of range")
        return float(np.exp(2 * h))

    found = of(ended)
    assert found.is_smooth
    assert found.value == pytest.approx([2.0], rel=1e-8)


def test_what_is_refused_on_both_sides_is_refused() -> None:
    def refused(h: float) -> float:
        if h:
            raise SimulationError("parameters", "another structure")
        return 1.0

    with pytest.raises(SimulationError, match="another structure"):
        of(refused)
