"""Points on the edges at which a chart or a spline is open, where nothing follows it, and ends of curves."""

from __future__ import annotations

from math import ceil

import numpy as np

from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.shape_samples import AT_END, ends_of_curve, extent_of, points_and_areas, value_of
from modelgen.rotations import Array, rotation_of
from modelgen.scene.scene_types import Condition, Feature, Shape

COARSE = 64  # samples of a side, for its length
MOST = 1000  # points of a shape, about


def is_sheet(shape: Shape) -> bool:
    """Whether the shape may have open edges or ends. Solids have none: where nothing follows a face of
    theirs, it meets others at an angle."""
    own = (shape.chart, shape.curve, shape.spline, shape.outline)
    return any(each is not None for each in own)


def open_edge_points(shape: Shape, spacing: float) -> Array:
    """(n, 3) m, axes of a sheet: points of its open edges, not much farther apart than `spacing` m; of a
    curve its open ends."""
    features = features_of(shape).features
    faces = [each for each in features if each.dimension == 2]
    if not faces:
        found = [_ends_of_curve(each) for each in features if each.dimension == 1]
        return np.concatenate([np.zeros((0, 3)), *found])
    sides = [(face, each) for face in faces for each in face.conditions if each.next is None]
    found = [_on_side(face, each, spacing, MOST // len(sides) + 2) for face, each in sides]
    return np.concatenate([np.zeros((0, 3)), *found])


def _ends_of_curve(curve: Feature) -> Array:
    """The ends of a piece of a curve that nothing follows."""
    which = [
        0 if condition.numbers[1] > 0 else 1
        for condition in curve.conditions
        if condition.kind == "parameter" and condition.next is None
    ]
    return ends_of_curve(curve.shape)[which]


def _on_side(face: Feature, end: Condition, spacing: float, most: int) -> Array:
    """Those where a face ends by a condition."""
    coarse = points_and_areas(face.shape, _coordinates(face, end, COARSE))[0]
    length = float(np.linalg.norm(np.diff(coarse, axis=0), axis=1).sum())
    return side_points(face, end, min(max(ceil(length / spacing), COARSE // 8), most))


def side_points(face: Feature, end: Condition, n: int) -> Array:
    """Up to n + 1 points, m, axes of the face's shape, from one end to the other of a side of the domain by
    which a face ends, as far as the face has them."""
    uv = _coordinates(face, end, n)
    points = points_and_areas(face.shape, uv)[0]
    reach, ends = float(np.linalg.norm(points, axis=1).max(initial=0.0)), domain_of(face.shape)
    is_kept = np.ones(len(points), dtype=bool)
    for condition in face.conditions:
        is_kept &= value_of(condition, uv, points) >= -AT_END * extent_of(condition, ends, reach)
    placed: Array = points @ rotation_of(face.shape.pose.quaternion).T + np.array(face.shape.pose.position)
    return placed[is_kept]


def _coordinates(face: Feature, end: Condition, n: int) -> Array:
    """Coordinates (2, n + 1) of a side of the domain."""
    numbers, ends = np.array(end.numbers), domain_of(face.shape)
    if end.kind == "parameter":
        axis, inward = int(numbers[0]), numbers[1]
    else:  # a wall of a graph over x and y
        axis = int(np.argmax(np.abs(numbers[1:3])))
        inward = numbers[1 + axis]
    uv = np.empty((2, n + 1))
    uv[axis], uv[1 - axis] = ends[axis][0 if inward > 0 else 1], np.linspace(*ends[1 - axis], n + 1)
    return uv
