"""The scene format: every table, key, type, range and default, once. Reader and JSON Schema read it."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.scene.actuators import ACTUATORS
from modelgen.scene.constants import NAMED
from modelgen.scene.custom_solid import own_fields
from modelgen.scene.free_shapes import FREE_SHAPES
from modelgen.scene.friction import FRICTION_FIELDS
from modelgen.scene.inertia import Inertia
from modelgen.scene.inputs import INPUTS
from modelgen.scene.joint_format import JOINT, NAME, NOT_NEGATIVE, ORIENTATION
from modelgen.scene.parameters import PARAMETERS
from modelgen.scene.patterns import PATTERN
from modelgen.scene.pose_input import ORIENTATIONS, POSE_FIELDS, VECTOR
from modelgen.scene.restitution import RestitutionValue
from modelgen.scene.run_choices import FORMS
from modelgen.scene.run_settings import RUN
from modelgen.scene.scalar_types import NUMBER, POSITIVE, Choice, ExpressionText, Switch, Text, Whole, words
from modelgen.scene.scene_types import Restitution
from modelgen.scene.sensor_format import SENSORS
from modelgen.scene.shape_catalogue import CHART_FIELDS, CURVE_FIELDS, SHAPES
from modelgen.scene.solids_with_edges import SOLIDS
from modelgen.scene.table_types import Defined, Field, Sequence, Several, Table, Tagged

FRAMES = ("world", "body")
QUANTITIES = ("position", "orientation", "velocity", "angular_velocity")

LOAD_NAMES = ("t", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "qw", "qx", "qy", "qz")

ZERO = (0.0, 0.0, 0.0)
STILL = ("0.0", "0.0", "0.0")

SCENE_NAME = Text(r"^[A-Za-z0-9_-]{1,64}$", "letters, digits, _ and - are allowed, at most 64")
_TWO = '["one", "other"]'
_PARTNER = Text(
    r"^[A-Za-z][A-Za-z0-9_]{0,63}\*?(/[A-Za-z][A-Za-z0-9_]{0,63}\*?)?$",
    "the name of a body, or body/shape, is allowed, or the beginning of names and *",
)


def _formulas(doc: str) -> Sequence:
    return Sequence(ExpressionText(doc), 3)


_CAVITY = Field("cavity", Switch(), "the material is on the other side of the surface", default=False)
_SHAPE_FIELDS = (
    Field("name", NAME, "name of the shape within its body; its kind if absent"),
    *POSE_FIELDS,
    Field(
        "stands_for",
        words(200, least=1),
        "the other surface that the shape stands for, in words, as a mesh that is not convex; contacts are "
        "with the shape, and a run in which there may be some is not trusted",
        default="",
    ),
)


def _shape_table(
    fields: tuple[Field, ...], cavity: bool, exclusive: tuple[tuple[str, ...], ...] = ()
) -> Table:
    return Table((*fields, *((_CAVITY,) if cavity else ()), *_SHAPE_FIELDS), (*exclusive, ORIENTATIONS))


def _tagged(tables: Mapping[str, Table]) -> Tagged:
    return Tagged("kind", "the shape's name in the catalogue, or chart, curve, solid: your own", tables)


_SURFACES = {
    kind: _shape_table(spec.fields, cavity=True)
    for kind, spec in SHAPES.items()
    if not spec.curve and not spec.point
} | {"chart": _shape_table(CHART_FIELDS, cavity=True)}
_CURVES = {kind: _shape_table(spec.fields, cavity=False) for kind, spec in SHAPES.items() if spec.curve} | {
    "curve": _shape_table(CURVE_FIELDS, cavity=False)
}
_POINTS = {kind: _shape_table(spec.fields, cavity=False) for kind, spec in SHAPES.items() if spec.point}
_FREE = {
    kind: _shape_table(free.fields, not free.curve, free.exclusive) for kind, free in FREE_SHAPES.items()
}
_SOLIDS = {kind: _shape_table(solid.fields, solid.cavity, solid.exclusive) for kind, solid in SOLIDS.items()}

FACE_SHAPE = Defined("face_shape", _tagged(_SURFACES))
EDGE_SHAPE = Defined("edge_shape", _tagged(_CURVES))
_ENDED = {
    kind: _shape_table((*spec.fields, *spec.optional), cavity=True)
    for kind, spec in SHAPES.items()
    if spec.optional
}
_OWN = {"solid": _shape_table(own_fields(FACE_SHAPE, EDGE_SHAPE), cavity=False)}

_SHAPES = _SURFACES | _ENDED | _CURVES | _POINTS | _FREE | _SOLIDS | _OWN
SHAPE_KINDS = tuple(_SHAPES)
SHAPE = Defined("shape", _tagged(_SHAPES))

_PATH = Table(
    (
        Field(
            "position", _formulas("expression of t and linear inputs, m"),
            "world, added to the body's position, m", default=STILL,
        ),
        Field(
            "rotation_vector", _formulas("expression of t and linear inputs, rad"),
            "world, applied after the body's orientation, rad", default=STILL,
        ),
    )
)  # fmt: skip

_BODY_FIELDS = (
    Field("name", NAME, "name of the body, unique in the scene", required=True),
    Field("shape", Several(SHAPE, single=True), "one shape or a list of shapes", default=()),
    *POSE_FIELDS,
)

_DYNAMIC_FIELDS = (
    Field("mass", POSITIVE, "mass, kg; needs inertia as well"),
    Field("inertia", Inertia(), "[Ixx, Iyy, Izz] or 3x3 about the centre of mass, body axes, kg m^2"),
    Field("density", POSITIVE, "kg/m^3; mass, centre of mass and inertia then follow from the shapes"),
    Field("center_of_mass", VECTOR, "centre of mass in the body axes, m; [0, 0, 0] if absent"),
    Field("velocity", VECTOR, "velocity of the centre of mass at t = 0, world, m/s", default=ZERO),
    Field("angular_velocity", VECTOR, "angular velocity at t = 0, world, rad/s", default=ZERO),
)

_NORMAL = Field(
    "normal", VECTOR, "of the plane in which the body moves, world axes, of any length",
    default=(0.0, 0.0, 1.0),
)  # fmt: skip

_MASS_OR_DENSITY = (("mass", "density"), ("inertia", "density"), ("center_of_mass", "density"))

BODY = Defined(
    "body",
    Tagged(
        "motion",
        "fixed: at rest; driven: moves on a path; dynamic: moves by forces; planar: the same, in a plane",
        {
            "fixed": Table(_BODY_FIELDS, ORIENTATION),
            "driven": Table(
                (*_BODY_FIELDS, Field("path", _PATH, "the motion as expressions of t", required=True)),
                ORIENTATION,
            ),
            "dynamic": Table((*_BODY_FIELDS, *_DYNAMIC_FIELDS), (*ORIENTATION, *_MASS_OR_DENSITY)),
            "planar": Table((*_BODY_FIELDS, *_DYNAMIC_FIELDS, _NORMAL), (*ORIENTATION, *_MASS_OR_DENSITY)),
        },
        default="dynamic",
    ),
)

_FEATURE = Text(
    r"^[A-Za-z][A-Za-z0-9_.]{0,63}\*?$", "the name of a feature, or the beginning of names and *, is allowed"
)

CONTACT = Table(
    (
        Field(
            "between", Sequence(_PARTNER, 2, _TWO),
            'two partners, each "body" or "body/shape"; ball_* is all that begin so', required=True,
        ),
        Field(
            "restitution",
            RestitutionValue(),
            "Newton's coefficient of restitution, or a table of a law and its coefficient",
            default=Restitution(),
        ),
        Field("form", Choice(FORMS), "form of the contact's equations; auto: the cheapest", default="auto"),
        Field(
            "normal", VECTOR,
            "two curves: on which side the second lies at t = 0, roughly, from the first, world axes",
        ),
        Field(
            "features", Sequence(_FEATURE, None),
            "faces, edges and vertices that may touch, those of both shapes; flank* is all that begin so; "
            "without it all", default=(),
        ),
        Field(
            "points", Whole(1, 64),
            "how many points of this pair may touch at a time; without it as the shapes suggest",
        ),
        *FRICTION_FIELDS,
    )
)  # fmt: skip

CONTACTS = Table(
    (
        Field(
            "between", Choice(("all",)),
            "every two bodies of which one is dynamic, with all their shapes; pairs listed as a contact keep "
            "what is written there", required=True,
        ),
        Field(
            "among", Sequence(_PARTNER, None),
            'the bodies of the group, "body" or "body/shape"; ball_* is all that begin so; without it all',
            default=(),
        ),
        Field("joined", Switch(), "whether bodies joined by a joint belong to it", default=False),
        Field(
            "restitution",
            RestitutionValue(),
            "Newton's coefficient of restitution, or a table of a law and its coefficient",
            default=Restitution(),
        ),
        *FRICTION_FIELDS,
        Field(
            "near_per_body",
            Whole(0, 10_000),
            "in a group of many equal bodies: for how many pairs near each other, per body, there is room; "
            "`simulate` makes more where a run needs more; 0: all pairs are listed",
            default=8,
        ),
    ),
    instead_of_list="write [[contact]] for each pair; [contacts], once, is a group of bodies",
)  # fmt: skip

_FRAME = Field("frame", Choice(FRAMES), "axes of the components", default="world")
_LOADED = Field("body", NAME, "name of a dynamic body", required=True)
_LOAD_DOC = (
    f"expression of {' '.join(LOAD_NAMES)}: of the centre of mass, in world axes whatever `frame` says; "
    "and of inputs"
)

FORCE = Table(
    (
        _LOADED,
        Field("force", _formulas(_LOAD_DOC), "components, N", required=True),
        Field("point", VECTOR, "point of application, body axes from the body's origin, m", default=ZERO),
        _FRAME,
    )
)

TORQUE = Table((_LOADED, Field("torque", _formulas(_LOAD_DOC), "components, N m", required=True), _FRAME))

SPRING = Table(
    (
        Field("between", Sequence(NAME, 2, _TWO), "names of two bodies", required=True),
        Field(
            "anchors", Sequence(VECTOR, 2), "a point of each, body axes from its origin, m",
            default=(ZERO, ZERO),
        ),
        Field("stiffness", NOT_NEGATIVE, "N/m", required=True),
        Field("damping", NOT_NEGATIVE, "N s/m", default=0.0),
        Field("rest_length", NOT_NEGATIVE, "m", default=0.0),
    )
)  # fmt: skip

SCENE = Table(
    (
        Field("body", Several(BODY, label="body"), "the bodies", required=True),
        Field("contact", Several(CONTACT), "pairs of shapes that may touch", default=()),
        Field("contacts", CONTACTS, "a group of bodies of which every two may touch", default=None),
        Field("joint", Several(JOINT, label="joint"), "joints between bodies", default=()),
        Field("force", Several(FORCE), "forces as expressions of t and the body's state", default=()),
        Field("torque", Several(TORQUE), "torques as expressions of t and the body's state", default=()),
        Field("spring", Several(SPRING), "springs with dampers between two points", default=()),
        Field("actuator", ACTUATORS, "forces along the coordinates of joints", default=()),
        Field("pattern", Several(PATTERN), "bodies and shapes repeated about an axis", default=()),
        Field("constants", NAMED, "named numbers that expressions may use", default=()),
        Field("parameter", PARAMETERS, "named numbers that runs may change", default=()),
        Field("input", INPUTS, "numbers that expressions may use and that are set during a run", default=()),
        Field("sensor", SENSORS, "what is measured during a run, by name", default=()),
        Field(
            "gravity",
            Sequence(NUMBER, 3, "[0.0, 0.0, -9.81]"),
            "gravitational acceleration, m/s^2",
            default=(0.0, 0.0, -9.81),
        ),
        Field(
            "observe",
            Sequence(Text(r"^[A-Za-z][^.\s]*\.[a-z_]+$", "name.quantity is allowed"), None),
            "what must be computed: quantities of bodies, contacts and joints, such as ball.position, "
            "ball-bowl.force, elbow.coordinates; empty: everything",
            default=(),
        ),
        Field("fold", Switch(), "numbers become constants of the generated code", default=False),
        Field("run", RUN, "settings of a run", default=None),
    )
)

DEFINED = (FACE_SHAPE, EDGE_SHAPE, SHAPE, BODY)
