"""Extent of a shape: surface, curve, point or composite."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import product
from math import hypot, inf, isfinite, sqrt

import numpy as np

from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.points import is_point
from modelgen.geometry.shape_features import features_of, is_composite
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.scene.pose_arithmetic import to_outer
from modelgen.scene.scene_types import Shape, Vector


@lru_cache(maxsize=512)
def bounding_radius(shape: Shape) -> float:
    """Radius (m) about the shape's origin; infinite for what has no bound."""
    numbers = [value for _, value in shape.parameters]
    if shape.kind in _CLOSED_FORMS and is_composite(shape):
        return _CLOSED_FORMS[shape.kind](numbers)
    if is_composite(shape) and shape.chart is None:
        return _of_features(shape)
    if is_point(shape):
        return hypot(*numbers)
    return (curve_of(shape) if is_curve(shape) else surface_of(shape)).bounding(numbers)


_CLOSED_FORMS: Mapping[str, Callable[[list[float]], float]] = {
    "box": lambda p: hypot(*p) / 2,
    "cylinder": lambda p: hypot(p[0], p[1] / 2),
    "disc": lambda p: p[0],
    "capsule": lambda p: p[0] + p[1] / 2,
    "cone": lambda p: inf,
    "tube": lambda p: hypot(p[0], p[2] / 2),
    "frustum": lambda p: hypot(max(p[0], p[1]), p[2] / 2),
    "dome": lambda p: max(p[1], sqrt(p[1] * (2 * p[0] - p[1]))),
    "half_torus": lambda p: p[0] + p[1],
    "polyhedron": lambda p: max(hypot(*p[k : k + 3]) for k in range(0, len(p), 3)),
}


def _of_features(shape: Shape) -> float:
    """The largest reach of a feature; faces without bound, planes and the like, end at the edges."""
    reaches = (_reach(feature.shape) for feature in features_of(shape).features)
    return max(filter(isfinite, reaches), default=inf)


def bounding_ball(shape: Shape) -> tuple[Vector, float]:
    """Centre (m, shape axes) and radius of a ball around the shape, about the shape's origin but for a point,
    which is its own ball, and a spline's cell: that lies in the hull of its control points, far from the
    origin of the net."""
    p = [value for _, value in shape.parameters]
    if is_point(shape):
        return (p[0], p[1], p[2]), 0.0
    if shape.kind in ("bezier", "bezier_curve"):
        points = np.array([p[:3], *(np.add(p[:3], p[k : k + 3]) for k in range(3, len(p), 3))])
    elif shape.kind == "bezier_graph":
        heights = [p[4], *(p[4] + step for step in p[5:])]
        ends = ((p[0], p[0] + p[1]), (p[2], p[2] + p[3]), (min(heights), max(heights)))
        points = np.array(list(product(*ends)))
    else:
        return (0.0, 0.0, 0.0), bounding_radius(shape)
    x, y, z = map(float, (points.min(axis=0) + points.max(axis=0)) / 2)
    return (x, y, z), float(np.linalg.norm(points - (x, y, z), axis=1).max())


def _reach(part: Shape) -> float:
    if part.kind == "edge":
        half = part.parameters[0][1] / 2
        return max(hypot(*to_outer(part.pose, (end, 0.0, 0.0))) for end in (-half, half))
    return hypot(*part.pose.position) + bounding_radius(part)
