"""A simple polygon as convex pieces: ears are cut off, then joined again where they stay convex."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]

STRAIGHT = 1e-9  # sine of a turn to the right that is rounding
CORNER = 1e-6  # sine of the smallest corner of a piece


def convex_pieces(polygon: Array) -> list[list[int]]:
    """Loops of corner numbers of a polygon (n,2) that runs counterclockwise; all of it if it is convex."""
    if is_convex_polygon(polygon):
        return [list(range(len(polygon)))]
    pieces = _triangles(polygon)
    while True:
        joined = next(
            (
                (first, second, loop)
                for first, second in combinations(range(len(pieces)), 2)
                if (loop := _joined(pieces[first], pieces[second])) and _is_convex(polygon[loop])
            ),
            None,
        )
        if joined is None:
            return sorted(
                piece[piece.index(min(piece)) :] + piece[: piece.index(min(piece))] for piece in pieces
            )
        first, second, loop = joined
        pieces = [piece for index, piece in enumerate(pieces) if index not in (first, second)] + [loop]


def is_convex_polygon(points: Array) -> bool:
    """Whether a polygon (n,2) that runs counterclockwise turns left everywhere."""
    return bool((_turns(points) >= -STRAIGHT).all())


def _is_convex(points: Array) -> bool:
    return bool((_turns(points) > CORNER).all())


def _turns(points: Array) -> Array:
    """Sine (n,) of the turn at every point of a polygon (n,2)."""
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(cross / (np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)))


def _triangles(polygon: Array) -> list[list[int]]:
    """Ears cut off one after the other, the roundest first."""
    left = list(range(len(polygon)))
    triangles = []
    while len(left) > 3:
        count = len(left)
        ears = [[left[k - 1], left[k], left[(k + 1) % count]] for k in range(count)]
        best = max(ears, key=lambda ear: _roundness(polygon, ear, left))
        triangles.append(best)
        left.remove(best[1])
    return [*triangles, left]


def _roundness(polygon: Array, ear: list[int], left: list[int]) -> float:
    """Sine of the smallest corner of a triangle; negative where it is no ear or has a corner on a side."""
    triangle = polygon[ear]
    smallest = float(_turns(triangle).min())
    if smallest <= STRAIGHT:
        return -1.0
    others = polygon[[k for k in left if k not in ear]]
    edges = np.roll(triangle, -1, axis=0) - triangle
    arms = others[:, None, :] - triangle
    across = edges[:, 0] * arms[..., 1] - edges[:, 1] * arms[..., 0]
    within = (across >= -STRAIGHT * (edges**2).sum(axis=1)).all(axis=1)
    return -1.0 if within.any() else smallest


def _joined(a: list[int], b: list[int]) -> list[int]:
    """The loop of two pieces that share one side; empty if they do not."""
    for k, start in enumerate(a):
        end = a[(k + 1) % len(a)]
        if start in b and b[b.index(start) - 1] == end:
            at = b.index(start)
            return a[k + 1 :] + a[: k + 1] + (b[at + 1 :] + b[:at])[: len(b) - 2]
    return []
