"""Signed distances in a plane from closed outlines, by which solids are judged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
REFINED = 4  # steps by which the nearest parameter is refined


def polygon_distance(outline: Array) -> Callable[[Array], Array]:
    """Signed distance from a polygon in the plane, positive outside."""
    from matplotlib.path import Path as Outline

    start, along = outline, np.roll(outline, -1, axis=0) - outline
    area = Outline(np.vstack([outline, outline[:1]]))

    def distance(x: Array) -> Array:
        flat = x.reshape(-1, 2)
        part = ((flat[:, None] - start) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300)
        foot = start + np.clip(part, 0, 1)[..., None] * along
        depth = np.linalg.norm(flat[:, None] - foot, axis=-1).min(axis=1)
        signed: Array = np.where(area.contains_points(flat), -depth, depth)
        return signed.reshape(x.shape[:-1])

    return distance


def curve_distance(
    at: Callable[[Array], Array], slope: Callable[[Array], Array], t: Array
) -> Callable[[Array], Array]:
    """Signed distance from a smooth curve (x, y) of t, positive on its right.

    The curve is closed, or runs from the axis x = 0 back to it around the points in x >= 0.

    Args:
        at: points (n, 2) m for parameters (n,).
        slope: their derivatives.
        t: (k,) dense parameters in equal steps.
    """
    from scipy.spatial import cKDTree

    near, half = cKDTree(at(t)), (t[1] - t[0]) / 2

    def distance(x: Array) -> Array:
        flat = x.reshape(-1, 2)
        start = foot = t[near.query(flat)[1]]
        for _ in range(REFINED):
            along, span = slope(foot), flat - at(foot)
            foot = foot + (span * along).sum(-1) / (along**2).sum(-1)
            foot = np.clip(foot, np.maximum(start - half, t[0]), np.minimum(start + half, t[-1] + 2 * half))
        along, span = slope(foot), flat - at(foot)
        right = np.stack([along[:, 1], -along[:, 0]], axis=1)
        across = (span * right).sum(-1) / np.linalg.norm(along, axis=1)
        found: Array = np.copysign(np.linalg.norm(span, axis=1), across)
        return found.reshape(x.shape[:-1])

    return distance
