"""Positions and orientations as the user may write them, read to a unit quaternion (w, x, y, z)."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, hypot, sin
from typing import Any

from modelgen.rotations import ROUNDING
from modelgen.scene.plausibility_remarks import remark_on_orientation
from modelgen.scene.scalar_types import NUMBER
from modelgen.scene.scene_types import IDENTITY_QUATERNION, Matrix, Pose, Vector
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Sequence, Table

Quaternion = tuple[float, float, float, float]

VECTOR = Sequence(NUMBER, 3, "[x, y, z]")
ORIENTATIONS = ("quaternion", "axis_angle", "rpy", "rotation")
SHORTEST = 1e-9  # length of a quaternion or an axis that still has a direction

_AXIS_ANGLE = Table(
    (
        Field("axis", VECTOR, "direction of the axis, of any length", required=True),
        Field("angle", NUMBER, "angle about the axis, rad", required=True),
    )
)

POSE_FIELDS = (
    Field("position", VECTOR, "position [x, y, z] of the frame, m", default=(0.0, 0.0, 0.0)),
    Field(
        "quaternion",
        Sequence(NUMBER, 4, "[w, x, y, z]"),
        "orientation [w, x, y, z]; its length is divided out",
    ),
    Field("axis_angle", _AXIS_ANGLE, "orientation as a turn about one axis"),
    Field("rpy", VECTOR, "orientation [roll, pitch, yaw], rad: R = Rz(yaw) Ry(pitch) Rx(roll)"),
    Field("rotation", Sequence(VECTOR, 3), "orientation as a rotation matrix, a list of rows"),
)
POSE_KEYS = tuple(each.key for each in POSE_FIELDS)


def read_pose(values: Mapping[str, Any], place: Place) -> Pose:
    """The pose from the values of `POSE_FIELDS`."""
    return Pose(values["position"], _orientation(values, place))


def _orientation(values: Mapping[str, Any], place: Place) -> Quaternion:
    remark_on_orientation(values, place)
    if values["quaternion"] is not None:
        return _unit(values["quaternion"], place.key("quaternion"))
    if values["axis_angle"] is not None:
        return _from_axis_angle(values["axis_angle"], place.key("axis_angle"))
    if values["rpy"] is not None:
        return _from_rpy(values["rpy"])
    if values["rotation"] is not None:
        return _from_matrix(values["rotation"], place.key("rotation"))
    return IDENTITY_QUATERNION


def _unit(quaternion: Quaternion, place: Place) -> Quaternion:
    length = hypot(*quaternion)
    if length < SHORTEST:
        remedy = "write [1, 0, 0, 0] for no rotation"
        raise place.error("a quaternion of length zero", "any other [w, x, y, z] is allowed", remedy)
    w, x, y, z = quaternion
    return w / length, x / length, y / length, z / length


def _from_axis_angle(values: Mapping[str, Any], place: Place) -> Quaternion:
    axis, angle = values["axis"], values["angle"]
    length = hypot(*axis)
    if length < SHORTEST:
        remedy = "write a direction such as [0, 0, 1]"
        raise place.key("axis").error("an axis of length zero", "any other [x, y, z] is allowed", remedy)
    s = sin(angle / 2) / length
    return cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]


def _from_rpy(rpy: Vector) -> Quaternion:
    roll, pitch, yaw = ((cos(angle / 2), sin(angle / 2)) for angle in rpy)
    (cr, sr), (cp, sp), (cy, sy) = roll, pitch, yaw
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _from_matrix(r: Matrix, place: Place) -> Quaternion:
    _check_rotation(r, place)
    squares = (
        1 + r[0][0] + r[1][1] + r[2][2],
        1 + r[0][0] - r[1][1] - r[2][2],
        1 - r[0][0] + r[1][1] - r[2][2],
        1 - r[0][0] - r[1][1] + r[2][2],
    )  # four times w^2, x^2, y^2, z^2
    a, b, c = r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]
    d, e, f = r[1][0] + r[0][1], r[0][2] + r[2][0], r[2][1] + r[1][2]
    largest = max(range(4), key=squares.__getitem__)
    rows = ((squares[0], a, b, c), (a, squares[1], d, e), (b, d, squares[2], f), (c, e, f, squares[3]))
    return _unit(rows[largest], place)


def _check_rotation(r: Matrix, place: Place) -> None:
    remedy = "write rows of a rotation matrix, or use quaternion, axis_angle or rpy"
    for i, row in enumerate(r):
        for j, other in enumerate(r[i:], start=i):
            product = sum(a * b for a, b in zip(row, other, strict=True))
            if abs(product - (i == j)) > ROUNDING:
                raise place.error(
                    f"rows {i} and {j} with the scalar product {product:.9g}",
                    f"orthogonal rows of length 1 (to {ROUNDING:g}) are allowed", remedy,
                )  # fmt: skip
    (a, b, c), (d, e, f), (g, h, i_) = r
    if a * (e * i_ - f * h) - b * (d * i_ - f * g) + c * (d * h - e * g) < 0:
        raise place.error("a reflection (determinant -1)", "the determinant must be +1", remedy)
