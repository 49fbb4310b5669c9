"""Triangles over two coordinates, cut where a condition on the coordinates ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
Value = Callable[[Array], Array]  # uv (n, 2) -> (n,), >= 0 where the condition holds

ON_BORDER = 60  # steps in the search for the border
ROUNDING, TINY = 1e-13, 1e-300  # of the values of a condition at the ends; of their difference
STEP = 1e-6  # of the chord, for differences of a condition


@dataclass(frozen=True, slots=True)
class Border:
    """The chords by which triangles were cut."""

    middles: Array  # (n, 2) of them
    nearest: Array  # (n, 2) where the condition ends next to each


def cut(uv: Array, triangles: Array, value: Value) -> tuple[Array, Array, Border]:
    """The part of the triangles on which a condition holds: coordinates, triangles, and its border."""
    none = Border(np.zeros((0, 2)), np.zeros((0, 2)))
    if not len(triangles):
        return uv, triangles, none
    inside = value(uv) >= 0
    flags = inside[triangles]
    count = flags.sum(axis=1)
    kept = [triangles[count == 3]]
    ends = []
    for corners, alone in ((1, True), (2, False)):
        mine = triangles[count == corners]
        if not len(mine):
            continue
        apex = np.argmax(inside[mine] == alone, axis=1)
        turned = mine[np.arange(len(mine))[:, None], (apex[:, None] + np.arange(3)) % 3]
        a, b, c = turned.T
        first = _borders(uv, a, b, value) if alone else _borders(uv, b, a, value)
        second = _borders(uv, a, c, value) if alone else _borders(uv, c, a, value)
        p, q = len(uv) + np.arange(len(a)), len(uv) + len(a) + np.arange(len(a))
        uv = np.concatenate([uv, first, second])
        kept += [np.stack([a, p, q], 1)] if alone else [np.stack([p, b, c], 1), np.stack([p, c, q], 1)]
        ends.append((first, second))
    border = _border(np.concatenate([e[0] for e in ends]), np.concatenate([e[1] for e in ends]), value) if (
        ends
    ) else none  # fmt: skip
    return uv, np.concatenate(kept), border


def _borders(uv: Array, inside: Array, outside: Array, value: Value) -> Array:
    """Where a condition ends between vertices at which it holds and others at which it does not: false
    position, with the value at an end halved that stays (Illinois)."""
    low, high = uv[inside], uv[outside]
    at_low, at_high = value(low), value(high)
    small = ROUNDING * np.maximum(np.abs(at_low), np.abs(at_high))
    place = low
    for _ in range(ON_BORDER):
        share = at_low / np.maximum(at_low - at_high, TINY)
        place = low + share[:, None] * (high - low)
        found = value(place)
        if (np.abs(found) <= small).all():
            break
        holds = found >= 0
        low, high = np.where(holds[:, None], place, low), np.where(holds[:, None], high, place)
        at_low, at_high = np.where(holds, found, at_low / 2), np.where(holds, at_high / 2, found)
    return place


def _border(first: Array, second: Array, value: Value) -> Border:
    """Chords of the border; what is nearest to a middle is found by one step of Newton's method along the
    chord's normal."""
    middles, chord = (first + second) / 2, second - first
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    across = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    step = STEP * across
    slope = (value(middles + step) - value(middles - step)) / (2 * STEP)
    known = (np.abs(slope) > 0) & (length[:, 0] > 0)
    away = np.where(known, value(middles) / np.where(known, slope, 1.0), 0.0)
    return Border(middles, middles - np.clip(away, -1.0, 1.0)[:, None] * across)
