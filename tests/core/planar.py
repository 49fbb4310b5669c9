"""Plane regions for tests, by the curves of region_kinds.c, and another way to their overlap."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos, hypot, pi, sin
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from modelgen.runtime.region_overlap import Arc

Array = np.ndarray[Any, Any]
EDGE, CIRCLE, ELLIPSE, WAVE, CUBIC = range(5)
TURN = (-pi, pi)


def at(x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> Array:
    """(12,) the placement of a curve, turned about z."""
    c, s = cos(angle), sin(angle)
    return np.array([x, y, 0, c, s, 0, -s, c, 0, 0, 0, 1])


def facing(x: float = 0.0, y: float = 0.0, angle: float = 0.0) -> Array:
    """(12,) the pose of a face that looks against o's."""
    c, s = cos(angle), sin(angle)
    return np.array([x, y, 0, c, s, 0, s, -c, 0, 0, 0, -1])


def polygon(corners: Any, loop: int = 0) -> list[Arc]:
    arcs = []
    corners = np.asarray(corners, dtype=float)
    for p, q in pairwise([*corners, corners[0]]):
        length, middle = hypot(*(q - p)), (p + q) / 2
        turn = np.arctan2(q[1] - p[1], q[0] - p[0])
        placement = tuple(at(middle[0], middle[1], turn))
        arcs.append(Arc(EDGE, (length,), (-length / 2, length / 2), placement, loop))
    return arcs


def rectangle(a: float, b: float) -> list[Arc]:
    return polygon([[-a, -b], [a, -b], [a, b], [-a, b]])


def regular(n: int) -> list[Arc]:
    angle = 2 * pi * np.arange(n) / n
    return polygon(np.stack([np.cos(angle), np.sin(angle)], axis=1))


def disc(radius: float, x: float = 0.0, y: float = 0.0, loop: int = 0) -> list[Arc]:
    return [Arc(CIRCLE, (radius,), TURN, tuple(at(x, y)), loop)]


def annulus(outer: float, inner: float) -> list[Arc]:
    return disc(outer) + disc(inner, loop=1)


def ellipse(a: float, b: float) -> list[Arc]:
    return [Arc(ELLIPSE, (a, b), TURN)]


def wave(radius: float, height: float, n: int) -> list[Arc]:
    """r = radius + height cos(n angle), convex or not."""
    return [Arc(WAVE, (radius, height, n), TURN)]


def stadium(a: float, r: float) -> list[Arc]:
    below, above = polygon([[-a, -r], [a, -r]])[0], polygon([[a, r], [-a, r]])[0]
    right = Arc(CIRCLE, (r,), (-pi / 2, pi / 2), tuple(at(a)))
    left = Arc(CIRCLE, (r,), (pi / 2, 3 * pi / 2), tuple(at(-a)))
    return [below, right, above, left]


LETTER = [[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1]]
FRAME = rectangle(1, 1) + polygon([[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]], loop=1)


def curve(arc: Arc, t: Array) -> Array:
    """(n, 2) the points of an arc, by formulas of its own."""
    q = arc.parameters
    if arc.shape == EDGE:
        x, y = t, 0 * t
    elif arc.shape == CUBIC:
        x, y = t, q[0] + t * (q[1] + t * (q[2] + t * q[3]))
    elif arc.shape == WAVE:
        r = q[0] + q[1] * np.cos(q[2] * t)
        x, y = r * np.cos(t), r * np.sin(t)
    else:
        x, y = q[0] * np.cos(t), q[-1] * np.sin(t)
    return moved(np.asarray(arc.placement, dtype=float), np.stack([x, y], axis=1))


def moved(pose: Array, points: Array) -> Array:
    return np.asarray(pose[:2] + points @ pose[[3, 4, 6, 7]].reshape(2, 2))


def sampled(arcs: Sequence[Arc], pose: Array, n: int) -> list[Array]:
    """The boundary as polygons: straight arcs by their starts, curves by n points."""
    loops: dict[int, list[Array]] = {}
    for arc in arcs:
        t = np.linspace(*arc.ends, 2 if arc.shape == EDGE else n)[:-1]
        loops.setdefault(arc.loop, []).append(moved(pose, curve(arc, t)))
    return [np.concatenate(parts) for parts in loops.values()]


def inside(loops: list[Array], points: Array) -> Array:
    """(m,) whether points are in a region of polygons: a ray crosses them an odd number of times."""
    found = np.zeros(len(points), dtype=bool)
    for loop in loops:
        p, q = loop[None], np.roll(loop, -1, axis=0)[None]
        x, y = points[:, :1], points[:, 1:]
        straddles = (p[..., 1] > y) != (q[..., 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            reached = p[..., 0] + (y - p[..., 1]) / (q[..., 1] - p[..., 1]) * (q[..., 0] - p[..., 0])
        found ^= (np.sum(straddles & (x < reached), axis=1) % 2).astype(bool)
    return found


def crossings(first: list[Array], second: list[Array]) -> Array:
    """(k, 2) where sides of polygons cross."""
    p, q = (np.concatenate(part) for part in zip(*((a, np.roll(a, -1, axis=0)) for a in first), strict=True))
    r, s = (np.concatenate(part) for part in zip(*((a, np.roll(a, -1, axis=0)) for a in second), strict=True))
    u, v, w = (q - p)[:, None], (s - r)[None], r[None] - p[:, None]
    det = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (w[..., 0] * v[..., 1] - w[..., 1] * v[..., 0]) / det
        b = (w[..., 0] * u[..., 1] - w[..., 1] * u[..., 0]) / det
    i, j = np.nonzero((a >= 0) & (a <= 1) & (b >= 0) & (b <= 1))
    return np.asarray(p[i] + a[i, j][:, None] * (q - p)[i])


def brute_margin(
    o: Sequence[Arc], f: Sequence[Arc], pose: Array, points: Array, n: int = 200
) -> Array | None:
    """Margins by polygons for curves and scipy's hull of points of both regions; None: too few."""
    b = sampled(f, pose, n)
    shared = np.concatenate(b)
    if o:
        a = sampled(o, at(), n)
        kept = [shared[inside(a, shared)], np.concatenate(a)[inside(b, np.concatenate(a))]]
        shared = np.concatenate([*kept, crossings(a, b)])
    if len(shared) < 3 or np.linalg.matrix_rank(shared - shared[0], tol=1e-6) < 2:
        return None
    corners = shared[ConvexHull(shared).vertices]
    return np.array([signed_distance(corners, x) for x in points])


def signed_distance(corners: Array, x: Array) -> float:
    """Of x to a convex polygon, corners anticlockwise; positive inside."""
    sides = np.roll(corners, -1, axis=0) - corners
    part = np.clip(np.sum((x - corners) * sides, axis=1) / np.sum(sides**2, axis=1), 0, 1)
    nearest = np.min(np.hypot(*(corners + part[:, None] * sides - x).T))
    within = np.all(sides[:, 0] * (x - corners)[:, 1] >= sides[:, 1] * (x - corners)[:, 0])
    return float(nearest if within else -nearest)
