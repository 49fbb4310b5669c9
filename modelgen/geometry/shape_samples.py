"""Points and exterior normals on a shape, dense enough to say on which side of it a point lies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite, sqrt

import casadi as ca
import numpy as np

from modelgen.geometry.coordinate_domains import domain_of, domain_within
from modelgen.geometry.curves import curve_of
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.frames import cross
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.rotations import Array, rotation_of
from modelgen.scene.custom_solid_checks import quadric
from modelgen.scene.scene_types import Chart, Condition, Feature, Pose, Shape

POINTS = 2500  # of a surface, about
ALONG = 400  # of a curve, about
LEAST = 4  # samples of a feature in each direction, at least
AT_END = 1e-6  # part of the domain, or of the size, within which a sample is at an end of the surface


@dataclass(frozen=True, slots=True)
class Samples:
    """Samples of a shape in its own axes, m.

    Attributes:
        points: (n, 3).
        normals: (n, 3), out of the material; zero at the ends of a surface that is not closed. (0, 3) of a
            curve.
        spacing: the largest distance of a point of the shape to the nearest sample, about.
    """

    points: Array
    normals: Array
    spacing: float


def samples_of(shape: Shape) -> Samples | None:
    """Samples of a surface, or of a curve or a point; None of a curve without end.

    Features of a composite are sampled each by itself: its faces if it has some, else its curves.
    """
    features = features_of(shape).features
    highest = max(feature.dimension for feature in features)
    parts = [feature for feature in features if feature.dimension == highest]
    if highest == 0:
        return Samples(np.array([value for _, value in parts[0].shape.parameters]).reshape(1, 3), _NONE, 0.0)
    reach = bounding_radius(shape)
    if highest == 1:
        curves = [_of_curve(part.shape, max(ALONG // len(parts), LEAST)) for part in parts]
        known = [curve for curve in curves if curve is not None]
        return _joined(known) if len(known) == len(curves) else None
    side = max(int(sqrt(POINTS / len(parts))), LEAST)
    return _joined([samples_of_face(part, side, reach) for part in parts])


_NONE = np.zeros((0, 3))


def _joined(parts: Sequence[Samples]) -> Samples:
    return Samples(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        max(part.spacing for part in parts),
    )


def _of_curve(curve: Shape, n: int) -> Samples | None:
    ((lower, upper),) = domain_of(curve)
    if not (isfinite(lower) and isfinite(upper)):
        return None
    t, numbers = ca.SX.sym("t"), ca.DM([value for _, value in curve.parameters])
    point = ca.Function("point", [t], [ca.densify(curve_of(curve).jet(t, ca.SX(numbers)).x)])
    points = np.asarray(point(np.linspace(lower, upper, n).reshape(1, -1))).T
    return Samples(_placed(curve.pose, points), _NONE, _longest(points))


def ends_of_curve(curve: Shape) -> Array:
    """(2, 3) m: the points at both ends of the domain of a curve; (0, 3) if it has no end."""
    ends = _of_curve(curve, 2)
    return _NONE if ends is None else ends.points


def samples_of_face(face: Feature, side: int, reach: float) -> Samples:
    """Those of a face, axes of the shape, by `side` in each direction; `reach`, m, bounds a coordinate that
    has no bound."""
    shape = face.shape
    ends = domain_within(shape, reach)
    u, v = (np.linspace(*each, side) for each in ends)
    uv = np.array([entry.ravel() for entry in np.meshgrid(u, v, indexing="ij")])
    points, areas = points_and_areas(shape, uv)
    areas = exterior_sign(shape) * areas
    grid = points.reshape(side, side, 3)
    spacing = float(np.hypot(_longest(grid), _longest(grid.swapaxes(0, 1)))) / 2
    size = np.linalg.norm(areas, axis=1)
    is_kept, is_end = size > AT_END * size.max(initial=0.0), np.zeros(len(size), dtype=bool)
    for condition in face.conditions:
        slack = AT_END * extent_of(condition, ends, reach)
        value = value_of(condition, uv, points)
        is_kept &= value >= -slack
        is_end |= (condition.next is None) & (value <= slack)
    normals = np.where(is_end[:, None], 0.0, areas / np.where(size > 0, size, 1.0)[:, None])
    turned = normals @ rotation_of(shape.pose.quaternion).T
    return Samples(_placed(shape.pose, points)[is_kept], turned[is_kept], spacing)


def points_and_areas(shape: Shape, uv: Array) -> tuple[Array, Array]:
    """Points (n, 3) m of a surface at uv (2, n), and c_u x c_v, in its own axes."""
    names = tuple(name for name, _ in shape.parameters)
    values = _face(shape.kind, shape.chart, names)(uv, ca.DM([value for _, value in shape.parameters]))
    x, area = (np.asarray(value).T for value in values)
    return x, area


@lru_cache(maxsize=64)
def _face(kind: str, chart: Chart | None, names: tuple[str, ...]) -> ca.Function:
    """Coordinates (2), parameters -> point (3) and c_u x c_v (3) of a kind of surface."""
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(names))
    jet = surface_of(Shape(kind, tuple((name, 0.0) for name in names), chart=chart)).jet(uv, p)
    area = cross(jet.first[:, 0], jet.first[:, 1])
    return ca.Function("face", [uv, p], [ca.densify(jet.x), ca.densify(area)])


def value_of(condition: Condition, uv: Array, points: Array) -> Array:
    """(n,) the condition of a face, >= 0 on it."""
    numbers = condition.numbers
    if condition.kind == "quadric":
        return quadric(numbers, points)
    if condition.kind == "parameter":
        index, sign, bound = numbers
        return np.asarray(sign * (uv[int(index)] - bound))
    if condition.kind == "disc":
        return np.asarray(numbers[0] ** 2 - (uv**2).sum(axis=0))
    return np.ones(uv.shape[1])


def extent_of(condition: Condition, ends: Sequence[tuple[float, float]], reach: float) -> float:
    """The size of what a condition measures."""
    if condition.kind == "parameter":
        lower, upper = ends[int(condition.numbers[0])]
        return upper - lower
    return reach if condition.kind == "quadric" else 1.0


def _longest(points: Array) -> float:
    """The longest step along the first axis."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=-1).max(initial=0.0))


def _placed(pose: Pose, points: Array) -> Array:
    placed: Array = points @ rotation_of(pose.quaternion).T + np.array(pose.position)
    return placed
