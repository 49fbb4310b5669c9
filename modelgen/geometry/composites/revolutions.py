"""Solids of revolution with edges: cylinder, tube, disc, capsule, frustum, cone, dome, half torus.

A rim is a circle whose T x z points away from its axis, so that (-1, 0) is the wing into the disc it bounds.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, sin, sqrt

from modelgen.geometry.composites.feature_constructors import (
    TILT,
    above,
    below,
    beyond_circle,
    edge,
    face,
    smooth,
    vertex,
    wing,
    within_circle,
)
from modelgen.rotations import Quaternion
from modelgen.scene.pose_arithmetic import UPSIDE_DOWN
from modelgen.scene.scene_types import IDENTITY_QUATERNION, Composite, Condition, Feature, Pose, Shape

FACING_Y: Quaternion = (0.5**0.5, 0.5**0.5, 0.0, 0.0)  # x stays, y turns to z, z turns to -y


def cylinder(shape: Shape) -> Composite:
    """Side and two ends about z, centred; parameters radius, length."""
    (_, radius), (_, length) = shape.parameters
    half = length / 2
    side = face(
        "side", smooth("cylinder", Pose(), radius=radius), below(half, "rim_top"), above(-half, "rim_bottom")
    )
    ends = (*_end("top", radius, half, (0.0, -1.0)), *_end("bottom", radius, -half, (0.0, 1.0)))
    return Composite((side, *ends), convex=True)


def tube(shape: Shape) -> Composite:
    """A cylinder about z, centred, with a bore along its axis; parameters radius, bore, length."""
    (_, radius), (_, bore), (_, length) = shape.parameters
    half = length / 2
    outer = smooth("cylinder", Pose(), radius=radius)
    inner = replace(smooth("cylinder", Pose(), radius=bore), cavity=True)
    return Composite(
        (
            face("side", outer, below(half, "rim_top"), above(-half, "rim_bottom")),
            face("bore", inner, below(half, "bore_top"), above(-half, "bore_bottom")),
            *_ring("top", radius, bore, half),
            *_ring("bottom", radius, bore, -half),
        ),
        convex=False,
    )


def _ring(name: str, radius: float, bore: float, z: float) -> tuple[Feature, ...]:
    """The end of a tube at height z, its rim and the edge of its bore."""
    down = (0.0, -1.0) if z > 0 else (0.0, 1.0)
    end, rim = _end(name, radius, z, down)
    circle = smooth("circle", Pose((0.0, 0.0, z)), radius=bore)
    lip = edge(f"bore_{name}", circle, wing(1.0, 0.0, name), wing(*down, "bore"))
    return replace(end, conditions=(*end.conditions, beyond_circle(bore, lip.name))), rim, lip


def frustum(shape: Shape) -> Composite:
    """A truncated cone about z, centred; parameters radius_bottom, radius_top, length."""
    (_, bottom), (_, top), (_, length) = shape.parameters
    half, slope = length / 2, hypot(bottom - top, length)
    down = ((bottom - top) / slope, -length / slope)
    ends = (
        *_end("top", top, half, down),
        *_end("bottom", bottom, -half, (-down[0], -down[1])),
    )
    return Composite((_frustum_side(bottom, top, length), *ends), convex=True)


def _frustum_side(bottom: float, top: float, length: float) -> Feature:
    """In the frame of the shape: that of the apex is far away where the ends are almost as wide."""
    if bottom == top:
        side = smooth("cylinder", Pose(), radius=bottom)
    else:
        radius, taper = (bottom + top) / 2, (bottom - top) / length
        side = smooth("conical_side", Pose(), radius=radius, taper=taper)
    return face("side", side, below(length / 2, "rim_top"), above(-length / 2, "rim_bottom"))


def cone(shape: Shape) -> Composite:
    """An infinite cone about z below its apex; parameter half_angle."""
    (_, half_angle) = shape.parameters[0]
    side = face("side", smooth("cone", Pose(), half_angle=half_angle), below(0.0, "apex"))
    tip = Condition("tip", (0.0, 0.0, 1.0, sin(half_angle)), "side")
    return Composite((side, vertex("apex", (0.0, 0.0, 0.0), tip)), convex=True)


def _end(name: str, radius: float, z: float, side: tuple[float, float]) -> tuple[Feature, Feature]:
    """The end at height z and its rim, whose wing into the side is given by its two numbers."""
    rim = f"rim_{name}"
    pose = Pose((0.0, 0.0, z), IDENTITY_QUATERNION if z > 0 else UPSIDE_DOWN)
    circle = smooth("circle", Pose((0.0, 0.0, z)), radius=radius)
    return (
        face(name, smooth("plane", pose), within_circle(radius, rim)),
        edge(rim, circle, wing(-1.0, 0.0, name), wing(*side, "side")),
    )


def disc(shape: Shape) -> Composite:
    """A flat disc in z = 0 without thickness; parameter radius.

    The wings of the rim rise above the plane and sink below it by TILT. Both point inward: of the two the
    one on the side of the normal is the first to be violated.
    """
    (_, radius) = shape.parameters[0]
    inside = within_circle(radius, "rim")
    return Composite(
        (
            face("top", smooth("plane", Pose()), inside),
            face("bottom", smooth("plane", Pose(quaternion=UPSIDE_DOWN)), inside),
            edge(
                "rim",
                smooth("circle", Pose(), radius=radius),
                wing(-1.0, TILT, "top"),
                wing(-1.0, -TILT, "bottom"),
            ),
        ),
        convex=True,
    )  # fmt: skip


def capsule(shape: Shape) -> Composite:
    """A cylinder about z, centred, with half spheres at its ends; parameters radius, length (straight)."""
    (_, radius), (_, length) = shape.parameters
    half = length / 2
    return Composite(
        (
            face(
                "side", smooth("cylinder", Pose(), radius=radius),
                below(half, "cap_top"), above(-half, "cap_bottom"),
            ),
            face("cap_top", smooth("sphere", Pose((0.0, 0.0, half)), radius=radius), above(0.0, "side")),
            face("cap_bottom", smooth("sphere", Pose((0.0, 0.0, -half)), radius=radius), below(0.0, "side")),
        ),
        convex=True,
    )  # fmt: skip


def dome(shape: Shape) -> Composite:
    """The part of a ball above z = 0, where its base is; parameters radius (of the ball), length."""
    (_, radius), (_, length) = shape.parameters
    rim, depth = sqrt(length * (2 * radius - length)), radius - length  # of the centre below the base
    pose, rim_name = Pose((0.0, 0.0, -depth)), "rim"
    return Composite(
        (
            face("dome", smooth("sphere", pose, radius=radius), above(depth, rim_name)),
            face("base", smooth("plane", Pose(quaternion=UPSIDE_DOWN)), within_circle(rim, rim_name)),
            edge(
                rim_name, smooth("circle", Pose(), radius=rim),
                wing(-1.0, 0.0, "base"), wing(-depth / radius, rim / radius, "dome"),
            ),
        ),
        convex=True,
    )  # fmt: skip


def half_torus(shape: Shape) -> Composite:
    """The half y >= 0 of a torus about z; parameters major, minor."""
    (_, major), (_, minor) = shape.parameters
    ring = face(
        "ring", smooth("torus", Pose(), major=major, minor=minor),
        _before_end(major, minor, 1.0, "rim_a"), _before_end(major, minor, -1.0, "rim_b"),
    )  # fmt: skip
    ends = (*_cut("a", major, minor), *_cut("b", -major, minor))
    return Composite((ring, *ends), convex=False)


def _before_end(major: float, minor: float, sign: float, rim: str) -> Condition:
    """y + ((x - sign major)^2 + z^2 - minor^2)/(2 major): y near one end of the torus, > 0 near the other.

    The bracket vanishes to second order at its own end and exceeds what -y can reach near the other end.
    """
    c, bend = (major * major - minor * minor) / (2 * major), 0.5 / major
    return Condition("quadric", (c, -sign, 1.0, 0.0, bend, 0.0, bend, 0.0, 0.0, 0.0), rim)


def _cut(name: str, x: float, minor: float) -> tuple[Feature, Feature]:
    """The end disc at x with exterior -y, and its rim."""
    pose, end, rim = Pose((x, 0.0, 0.0), FACING_Y), f"end_{name}", f"rim_{name}"
    return (
        face(end, smooth("plane", pose), within_circle(minor, rim)),
        edge(rim, smooth("circle", pose, radius=minor), wing(-1.0, 0.0, end), wing(0.0, -1.0, "ring")),
    )
