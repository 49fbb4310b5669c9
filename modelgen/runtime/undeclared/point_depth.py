"""How deep points lie in the material of a shape: negative inside, positive outside.

Every function g is at most the distance to the surface in size: |g(x) - g(y)| <= |x - y|. Its sign is exact,
but for shapes known by samples only, of which points within the spacing of the samples count as outside.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]
Depth = Callable[[Array], Array]  # (n, 3) m, shape axes -> (n,) m

STEEP = 0.5  # of a paraboloid: what bounds its function's slope where it is not near the surface


def depth_of(entry: Mapping[str, Any]) -> Depth | None:
    """The function g of one shape of the manifest's table `unlisted`, in the axes of its body's centre of
    mass; None of what has no material."""
    inner = _own(entry)
    if entry["thin"] or inner is None:
        return None
    placement, sign = np.array(entry["placement"]), -1.0 if entry["cavity"] else 1.0
    p, R = placement[:3], placement[3:].reshape(3, 3, order="F")
    if entry["kind"] == "sampled":  # its normals point out of a cavity's material
        sign = 1.0
    return lambda x: sign * inner((x - p) @ R)


def points_of(entry: Mapping[str, Any]) -> Array:
    """(n, 3) m: the samples of a shape known by them, in the axes of its body's centre of mass."""
    placement = np.array(entry["placement"])
    points = np.array(entry["points"]).reshape(-1, 3)
    placed: Array = points @ placement[3:].reshape(3, 3, order="F").T + placement[:3]
    return placed


def _own(entry: Mapping[str, Any]) -> Depth | None:
    kind, p = entry["kind"], [float(value) for value in entry["parameters"]]
    if kind == "sampled":
        return _sampled(entry)
    return FORMULAS[kind](p) if kind in FORMULAS else None


def _rho(x: Array) -> Array:
    return np.hypot(x[:, 0], x[:, 1])


def _norm(x: Array) -> Array:
    return np.asarray(np.linalg.norm(x, axis=1))


def _highest(*parts: Array) -> Array:
    return np.asarray(np.maximum.reduce(parts))


def _ellipsoid(p: Sequence[float]) -> Depth:
    axes = np.array(p[:3])
    return lambda x: np.asarray((_norm(x / axes) - 1) * axes.min())


def _superellipsoid(p: Sequence[float]) -> Depth:
    axes, P, Q = np.array(p[:3]), p[3], p[4]

    def depth(x: Array) -> Array:
        size = np.abs(x / axes)
        largest = np.maximum(size.max(axis=1), np.finfo(float).tiny)
        size = size / largest[:, None]
        across = (size[:, 0] ** P + size[:, 1] ** P) ** (Q / P)
        gauge = largest * (across + size[:, 2] ** Q) ** (1 / Q)
        return np.asarray((gauge - 1) * axes.min())

    return depth


def _torus(p: Sequence[float]) -> Depth:
    return lambda x: np.asarray(np.hypot(_rho(x) - p[0], x[:, 2]) - p[1])


def _half_torus(p: Sequence[float]) -> Depth:
    ring = _torus(p)
    return lambda x: _highest(ring(x), -x[:, 1])


def _cylinder(p: Sequence[float]) -> Depth:
    if len(p) == 1:
        return lambda x: _rho(x) - p[0]
    return lambda x: _highest(_rho(x) - p[0], np.abs(x[:, 2]) - p[1] / 2)


def _tube(p: Sequence[float]) -> Depth:
    return lambda x: _highest(_rho(x) - p[0], p[1] - _rho(x), np.abs(x[:, 2]) - p[2] / 2)


def _cone(p: Sequence[float]) -> Depth:
    return lambda x: np.asarray(_rho(x) * np.cos(p[0]) + x[:, 2] * np.sin(p[0]))


def _frustum(p: Sequence[float]) -> Depth:
    bottom, top, length = p
    slope = (top - bottom) / length
    across = 1 / np.hypot(1.0, slope)

    def depth(x: Array) -> Array:
        side = (_rho(x) - (bottom + top) / 2 - slope * x[:, 2]) * across
        return _highest(side, np.abs(x[:, 2]) - length / 2)

    return depth


def _paraboloid(p: Sequence[float]) -> Depth:
    def depth(x: Array) -> Array:
        slope = x[:, :2] / p
        above = x[:, 2] - (slope * x[:, :2]).sum(axis=1) / 2
        return np.asarray(STEEP * above / np.hypot(1.0, _norm(slope)))

    return depth


def _box(p: Sequence[float]) -> Depth:
    half = np.array(p[:3]) / 2
    return lambda x: np.asarray((np.abs(x) - half).max(axis=1))


def _capsule(p: Sequence[float]) -> Depth:
    radius, half = p[0], p[1] / 2
    return lambda x: np.asarray(np.hypot(_rho(x), np.maximum(np.abs(x[:, 2]) - half, 0.0)) - radius)


def _polyhedron(p: Sequence[float]) -> Depth:
    from scipy.spatial import ConvexHull

    planes = ConvexHull(np.array(p).reshape(-1, 3)).equations
    return lambda x: np.asarray((x @ planes[:, :3].T + planes[:, 3]).max(axis=1))


def _extrusion(p: Sequence[float]) -> Depth:
    corners, half = np.array(p[:-1]).reshape(-1, 2), p[-1] / 2
    return lambda x: _highest(_to_polygon(corners, x[:, :2]), np.abs(x[:, 2]) - half)


def _to_polygon(corners: Array, x: Array) -> Array:
    """(n,) m: the signed distance of points (n, 2) to a polygon, negative inside."""
    side = np.roll(corners, -1, axis=0) - corners
    arm = x[:, None] - corners
    along = np.clip((arm * side).sum(axis=-1) / (side**2).sum(axis=-1), 0.0, 1.0)
    nearest = np.linalg.norm(arm - along[..., None] * side, axis=-1).min(axis=1)
    is_between = (arm[..., 1] >= 0) != (arm[..., 1] >= side[:, 1])
    is_left = (side[:, 0] * arm[..., 1] - side[:, 1] * arm[..., 0] > 0) == (side[:, 1] > 0)
    is_inside = (is_between & is_left).sum(axis=1) % 2 == 1
    return np.asarray(np.where(is_inside, -nearest, nearest))


def _sampled(entry: Mapping[str, Any]) -> Depth | None:
    """By the nearest sample and its normal; where that is at the end of a surface, points are outside."""
    from scipy.spatial import KDTree

    points, normals = (np.array(entry[key]).reshape(-1, 3) for key in ("points", "normals"))
    if not len(normals):
        return None
    tree, spacing = KDTree(points), float(entry["parameters"][0])
    is_end = np.abs(normals).max(axis=1) == 0

    def depth(x: Array) -> Array:
        distance, nearest = tree.query(x)
        is_inside = (((x - points[nearest]) * normals[nearest]).sum(axis=1) < 0) & ~is_end[nearest]
        return np.asarray(np.where(is_inside, -distance, distance) + spacing)

    return depth


FORMULAS: Mapping[str, Callable[[Sequence[float]], Depth]] = {
    "plane": lambda p: lambda x: np.asarray(x[:, 2]),
    "sphere": lambda p: lambda x: _norm(x) - p[0],
    "ellipsoid": _ellipsoid,
    "superellipsoid": _superellipsoid,
    "torus": _torus,
    "half_torus": _half_torus,
    "cylinder": _cylinder,
    "tube": _tube,
    "cone": _cone,
    "frustum": _frustum,
    "paraboloid": _paraboloid,
    "box": _box,
    "capsule": _capsule,
    "polyhedron": _polyhedron,
    "extrusion": _extrusion,
}
