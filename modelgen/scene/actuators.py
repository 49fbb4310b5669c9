"""Actuators: a force along, or a torque about, the first coordinate of a joint, from an expression."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.scene.joint_format import NAME, SPRUNG_KINDS
from modelgen.scene.prescribed_motions import TIME
from modelgen.scene.scalar_types import LIMIT, NUMBER, ExpressionText
from modelgen.scene.scene_types import Actuator, Joint
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Several, Table
from modelgen.scene.table_types import Sequence as ListOf

COORDINATE, RATE = "coordinate", "rate"  # names that the expression may use
_DOC = (
    "expression of t, inputs, coordinate (rad within half a turn, or m) and rate (rad/s or m/s) of the joint"
)

ACTUATOR = Table(
    (
        Field("joint", NAME, "name of the joint", required=True),
        Field("force", ExpressionText(_DOC), "along the coordinate of the joint, N or N m", required=True),
        Field("gain", NUMBER, "factor of the expression", default=1.0),
        Field(
            "limits", ListOf(LIMIT, 2),
            'least and largest force after the gain, N or N m; "none" for no bound', default=(None, None),
        ),
    )
)  # fmt: skip
ACTUATORS = Several(ACTUATOR)


def actuators_of(
    read: Sequence[tuple[Place, Mapping[str, Any]]], joints: Sequence[Joint]
) -> tuple[Actuator, ...]:
    """The actuators of the values of their tables; raises SceneError."""
    known = {joint.name: joint for joint in joints}
    return tuple(_actuator(values, known, place) for place, values in read)


def _actuator(values: Mapping[str, Any], joints: Mapping[str, Joint], place: Place) -> Actuator:
    name, at = values["joint"], place.key("joint")
    if name not in joints:
        raise at.error(f"no joint named {name!r}", "joints: " + ", ".join(joints), nearest(name, joints))
    joint = joints[name]
    if joint.kind not in SPRUNG_KINDS:
        allowed = "an actuator acts on a joint that is " + ", ".join(SPRUNG_KINDS)
        remedy = "use a [[torque]] or [[force]] on its bodies"
        raise at.error(f"the {joint.kind} joint {name!r}", allowed, remedy)
    if joint.motion is not None:
        raise at.error(f"the joint {name!r}, whose motion is given", "", "remove the motion, or the actuator")
    low, high = values["limits"]
    if low is not None and high is not None and not low < high:
        found = f"{low:g} to {high:g}"
        raise place.key("limits").error(found, "the first is the smaller one", "exchange them")
    names = (TIME, COORDINATE, RATE, *(each.name for each in place.inputs))
    force = place.key("force").expression(values["force"], names)
    return Actuator(name, force, values["gain"], (low, high))


def check_names(place: Place) -> None:
    """Raises SceneError where an input has a name that the expressions of actuators use."""
    for index, each in enumerate(place.inputs):
        if each.name in (COORDINATE, RATE):
            found = f"the name {each.name!r}, which is that of a quantity of a joint"
            raise place.key("input").item(index).key("name").error(found, "", "choose another")
