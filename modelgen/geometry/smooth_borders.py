"""Borders at which a face goes over into a face of another shape without an angle.

Both faces have the points of the border in common, and the outward normals there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite, sqrt
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.composites.feature_constructors import linear
from modelgen.geometry.convex_cells import range_of
from modelgen.geometry.coordinate_domains import domain_of, domain_within
from modelgen.geometry.face_regions import is_linear, points_of, polygon_of
from modelgen.geometry.frames import cross
from modelgen.geometry.open_edges import side_points
from modelgen.geometry.shape_samples import AT_END, extent_of, samples_of_face, value_of
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import to_inner, to_outer
from modelgen.scene.scene_types import Chart, Condition, Feature, Pose, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

SAMPLES = 17  # of a border
ALIGNED = 1e-9  # sine of an angle between normals that are one
GRID = 13  # places in each direction of a face from which the nearest point is sought
ROUNDS = 30  # of Newton's method, most
STEP = 1e-3  # of the length of a border, across it, for the side on which the face is
ACROSS = 40  # samples of a face in each direction, for whether its rest is covered
BORDERS = ("parameter", "quadric")  # conditions of a face that end it along a curve


@dataclass(frozen=True, slots=True)
class Border:
    """Where a face ends by a condition: points (n, 3) m and outward normals (n, 3), axes of the shape.

    `edge` is the name of the edge that follows; empty where nothing does. `inward` is the direction (3) into
    the face across a straight border; None of one that bends, or across which the face turns along it.
    """

    face: Feature
    condition: Condition
    points: Array
    normals: Array
    edge: str
    inward: Array | None


@dataclass(frozen=True, slots=True)
class Feet:
    """The points (n, 3) m of a face nearest to given ones, axes of the shape, the outward normals there,
    whether they lie on the face itself, not beyond its borders, and whether they are off its borders."""

    points: Array
    normals: Array
    is_on_face: Array
    is_within: Array


def borders_of(features: Sequence[Feature]) -> Iterator[Border]:
    """The borders of faces that other faces of the shape do not follow."""
    named = {each.name: each for each in features}
    for face in features:
        if face.dimension != 2:
            continue
        for condition in face.conditions:
            if condition.kind not in BORDERS:
                continue
            beyond = None if condition.next is None else named.get(condition.next)
            if beyond is None or beyond.dimension == 1:
                points = _points_on(face, condition, beyond)
                if len(points):
                    edge = "" if beyond is None else beyond.name
                    normals = feet(face, points).normals
                    yield Border(face, condition, points, normals, edge, _inward(face, points, normals))


def is_joined(border: Border, face: Feature, flush: float) -> Array:
    """(n,) whether the face has each point of the border, with the same outward normal; `flush` in m. The
    border is in the axes of the face's shape."""
    found = feet(face, border.points)
    apart = np.linalg.norm(found.points - border.points, axis=1)
    turned = np.linalg.norm(np.cross(found.normals, border.normals), axis=1)
    is_along = (found.normals * border.normals).sum(axis=1) > 0
    return np.asarray((apart <= flush) & (turned <= ALIGNED) & is_along & found.is_on_face)


def placed(border: Border, pose: Pose) -> Border:
    """The same border in the axes in which its shape has a pose."""
    points = to_outer(pose, border.points)
    R = rotation_of(pose.quaternion)
    inward = None if border.inward is None else R @ border.inward
    return Border(border.face, border.condition, points, border.normals @ R.T, border.edge, inward)


def end_at(border: Border, face: Feature, reach: float, flush: float) -> tuple[Condition, Array] | None:
    """The condition by which a face ends at the straight border of another one that goes over into it
    somewhere within, and points (n, 3) m of what it has behind that; None where there is no such border.

    The condition leans by 45 degrees, so that two borders of one curved face, as those of a rounded end, are
    told apart.

    Args:
        border: axes of the shape of the face that ends.
        reach: m, of that face.
        flush: m.
    """
    if border.inward is None or not is_joined(border, face, flush).all():
        return None
    if not feet(face, border.points).is_within.all():
        return None
    outward = (-border.inward - border.normals[0]) / sqrt(2)
    samples = samples_of_face(face, ACROSS, reach).points
    behind = samples[(samples - border.points[0]) @ outward < -flush]
    own = face.shape.pose
    return linear(to_inner(own, border.points[0]), outward @ rotation_of(own.quaternion), None), behind


def is_under(face: Feature, points: Array, flush: float) -> Array:
    """(n,) whether points (n, 3) m, axes of the shape, are below a face, next to the face itself."""
    found = feet(face, points)
    height = ((points - found.points) * found.normals).sum(axis=1)
    return np.asarray(found.is_on_face & (height <= flush))


def _inward(face: Feature, points: Array, normals: Array) -> Array | None:
    along = points - points[0]
    length = float(np.linalg.norm(along[-1]))
    if len(points) < 2 or not length > 0:
        return None
    tangent = along[-1] / length
    is_bent = np.linalg.norm(np.cross(along, tangent), axis=1).max() > ALIGNED * length
    across = np.cross(normals[0], tangent)
    if is_bent or np.abs(normals @ tangent).max() > ALIGNED or np.abs(normals - normals[0]).max() > ALIGNED:
        return None
    middle, step = points[len(points) // 2], STEP * length
    sides = [bool(feet(face, (middle + sign * step * across)[None]).is_within[0]) for sign in (1, -1)]
    return None if sides[0] == sides[1] else across if sides[0] else -across


def feet(face: Feature, points: Array) -> Feet:
    """The feet of points (n, 3) m, axes of the shape, on a face."""
    shape = face.shape
    uv, x, area = _foot_of(shape, to_inner(shape.pose, points))
    size = np.linalg.norm(area, axis=1, keepdims=True)
    normals = exterior_sign(shape) * area / np.where(size > 0, size, 1.0)
    reach = float(np.abs(x).max(initial=0.0))
    ends = domain_within(shape, reach)
    is_on, is_within = size[:, 0] > 0, size[:, 0] > 0
    for condition in face.conditions:
        slack = AT_END * extent_of(condition, ends, reach)
        value = value_of(condition, uv, x)
        is_on, is_within = is_on & (value >= -slack), is_within & (value > slack)
    turned = normals @ rotation_of(shape.pose.quaternion).T
    return Feet(to_outer(shape.pose, x), turned, is_on, is_within)


def _foot_of(shape: Shape, points: Array) -> tuple[Array, Array, Array]:
    """Coordinates (2, n), points (n, 3) and cross products of the tangents (n, 3) of the feet of points on a
    surface, in its axes."""
    if shape.kind == "plane":
        return points[:, :2].T, points * (1.0, 1.0, 0.0), np.tile((0.0, 0.0, 1.0), (len(points), 1))
    numbers = ca.DM([value for _, value in shape.parameters])
    jet = _jet(shape.kind, shape.chart, tuple(name for name, _ in shape.parameters))
    uv = _nearest_of_grid(shape, jet, numbers, points)
    for _ in range(ROUNDS):
        x, u, v, _ = (np.asarray(each).T for each in jet(uv, numbers))
        step = _least_squares(u, v, points - x)
        uv = uv + step
        if not np.abs(step).max(initial=0.0) > 1e-15 * (1 + np.abs(uv).max(initial=0.0)):
            break
    x, _, _, area = (np.asarray(each).T for each in jet(uv, numbers))
    return uv, x, area


def _points_on(face: Feature, condition: Condition, edge: Feature | None) -> Array:
    """Points of a border, axes of the shape, without its ends; none where they are not known."""
    if edge is not None:
        low, high = range_of(edge)
        if not (isfinite(low) and isfinite(high)):
            return np.zeros((0, 3))
        inner = np.linspace(low, high, SAMPLES + 2)[1:-1]
        return np.asarray(to_outer(edge.shape.pose, points_of(edge.shape, inner)))
    if face.shape.kind == "plane":
        return _points_on_side(face, condition)
    if not np.isfinite(domain_of(face.shape)).all():
        return np.zeros((0, 3))
    return side_points(face, condition, SAMPLES + 1)[1:-1]


def _points_on_side(face: Feature, condition: Condition) -> Array:
    """Points of a side of a flat face without its ends, axes of the shape; none where it is no polygon."""
    found = polygon_of(face.conditions) if all(map(is_linear, face.conditions)) else None
    if found is None or len(found[0]) < 3:
        return np.zeros((0, 3))
    sides, corners = found
    k = sides.index(condition)
    shares = np.linspace(0.0, 1.0, SAMPLES + 2)[1:-1, None]
    flat = corners[k] + shares * (corners[(k + 1) % len(corners)] - corners[k])
    return np.asarray(to_outer(face.shape.pose, np.column_stack([flat, np.zeros(len(flat))])))


def _nearest_of_grid(shape: Shape, jet: ca.Function, numbers: ca.DM, points: Array) -> Array:
    """(2, n) the coordinates on a grid over a face that are nearest to points (n, 3)."""
    reach = float(np.abs(points).max(initial=0.0)) + 1.0
    sides = [np.linspace(*each, GRID) for each in domain_within(shape, reach)]
    grid = np.array([entry.ravel() for entry in np.meshgrid(*sides, indexing="ij")])
    x = np.asarray(jet(grid, numbers)[0]).T
    nearest = np.linalg.norm(points[:, None, :] - x[None, :, :], axis=2).argmin(axis=1)
    return np.asarray(grid[:, nearest])


def _least_squares(u: Array, v: Array, off: Array) -> Array:
    """(2, n) the steps of both coordinates that bring points nearest by (n, 3), from the tangents (n, 3)."""
    uu, uv, vv = (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)
    by_u, by_v = (u * off).sum(axis=1), (v * off).sum(axis=1)
    area = uu * vv - uv * uv
    safe = np.where(area > 0, area, 1.0)
    step = np.array([vv * by_u - uv * by_v, uu * by_v - uv * by_u]) / safe
    return np.asarray(np.where(area > 0, step, 0.0))


@lru_cache(maxsize=64)
def _jet(kind: str, chart: Chart | None, names: tuple[str, ...]) -> ca.Function:
    """Coordinates (2), parameters -> point, both tangents and their cross product (3 each)."""
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(names))
    jet = surface_of(Shape(kind, tuple((name, 0.0) for name in names), chart=chart)).jet(uv, p)
    u, v = jet.first[:, 0], jet.first[:, 1]
    return ca.Function("jet", [uv, p], [ca.densify(each) for each in (jet.x, u, v, cross(u, v))])
