"""Polylines: straight pieces and arcs of one radius over the corners, joined with a continuous tangent."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, tan
from typing import Any

import numpy as np

from modelgen.geometry.composites.feature_constructors import at_least, at_most, edge, smooth
from modelgen.scene.free_form_values import Polyline
from modelgen.scene.pose_arithmetic import frame
from modelgen.scene.scene_types import Composite, Feature, Shape
from modelgen.scene.spline_format import ROUNDING, STRAIGHT

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Part:
    """A smooth curve and the half width of its interval, which is symmetric."""

    name: str
    shape: Shape
    reach: float


def polyline(shape: Shape) -> Composite:
    """The features `piece_k` from the k-th point and `corner_k` at it, each leading to its neighbours."""
    line = shape.spline
    assert isinstance(line, Polyline)
    parts = _parts(line)
    count = len(parts)

    def feature(k: int) -> Feature:
        before = parts[k - 1].name if k > 0 or line.closed else None
        after = parts[(k + 1) % count].name if k + 1 < count or line.closed else None
        part = parts[k]
        return edge(part.name, part.shape, at_least(0, -part.reach, before), at_most(0, part.reach, after))

    return Composite(tuple(feature(k) for k in range(count)), convex=False)


def _parts(line: Polyline) -> list[Part]:
    """The pieces and arcs in their order along the line; what has no length is left out."""
    points = np.array(line.points)
    count = len(points)
    pieces = count if line.closed else count - 1
    along = [_unit(points[(k + 1) % count] - points[k]) for k in range(pieces)]
    turns = [0.0] * (count + 1)
    for k in range(count) if line.closed else range(1, count - 1):
        turn = _angle(along[k - 1], along[k])
        turns[k] = turn if turn > STRAIGHT else 0.0
    turns[count] = turns[0] if line.closed else 0.0
    parts = []
    for k in range(pieces):
        if turns[k]:
            parts.append(_arc(k, points[k], along[k - 1], along[k], turns[k], line.radius))
        start, end = (
            line.radius * tan(turns[j] / 2) if turns[j] else 0.0 for j in (k, (k + 1) % (count + 1))
        )
        whole = float(np.linalg.norm(points[(k + 1) % count] - points[k]))
        length = whole - start - end
        if length > ROUNDING * whole:
            middle = points[k] + along[k] * (start + length / 2)
            pose = frame(middle, along[k], _across(along[k]))
            parts.append(Part(f"piece_{k}", smooth("edge", pose, length=length), length / 2))
    return parts


def _arc(k: int, corner: Array, before: Array, after: Array, turn: float, radius: float) -> Part:
    """The arc at a corner: x from its centre to the corner, y along the line halfway."""
    outward, halfway = _unit(before - after), _unit(before + after)
    centre = corner - outward * (radius / cos(turn / 2))
    pose = frame(centre, outward, np.cross(outward, halfway))
    return Part(f"corner_{k}", smooth("circle", pose, radius=radius), turn / 2)


def _angle(a: Array, b: Array) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def _across(direction: Array) -> Array:
    """A unit vector perpendicular to another."""
    return _unit(np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))]))


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x))
