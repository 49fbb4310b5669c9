"""Rims that come to lie flat on a plane and have no lowest point there: three points of the rim hold them."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from modelgen.geometry.domains import domain_of
from modelgen.geometry.regions import JOINED, point_of
from modelgen.scene.expression import Number
from modelgen.scene.poses import rotation_of, to_outer
from modelgen.scene.types import Condition, Feature, Shape

RIMS = ("circle", "ellipse_curve")
PADS = 3


def is_rim(feature: Feature) -> bool:
    """Whether the feature is a closed curve in a plane that bounds a face."""
    return bool(feature.name) and (feature.shape.kind in RIMS or _is_own_rim(feature))


def _is_own_rim(feature: Feature) -> bool:
    """A curve of the user's own, closed and in a plane z = const of its axes."""
    curve = feature.shape.curve
    if curve is None or not isinstance(curve.components[2].tree, Number):
        return False
    ends = [point_of(feature.shape, t) for t in domain_of(feature.shape)[0]]
    whole = not any(condition.kind == "parameter" for condition in feature.conditions)
    return whole and float(np.linalg.norm(ends[1] - ends[0])) <= JOINED * float(np.linalg.norm(ends[0]))


def is_pad(feature: Feature) -> bool:
    return any(condition.kind == "tilt" for condition in feature.conditions)


def bearer_of(name: str) -> str:
    """The name of the rim that a point of it is named after; of any other feature its own."""
    return name.rsplit(".", 1)[0]


def pads_of(feature: Feature) -> tuple[Feature, ...]:
    """Points of a rim a third of a turn apart, there while it is flat on a plane; none of other features."""
    if not is_rim(feature):
        return ()
    axis = tuple(float(x) for x in rotation_of(feature.shape.pose.quaternion)[:, 2])
    flat = Condition("tilt", (*axis, -1.0), None)
    return tuple(
        Feature(f"{feature.name}.{k + 1}", 0, _point(feature.shape, k), (flat,)) for k in range(PADS)
    )


def _point(rim: Shape, k: int) -> Shape:
    low, high = (0.0, 2 * pi) if rim.kind in RIMS else domain_of(rim)[0]
    at = to_outer(rim.pose, point_of(rim, low + (high - low) * k / PADS))
    return Shape("point", tuple(zip("xyz", map(float, at), strict=True)))


def tilted(feature: Feature) -> Feature:
    """A rim as it touches a plane: not while it is flat."""
    return replace(feature, conditions=(*feature.conditions, Condition("tilt", (0.0, 0.0, 1.0, 1.0), None)))
