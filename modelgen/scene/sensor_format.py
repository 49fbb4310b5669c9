"""The table of a sensor in the scene format."""

from __future__ import annotations

from modelgen.scene.constants import NAMED
from modelgen.scene.joint_format import NAME
from modelgen.scene.scalar_types import NUMBER, ExpressionText, Text
from modelgen.scene.table_types import Field, Sequence, Several, Table

SENSOR = Table(
    (
        Field("name", Text(NAMED.pattern, NAMED.allowed), "name in results and expressions", required=True),
        Field(
            "of", Text(r"^[A-Za-z][^.\s]*\.[a-z_]+$", "name.quantity is allowed"),
            "what is measured: body.position, .orientation, .velocity, .angular_velocity, .acceleration, "
            ".angular_acceleration or .proper_acceleration (less gravity, in the body's axes), "
            "body-body.gap (the least, m) or .force (all normal forces, N), in either order, "
            "joint.coordinate (the first), .rate, .force or .torque",
        ),
        Field(
            "point", Sequence(NUMBER, 3),
            "measured is this point, body axes from the body's origin, m; without it the centre of mass",
        ),
        Field(
            "relative_to", NAME,
            "a body in whose axes, and past whose motion, a quantity of a body is measured; else the world",
        ),
        Field(
            "value", ExpressionText("expression"),
            "in place of `of`: expression of t, inputs and components of sensors: tip_x, turn_w, load",
        ),
    ),
    (("of", "value"),),
)  # fmt: skip
SENSORS = Several(SENSOR, label="sensor")
