"""The range of a slider."""

from __future__ import annotations

from math import isfinite


def slider_range(low: float, high: float, value: float) -> tuple[float, float]:
    """The range itself; an end that is infinite is twice the value away, or 1."""
    way = 2 * abs(value) or 1.0
    return low if isfinite(low) else value - way, high if isfinite(high) else value + way
