"""Signed distances in a plane from closed outlines, by which solids are judged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
NEAR = 1e-3  # of the size of an outline: nearer points are referred to the curve, not to its polygon
REFINED = 5  # steps by which the nearest parameter is refined, each to NEAR of its error or better


def polygon_distance(outline: Array) -> Callable[[Array], Array]:
    """Signed distance from a polygon in the plane, positive outside."""
    from matplotlib.path import Path as Outline
    from scipy.spatial import cKDTree

    start, end = outline, np.roll(outline, -1, axis=0)
    area, count = Outline(np.vstack([outline, outline[:1]])), len(outline)
    near = cKDTree(outline) if count > 100 else None

    def distance(x: Array) -> Array:
        flat = x.reshape(-1, 2)
        if near is None:
            which = np.broadcast_to(np.arange(count), (len(flat), count))
        else:
            nearest = near.query(flat)[1]
            which = (nearest[:, None] + np.arange(-2, 2)) % count
        a, b = start[which], end[which]
        along = b - a
        part = ((flat[:, None] - a) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300)
        foot = a + np.clip(part, 0, 1)[..., None] * along
        depth = np.linalg.norm(flat[:, None] - foot, axis=-1).min(axis=1)
        return np.where(area.contains_points(flat), -depth, depth).reshape(x.shape[:-1])

    return distance


def curve_distance(
    at: Callable[[Array], Array], slope: Callable[[Array], Array], t: Array, mirrored: bool = False
) -> Callable[[Array], Array]:
    """Signed distance from a curve (x, y) of t, positive on its right, exact near it.

    Args:
        at: points (n, 2) m for parameters (n,).
        slope: their derivatives.
        t: (k,) dense parameters. Their polygon, beyond NEAR, stands for the curve.
        mirrored: the curve runs from the axis x = 0 back to it, and its mirror image closes it; else it is
            closed.
    """
    from scipy.spatial import cKDTree

    points = at(t)
    size = float(np.abs(points).max())
    coarse = polygon_distance(np.vstack([points, points[::-1] * [-1, 1]]) if mirrored else points)
    near = cKDTree(points)

    def distance(x: Array) -> Array:
        found = np.array(coarse(x))
        close = np.abs(found) < NEAR * size
        if close.any():
            part = x[close]
            foot = t[near.query(part)[1]]
            for _ in range(REFINED):
                along = slope(foot)
                foot = foot + ((part - at(foot)) * along).sum(-1) / (along**2).sum(-1)
                if mirrored:
                    foot = np.clip(foot, t[0], t[-1])
            along = slope(foot)
            right = np.stack([along[:, 1], -along[:, 0]], axis=1)
            found[close] = ((part - at(foot)) * right).sum(-1) / np.linalg.norm(along, axis=1)
        return found

    return distance
