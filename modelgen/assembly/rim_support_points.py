"""Support points: a rim or crest that lies flat on a plane has no unique lowest point; three points of it
hold it."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin
from typing import Any

import numpy as np

from modelgen.geometry.convex_cells import range_of
from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.face_regions import JOINED, point_of
from modelgen.rotations import rotation_of
from modelgen.scene.expression import Number
from modelgen.scene.pose_arithmetic import to_outer
from modelgen.scene.scene_types import Condition, Feature, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

RIMS = ("circle", "ellipse_curve")
SUPPORT_POINTS = 3


def is_rim(feature: Feature) -> bool:
    """Whether the feature is a closed curve in a plane that bounds a face."""
    return bool(feature.name) and (feature.shape.kind in RIMS or _is_own_rim(feature))


def _is_own_rim(feature: Feature) -> bool:
    """A curve of the user's own, closed and in a plane z = const of its axes."""
    curve = feature.shape.curve
    if curve is None or not isinstance(curve.components[2].tree, Number):
        return False
    ends = [point_of(feature.shape, t) for t in domain_of(feature.shape)[0]]
    whole = not any(each.kind == "parameter" and each.next != feature.name for each in feature.conditions)
    return whole and float(np.linalg.norm(ends[1] - ends[0])) <= JOINED * float(np.linalg.norm(ends[0]))


def is_support_point(feature: Feature) -> bool:
    return any(condition.kind == "tilt" for condition in feature.conditions)


def rim_of(name: str) -> str:
    """The name of the rim that a point of it is named after; of any other feature its own."""
    return name.rsplit(".", 1)[0]


def lies_flat(feature: Feature) -> bool:
    """Whether the feature is replaced by support points where it lies flat on a plane: a rim, or the ring of
    a torus."""
    return is_rim(feature) or (bool(feature.name) and feature.shape.kind == "torus")


def support_points_of(feature: Feature) -> tuple[Feature, ...]:
    """Support points: three of a rim, or of each crest of a torus, a third of a turn apart; of an arc or a
    half torus the ends and the middle.

    They are there while it is flat on a plane. None of other features.
    """
    if not lies_flat(feature):
        return ()
    if is_rim(feature):
        side = _outward_side(feature)
        places = [(point_of(feature.shape, t), side) for t in held_places(feature)]
    else:
        places = [(at, float(np.sign(at[2]))) for at in _on_crests(feature)]
    axis = rotation_of(feature.shape.pose.quaternion)[:, 2]
    return tuple(
        Feature(f"{feature.name}.{k}", 0, _point(feature.shape, at), (_flat(axis, side),))
        for k, (at, side) in enumerate(places, start=1)
    )


def _outward_side(rim: Feature) -> float:
    """1 or -1 if a solid lies below or above the plane of its rim, in the axes of the rim; 0 if it is on both
    sides of it, as a disc without thickness is."""
    rises = [each.numbers[1] for each in rim.conditions if each.kind == "wing"]
    below, above = min(rises, default=0.0) < 0, max(rises, default=0.0) > 0
    return float(below - above)


def _flat(axis: Array, side: float) -> Condition:
    """N within `flat_angle` of the axis, out of the side that is flat."""
    x, y, z = map(float, axis * (side or 1.0))
    return Condition("tilt", (x, y, z, -1.0, abs(side)), None)


def held_places(rim: Feature) -> list[float]:
    """Three parameters of a curve at which it is held: a third of a turn apart; of an arc the ends and the
    middle."""
    is_arc = any(each.kind == "parameter" and each.next != rim.name for each in rim.conditions)
    whole = (0.0, 2 * pi) if rim.shape.kind in RIMS else domain_of(rim.shape)[0]
    return spread(*range_of(rim), False) if is_arc else spread(*whole, True)


def spread(low: float, high: float, is_closed: bool) -> list[float]:
    """A third of the way round apart; of what is not closed the ends and the middle."""
    parts = SUPPORT_POINTS if is_closed else SUPPORT_POINTS - 1
    return [low + (high - low) * k / parts for k in range(SUPPORT_POINTS)]


def _on_crests(ring: Feature) -> list[Array]:
    """A third of a turn apart; of a half ring the ends and the middle."""
    (_, major), (_, minor) = ring.shape.parameters
    angles = spread(0.0, pi, False) if ring.conditions else spread(0.0, 2 * pi, True)
    return [
        np.array([major * cos(angle), major * sin(angle), z]) for z in (minor, -minor) for angle in angles
    ]


def _point(bearer: Shape, at: Array) -> Shape:
    return Shape("point", tuple(zip("xyz", map(float, to_outer(bearer.pose, at)), strict=True)))


def tilted(feature: Feature) -> Feature:
    """A rim or ring as it touches a plane: not while it is flat."""
    return replace(
        feature, conditions=(*feature.conditions, Condition("tilt", (0.0, 0.0, 1.0, 1.0, 0.0), None))
    )
