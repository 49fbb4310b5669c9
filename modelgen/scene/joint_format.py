"""The joints of the scene format: their kinds, keys, ranges and defaults."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.scene.pose_input import ORIENTATIONS, POSE_FIELDS
from modelgen.scene.scalar_types import LIMIT, NUMBER, POSITIVE, ExpressionText, Real, Text, Whole
from modelgen.scene.table_types import Field, Sequence, Table, Tagged

NAME = Text(
    r"^[A-Za-z][A-Za-z0-9_]{0,63}$",
    "a name is allowed: a letter, then up to 63 letters, digits or _",
)
NOT_NEGATIVE = Real(minimum=0.0)
ORIENTATION = (ORIENTATIONS,)

_BETWEEN = Field(
    "between",
    Sequence(NAME, 2, '["one", "other"]'),
    'names of two bodies; "world" is a body at rest',
    required=True,
)
_JOINT_FRAMES = (
    Field("name", NAME, "name of the joint, unique in the scene; its bodies' names and kind if absent"),
    _BETWEEN,
    *POSE_FIELDS,
    Field(
        "frames",
        Sequence(Table(POSE_FIELDS, ORIENTATION), 2),
        "the frame in each body, in its axes; else position and orientation give it in the world at t = 0",
    ),
)
_LIMITS = (
    Field(
        "limits",
        Sequence(LIMIT, 2),
        'least and largest coordinate, rad or m; "none" where there is no bound',
        default=(None, None),
    ),
    Field("restitution", Real(0.0, 1.0), "coefficient of restitution at the limits", default=0.0),
)
_LIMITS_Y = Field(
    "limits_y",
    Sequence(LIMIT, 2),
    'least and largest y, m; "none" where there is no bound',
    default=(None, None),
)
_SPRUNG = (
    Field("stiffness", NOT_NEGATIVE, "of a spring along the coordinate, N/m or N m/rad", default=0.0),
    Field("damping", NOT_NEGATIVE, "along the coordinate, N s/m or N m s/rad", default=0.0),
    Field("rest", NUMBER, "coordinate at which the spring has no force, m or rad", default=0.0),
)
SPIN = "spin"  # the relative angular velocity
ARMATURE: Mapping[str, tuple[str, ...]] = {
    "revolute": ("angle",),
    "prismatic": ("displacement",),
    "cylindrical": ("displacement", "angle"),
    "spherical": (SPIN,),
    "universal": ("angle_x", "angle_y"),
    "planar": ("x", "y", "angle"),
    "screw": ("displacement",),
}  # the rates of each kind that may have an armature, in the order of the key


def _armature(kind: str) -> tuple[Field, ...]:
    names = ARMATURE.get(kind, ())
    units = {SPIN: "kg m^2, of the relative angular velocity w: adds armature w^2/2 to the kinetic energy"}
    doc = "inertia of the rotor of a drive: adds armature rate^2/2 to the kinetic energy, "
    doc = units.get(names[0], doc) if names else ""
    if len(names) == 1:
        doc += "" if names[0] == SPIN else "kg m^2" if names[0] == "angle" else "kg"
        return (Field("armature", NOT_NEGATIVE, doc, default=0.0),)
    if names:
        each = Sequence(NOT_NEGATIVE, len(names), "[" + ", ".join(["0.0"] * len(names)) + "]")
        doc += f"for the rates of {', '.join(names)}, kg, of angles kg m^2"
        return (Field("armature", each, doc, default=(0.0,) * len(names)),)
    return ()


_MOTION = Field(
    "motion", ExpressionText("expression of t and linear inputs"),
    "the coordinate as an expression of t and linear inputs, rad or m",
)  # fmt: skip
_LEAD = Field("lead", Real(), "displacement a turn, m; negative: left-handed", required=True)
_DISTANCE = Field("distance", POSITIVE, "between the origins of the frames, m, unless its motion is given")
_TEETH = Field("teeth", Sequence(Whole(-10000, 10000), 2), "n_a turn_a + n_b turn_b = 0", required=True)

_JOINT_KEYS: Mapping[str, tuple[Field, ...]] = {
    "revolute": (*_LIMITS, *_SPRUNG, _MOTION),
    "prismatic": (*_LIMITS, *_SPRUNG, _MOTION),
    "cylindrical": (*_LIMITS, *_SPRUNG),
    "spherical": _LIMITS,
    "universal": (*_LIMITS, *_SPRUNG),
    "planar": (*_LIMITS, _LIMITS_Y),
    "weld": (),
    "screw": (_LEAD, *_LIMITS, *_SPRUNG, _MOTION),
    "distance": (_DISTANCE, _MOTION),
    "rope": _LIMITS,
    "gear": (_TEETH,),
}
SPRUNG_KINDS = tuple(kind for kind, keys in _JOINT_KEYS.items() if set(_SPRUNG) <= set(keys))
_FRAME_OR_FRAMES = tuple((key, "frames") for key in ("position", *ORIENTATIONS))

JOINT = Tagged(
    "kind",
    "what the two frames of the joint may do",
    {
        kind: Table((*_JOINT_FRAMES, *keys, *_armature(kind)), (*ORIENTATION, *_FRAME_OR_FRAMES))
        for kind, keys in _JOINT_KEYS.items()
    },
)
