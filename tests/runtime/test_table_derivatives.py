"""Derivatives of tables by a parameter: two differences for linear functions, else extrapolated."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from modelgen.runtime.sensitivity_directions import LEVELS, Array, extrapolated


def counted(function: Callable[[float], list[float]]) -> tuple[list[float], Callable[[float], Array]]:
    asked: list[float] = []

    def called(step: float) -> Array:
        asked.append(step)
        return np.asarray(function(step))

    return asked, called


def test_a_linear_function_takes_two_differences() -> None:
    asked, function = counted(lambda h: [3.0 + 0.7 * h, -2e3 * h, 5.0, 1e300])
    assert extrapolated(function, 1e-2) == pytest.approx([0.7, -2e3, 0.0, 0.0], rel=1e-12)
    assert len(asked) == 4


def test_another_function_takes_all_and_is_exact_to_rounding() -> None:
    """1/(1 + h) has the error h^8 of the extrapolation, 4e-18 here, and rounding over the least step."""
    asked, function = counted(lambda h: [1 / (1 + h), 0.7 * h])
    assert extrapolated(function, 1e-2) == pytest.approx([-1.0, 0.7], rel=1e-12)
    assert len(asked) == 2 * LEVELS
