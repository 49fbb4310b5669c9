"""Smooth ordinary differential equations in long double, by extrapolation of the modified midpoint rule.

Gragg, Bulirsch and Stoer (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Real = np.longdouble
Array = np.ndarray[Any, Any]
Field = Callable[[Array], Array]
Stop = Callable[[Array], Any]

COLUMNS = 8  # substeps 2, 4 .. 16: order 16; more columns round worse
FIRST = 0.01  # first step
ROUNDS = 60


def reals(values: Any) -> Array:
    return np.array(values, dtype=Real)


def written(*values: float) -> Array:
    """Numbers as they are written in decimals, not as doubles."""
    return reals([Real(repr(value)) for value in values])


def cross(a: Any, b: Any) -> Array:
    return reals([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def solved(A: Array, b: Array) -> Array:
    """A^-1 b for a 3x3 matrix in long double, which LAPACK does not know."""
    first, second, third = A[:, 0], A[:, 1], A[:, 2]
    normal = cross(second, third)
    return reals([normal @ b, first @ cross(b, third), first @ cross(second, b)]) / (first @ normal)


def _midpoint(field: Field, x: Array, slope: Array, h: Any, substeps: int) -> Array:
    step = h / substeps
    before, now = x, x + step * slope
    for _ in range(substeps - 1):
        before, now = now, before + 2 * step * field(now)
    return (before + now + step * field(now)) / 2


def stepped(field: Field, x: Array, h: Any) -> tuple[Array, float]:
    """The state after a step h and the estimate of its error, in the largest norm relative to 1 + |x|."""
    slope, row = field(x), []
    error = np.inf
    for column in range(1, COLUMNS + 1):
        above, row = row, [_midpoint(field, x, slope, Real(h), 2 * column)]
        for back, old in enumerate(above):
            ratio = (Real(column) / (column - back - 1)) ** 2
            row.append(row[back] + (row[back] - old) / (ratio - 1))
        if column > 1:
            change = np.abs(row[-1] - row[-2]) / (1 + np.abs(row[-1]))
            error = min(error, float(change.max())) if np.isfinite(change).all() else np.inf
    return row[-1], error


def marched(
    field: Field, x: Array, span: Any, stops: tuple[Stop, ...] = (), tolerance: float = 1e-17
) -> tuple[Array, Any, int]:
    """From x over `span`, or to where a stop, positive so far, comes to zero.

    Returns the state, the distance gone and the number of the stop (-1: none).
    """
    gone, span = Real(0), Real(span)
    h = min(span / 8, Real(FIRST))
    armed = [stop(x) > 0 for stop in stops]
    while gone < span:
        h = min(h, span - gone)
        after, error = stepped(field, x, h)
        if error > tolerance:
            h *= max(0.2, 0.8 * (tolerance / error) ** (1 / (2 * COLUMNS - 1))) if np.isfinite(error) else 0.2
            continue
        crossed = [k for k, stop in enumerate(stops) if armed[k] and not stop(after) > 0]
        if crossed:
            found = [(*located(field, x, h, stops[k]), k) for k in crossed]
            step, state, which = min(found, key=lambda item: item[0])
            return state, gone + step, which
        armed = [old or stop(after) > 0 for old, stop in zip(armed, stops, strict=True)]
        x, gone = after, gone + h
        h *= min(4.0, 0.8 * (tolerance / max(error, 1e-24)) ** (1 / (2 * COLUMNS - 1)))
    return x, gone, -1


def located(field: Field, x: Array, h: Any, stop: Stop) -> tuple[Any, Array]:
    """The part of the step h at which the stop is zero, by the Illinois rule, and the state there."""
    low, high = Real(0), Real(h)
    at_low, at_high = stop(x), stop(stepped(field, x, h)[0])
    state = x
    for _ in range(ROUNDS):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        state = stepped(field, x, middle)[0]
        value = stop(state)
        if abs(value) < Real(1e-19) or abs(high - low) < Real(1e-18) * abs(h):
            return middle, state
        if value * at_high < 0:
            low, at_low = high, at_high
        else:
            at_low /= 2
        high, at_high = middle, value
    return middle, state
