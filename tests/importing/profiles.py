"""Profiles of a wheel and a rail of arcs, after S1002 and UIC 60, as a measuring device would give them."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]
Arc = tuple[float, float]  # curvature, 1/m, and length, m


def arcs(start: tuple[float, float], angle: float, pieces: list[Arc], count: int) -> Array:
    """(count, 2) m: points at equal distances along arcs that join smoothly, from a point and a direction."""
    ends = np.cumsum([0.0] + [length for _, length in pieces])
    s = np.linspace(0.0, ends[-1], count)
    points = np.zeros((count, 2))
    x, y, turned = *start, angle
    for (bend, length), begin, end in zip(pieces, ends[:-1], ends[1:], strict=True):
        own = (s >= begin) & (s <= end)
        t = s[own] - begin
        points[own] = np.array([x, y]) + _arc(turned, bend, t)
        x, y = np.array([x, y]) + _arc(turned, bend, np.array([length]))[0]
        turned += bend * length
    return points


def _arc(angle: float, bend: float, t: Array) -> Array:
    if bend == 0:
        return np.outer(t, [np.cos(angle), np.sin(angle)])
    after = angle + bend * t
    return np.stack([np.sin(after) - np.sin(angle), np.cos(angle) - np.cos(after)], axis=1) / bend


def rail_head(count: int = 1200) -> Array:
    """Head of a rail, (x across, y up), from right to left: arcs of 13, 80, 300, 80, 13 mm as of UIC 60."""
    side = [(1 / 0.013, 0.0195), (1 / 0.080, 0.0150)]
    middle = [(1 / 0.300, 0.0205)]
    pieces = [*side, *middle, *side[::-1]]
    total = sum(bend * length for bend, length in pieces)
    return arcs((0.0, 0.0), np.pi - total / 2, pieces, count) - _top(pieces, total)


def _top(pieces: list[Arc], total: float) -> Array:
    points = arcs((0.0, 0.0), np.pi - total / 2, pieces, 4001)
    return np.array([points[:, 0].mean(), points[:, 1].max()])


def wheel_tread(count: int = 1600, radius: float = 0.46) -> Array:
    """Profile of a wheel, (r, z along the axle), to the tip of the flange: 1:15, tread, throat, flank."""
    pieces = [
        (0.0, 0.028), (-0.9, 0.045), (1 / 0.100, 0.012), (1 / 0.0135, 0.0146), (0.0, 0.006),
        (-1 / 0.0205, 0.0145), (-1 / 0.012, 0.020),
    ]  # fmt: skip
    points = arcs((-0.060, 0.0), float(np.arctan(1 / 15)), pieces, count)
    level = np.interp(0.0, points[:, 0], points[:, 1])
    return np.stack([radius + points[:, 1] - level, points[:, 0]], axis=1)


def measured(points: Array, noise: float, seed: int) -> Array:
    """Points with normal noise of a standard deviation in both coordinates."""
    return points + np.random.default_rng(seed).normal(0.0, noise, points.shape)
