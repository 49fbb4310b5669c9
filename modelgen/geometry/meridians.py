"""The meridian of a surface of revolution about z: its part at azimuth 0."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite, pi
from typing import Any

import numpy as np

from modelgen.geometry.composites.charts_with_ends import is_open
from modelgen.geometry.composites.feature_constructors import at_least, at_most
from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.face_regions import points_of
from modelgen.geometry.revolved_charts import ZERO, T, meridian_of_chart
from modelgen.rotations import rotation_of
from modelgen.scene.expression import Name, Number
from modelgen.scene.expression_algebra import cos, expression_of, over, sin, times
from modelgen.scene.scene_types import Chart, Condition, Curve, Feature, Pose, Shape

CONICAL = ("cone", "conical_side")
SAMPLES = 65  # of a profile, for the side of its exterior


def meridian_of(feature: Feature) -> Feature | None:
    """The part at azimuth 0 of a ring, or of a surface of revolution that a ball can touch all around, in the
    axes of the feature's shape: material of it, without an own name. None of other features.

    Of a torus it is the ball in it.
    """
    shape, conditions = feature.shape, feature.conditions
    values = dict(shape.parameters)
    if shape.kind == "circle":
        point = _part(0, "point", Pose(), x=values["radius"], y=0.0, z=0.0)
        return replace(
            point, conditions=tuple(_in_meridian(each) for each in conditions if each.kind == "wing")
        )
    if shape.kind == "torus" and not shape.cavity and not conditions:
        return _part(2, "sphere", Pose((values["major"], 0.0, 0.0)), radius=values["minor"])
    if shape.kind in CONICAL and shape.cavity:
        line = _part(1, "line", _generator(shape))
        return replace(line, conditions=_seen_from(line.shape.pose, conditions))
    curve = _curve_of(feature)
    if curve is None:
        return None
    return Feature("", 1, Shape("curve", shape.parameters, curve=curve), _along(curve, conditions))


def _part(dimension: int, kind: str, pose: Pose, **parameters: float) -> Feature:
    return Feature("", dimension, Shape(kind, tuple(parameters.items()), pose=pose))


def _in_meridian(wing: Condition) -> Condition:
    """The wing of a rim where azimuth 0 is."""
    outward, along_z = wing.numbers
    return Condition("direction", (outward, 0.0, along_z), None)


def _generator(shape: Shape) -> Pose:
    """z along the generator of a cone at azimuth 0, downwards."""
    values = dict(shape.parameters)
    half_angle = values["half_angle"] if shape.kind == "cone" else float(np.arctan(values["taper"]))
    turn = (pi - half_angle) / 2  # half of the angle about y
    return Pose((values.get("radius", 0.0), 0.0, 0.0), (float(np.cos(turn)), 0.0, float(np.sin(turn)), 0.0))


def _seen_from(pose: Pose, conditions: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """Linear conditions in the axes of a pose."""
    R, origin = rotation_of(pose.quaternion), np.array(pose.position)
    turned = []
    for each in conditions:
        normal = np.array(each.numbers[1:4])
        numbers = (each.numbers[0] + float(normal @ origin), *map(float, normal @ R), *(0.0,) * 6)
        turned.append(Condition(each.kind, numbers, None))
    return tuple(turned)


def _curve_of(feature: Feature) -> Curve | None:
    """The meridian in the plane y = 0, x >= 0."""
    shape = feature.shape
    values = dict(shape.parameters)
    if shape.chart is not None:
        return _profile_of(feature, shape.chart)
    if (
        shape.kind == "paraboloid"
        and values["rho_x"] == values["rho_y"]
        and (values["rho_x"] > 0) != shape.cavity
    ):
        height = over(times(T, T), times(Number(2.0), Name("rho_x")))
        return Curve((expression_of(T), expression_of(ZERO), expression_of(height)), (0.0, inf))
    if shape.kind == "ellipsoid" and values["a"] == values["b"] and shape.cavity:
        x, z = times(Name("a"), cos(T)), times(Name("c"), sin(T))
        return Curve((expression_of(x), expression_of(ZERO), expression_of(z)), (-pi / 2, pi / 2))
    return None


def is_of_revolution(shape: Shape) -> bool:
    """Whether a surface is one about its third axis. A cylinder counts for none: another surface about that
    axis touches it at no radius but its own."""
    values = dict(shape.parameters)
    if shape.chart is not None:
        return meridian_of_chart(shape.chart) is not None
    if shape.kind in ("paraboloid", "ellipsoid"):
        return len(set(list(values.values())[:2])) == 1
    return shape.kind in (*CONICAL, "torus")


def _profile_of(feature: Feature, chart: Chart) -> Curve | None:
    """That of a chart that is closed or faces its axis."""
    found = meridian_of_chart(chart)
    if found is None:
        return None
    curve, turned = found
    closed = chart.periodic[1] or not is_open(feature)
    rises = np.diff(_heights(Shape("curve", feature.shape.parameters, curve=curve)))
    outward = -1.0 if turned != feature.shape.cavity else 1.0  # where z rises: c_u x c_v is off the axis
    return curve if closed or (outward * rises <= 0).all() else None


def _heights(curve: Shape) -> np.ndarray[Any, Any]:
    """z at samples of a curve, m."""
    ((low, high),) = domain_of(curve)
    return points_of(curve, np.linspace(low, high, SAMPLES))[:, 2]


def _along(curve: Curve, conditions: tuple[Condition, ...]) -> tuple[Condition, ...]:
    """Ends of the curve, and those of the face that a turn about the axis leaves as they are."""
    low, high = curve.domain
    ends = [] if curve.periodic else [at_least(0, low, None)]
    if ends and isfinite(high):
        ends.append(at_most(0, high, None))
    kept = [replace(each, next=None) for each in conditions if each.kind == "quadric"]
    return (*ends, *kept)
