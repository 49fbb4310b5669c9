"""Values of a scene in SI units, frozen. No symbols, no arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import inf
from typing import Any, Literal

from modelgen.scene.expression import Expression
from modelgen.scene.free_form_values import Spline
from modelgen.scene.outline_piece_kinds import Outline

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
Motion = Literal["fixed", "driven", "dynamic"]

NO_POLES = ((False, False), (False, False))
IDENTITY_QUATERNION = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and orientation of one frame in another."""

    position: Vector = (0.0, 0.0, 0.0)  # m
    quaternion: tuple[float, float, float, float] = IDENTITY_QUATERNION  # (w, x, y, z), unit

    @property
    def is_identity(self) -> bool:
        return self.position == (0.0, 0.0, 0.0) and self.quaternion == IDENTITY_QUATERNION


@dataclass(frozen=True, slots=True)
class Chart:
    """A surface of the user's own: x, y, z as expressions of u, v and the named parameters."""

    components: tuple[Expression, Expression, Expression]
    domain: tuple[tuple[float, float], tuple[float, float]]  # ((u_min, u_max), (v_min, v_max))
    periodic: tuple[bool, bool] = (False, False)
    poles: tuple[tuple[bool, bool], tuple[bool, bool]] = NO_POLES  # which ends of u, of v are one point each


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve of the user's own: x, y, z as expressions of t and the named parameters."""

    components: tuple[Expression, Expression, Expression]
    domain: tuple[float, float]  # (t_min, t_max)
    periodic: bool = False


@dataclass(frozen=True, slots=True)
class Profile:
    """A closed smooth outline: x, y as expressions of t and the named parameters."""

    components: tuple[Expression, Expression]
    domain: tuple[float, float]  # (t_min, t_max), one turn
    reach: float = inf  # of t beyond its domain, as far as the expressions go on around the outline


@dataclass(frozen=True, slots=True)
class Shape:
    """A surface bounding material, or a curve. `cavity` puts the material on a surface's other side."""

    kind: str  # a name of the catalogue, "chart", "curve" or "solid"
    parameters: tuple[tuple[str, float], ...] = ()  # in the order of the catalogue (user's own: as written)
    cavity: bool = False
    pose: Pose = Pose()  # of the shape in the body axes as written
    chart: Chart | None = None
    curve: Curve | None = None
    name: str = "shape"  # unique within the body
    profile: Profile | None = None  # of an extrusion with a smooth outline
    solid: Composite | None = None  # a solid of the user's own
    spline: Spline | None = None  # of a B-spline, a height field or a polyline
    outline: Outline | None = None  # of pieces
    repeated: bool = False  # one of several copies, which differ in numbers alone
    placed: bool = False  # its place about the centre of mass follows from a parameter
    stands_for: str = ""  # in words, where it is another than the surface that it stands for


@dataclass(frozen=True, slots=True)
class Condition:
    """A number that is >= 0 while a contact point, or its normal, belongs to a feature.

    quadric (c, bx, by, bz, Qxx, Qyy, Qzz, Qxy, Qxz, Qyz): c + b.x + Qxx x^2 + ... + Qyz y z at the point x
    in the feature's shape frame, m. parameter (index, sign, bound): sign (eta_index - bound), eta the chart
    coordinates of the feature. wing (a, b): -N.w with w = a T x z + b z, T the unit tangent of the edge and z
    the third axis of its shape frame; w points into the face `next`. direction (x, y, z): -N.e with e the
    unit vector from the vertex along the edge `next`. tip (x, y, z, s): N.a - s with a the axis of the
    round tip at the vertex. tilt (x, y, z, s, side): s times how far the angle between N and the unit
    vector is above `flat_angle`, with side = 1 if that vector points out of a flat side, 0 if N may point
    against it. N points out of the solid. disc (radius,): (radius^2 - u^2 - v^2)/radius with the chart
    coordinates u, v of the feature. coaxial (x, y, z, ax, ay, az, sign): sign times how much nearer than
    a bound the origin of the other feature is to the axis through (x, y, z) along (ax, ay, az), given in
    the frame of the composite.
    """

    kind: Literal["quadric", "parameter", "wing", "direction", "disc", "tilt", "coaxial", "tip"]
    numbers: tuple[float, ...]
    next: str | None  # the feature beyond; None: nothing is there


@dataclass(frozen=True, slots=True)
class Feature:
    """A face, edge or vertex of a composite shape."""

    name: str  # unique in the shape
    dimension: int  # 2 face, 1 edge or curve, 0 vertex
    shape: Shape  # smooth; its pose is relative to the frame of the composite
    conditions: tuple[Condition, ...] = ()


@dataclass(frozen=True, slots=True)
class Composite:
    """Features with their adjacency."""

    features: tuple[Feature, ...]
    convex: bool  # the material it bounds is convex


@dataclass(frozen=True, slots=True)
class Path:
    """The prescribed motion of a driven body as expressions of t."""

    position: tuple[Expression, Expression, Expression]  # m, world
    rotation_vector: tuple[Expression, Expression, Expression]  # rad, world, applied before `pose`


@dataclass(frozen=True, slots=True)
class Body:
    name: str
    motion: Motion
    shapes: tuple[Shape, ...] = ()
    mass: float | None = None  # kg; dynamic bodies only
    density: float | None = None  # kg/m^3; mass, centre and inertia then follow from the shapes
    inertia: Matrix | None = None  # kg m^2 about the centre of mass, body axes; dynamic bodies only
    center_of_mass: Vector = (0.0, 0.0, 0.0)  # m, body axes
    pose: Pose = Pose()  # of the body axes in the world, at t = 0
    velocity: Vector = (0.0, 0.0, 0.0)  # m/s, of the centre of mass, world
    angular_velocity: Vector = (0.0, 0.0, 0.0)  # rad/s, world
    normal: Vector | None = None  # unit, world: of the plane that a planar body, which is dynamic, moves in
    repeated: bool = False  # one of several copies, which differ in numbers alone
    placed: bool = False  # its pose follows from a parameter
    path: Path | None = None  # driven bodies only: p = path + pose.position, R = exp(rotation_vector) R_pose


@dataclass(frozen=True, slots=True)
class Friction:
    """Coulomb friction: coefficients along `direction` and across it, alike unless there is one."""

    static: tuple[float, float]
    kinetic: tuple[float, float]
    direction: Vector | None = None  # axes of the first body of the pair


ImpactLaw = Literal["newton", "poisson", "stronge"]


@dataclass(frozen=True, slots=True)
class Restitution:
    """Restitution of an impact: ratio of speeds (Newton), of impulses (Poisson), or root of that of works
    (Stronge)."""

    value: float = 0.0  # 0..1
    law: ImpactLaw = "newton"


@dataclass(frozen=True, slots=True)
class ContactPair:
    between: tuple[tuple[str, str], tuple[str, str]]  # ((body, shape), (body, shape))
    restitution: Restitution = Restitution()
    form: str = "auto"  # "auto" or the name of a form
    normal: Vector | None = None  # two curves: roughly N at t = 0, world, from the first to the second
    features: tuple[str, ...] = ()  # of the two shapes, that may touch; empty: all
    points: int | None = None  # how many points of the pair may touch at a time; None: from the shapes
    friction: Friction | None = None
    rolling_resistance: float = 0.0  # m: the torque against rolling is at most this times the normal force
    spinning_resistance: float = 0.0  # m: the same about the normal
    candidate: bool = False  # of a group: followed only while its shapes are near to each other


Partner = tuple[str, str]  # body, shape


@dataclass(frozen=True, slots=True)
class PairPool:
    """All pairs of the shapes of two classes of equal bodies, or of one, of which few are near at a time."""

    pattern: int  # number of the one among the contact pairs of the scene
    classes: tuple[int, int]  # of its first and second shape

    def size(self, classes: Sequence[Sequence[Partner]]) -> int:
        """How many pairs there are."""
        first, second = (len(classes[k]) for k in self.classes)
        return first * (first - 1) // 2 if self.classes[0] == self.classes[1] else first * second


@dataclass(frozen=True, slots=True)
class Input:
    """A number that expressions use by name and that the caller of a run sets while it runs."""

    name: str
    default: float = 0.0  # until it is set
    minimum: float | None = None
    maximum: float | None = None
    hold: Literal["zero", "linear"] = "zero"  # between settings: the value stays, or changes at a given rate
    unit: str = ""

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest value, infinite where there is no bound."""
        return -inf if self.minimum is None else self.minimum, inf if self.maximum is None else self.maximum


@dataclass(frozen=True, slots=True)
class Measurand:
    """A quantity of a body, of a pair that may touch, or of a joint."""

    owner: Literal["body", "pair", "joint"]
    name: str  # of the owner
    quantity: str
    pairs: tuple[str, ...] = ()  # of shapes, by name, of which it is the least gap or the sum of forces
    point: Vector | None = None  # of a body, axes and origin as written, m; None: its centre of mass
    relative_to: str | None = None  # body in whose axes it is measured; None: the world


@dataclass(frozen=True, slots=True)
class Sensor:
    """A result of a run under a name: a quantity, or an expression of t, inputs and other sensors."""

    name: str
    measurand: Measurand | None = None
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class ForceLoad:
    """A force at a material point, in world or body axes; expressions of t and the body's state."""

    body: str
    components: tuple[Expression, Expression, Expression]  # N
    point: Vector = (0.0, 0.0, 0.0)  # m, body axes, from the body origin
    frame: Literal["world", "body"] = "world"


@dataclass(frozen=True, slots=True)
class TorqueLoad:
    body: str
    components: tuple[Expression, Expression, Expression]  # N m
    frame: Literal["world", "body"] = "world"


@dataclass(frozen=True, slots=True)
class SpringLoad:
    """A linear spring and damper between two material points."""

    between: tuple[str, str]  # body names
    anchors: tuple[Vector, Vector]  # m, body axes of each, from the body origins
    stiffness: float  # N/m
    damping: float = 0.0  # N s/m
    rest_length: float = 0.0  # m


@dataclass(frozen=True, slots=True)
class Joint:
    """Two frames, one in each of two bodies, that move against each other as the kind allows."""

    name: str
    kind: str
    between: tuple[str, str]  # body names
    frames: tuple[Pose, Pose]  # in the axes of each body as written
    numbers: tuple[float, ...] = ()  # lead m a turn; distance m; teeth, and both frames' rotations at t = 0
    limits: tuple[float | None, float | None] = (None, None)  # of the first coordinate, rad or m
    limits_y: tuple[float | None, float | None] = (
        None,
        None,
    )  # of the second coordinate of a planar joint, m
    restitution: float = 0.0  # at the limits
    stiffness: float = 0.0  # N/m or N m/rad, along the first coordinate
    damping: float = 0.0  # N s/m or N m s/rad
    rest: float = 0.0  # m or rad
    motion: Expression | None = None  # of t: the first coordinate, rad or m
    armature: tuple[float, ...] = ()  # kg or kg m^2, of each rate in `ARMATURE`, or none

    @property
    def is_sprung(self) -> bool:
        return self.stiffness > 0 or self.damping > 0


@dataclass(frozen=True, slots=True)
class Actuator:
    """A force along the first coordinate of a joint: gain times an expression, within limits."""

    joint: str
    force: Expression  # of t, coordinate, rate and inputs; N or N m
    gain: float = 1.0
    limits: tuple[float | None, float | None] = (None, None)  # N or N m


Load = ForceLoad | TorqueLoad | SpringLoad


@dataclass(frozen=True, slots=True)
class RunSettings:
    """Settings of a run; None leaves a choice to the accuracy, or to the generator and the build."""

    until: float = 1.0  # s
    accuracy: str = "balanced"  # coarse | fast | balanced | tight
    tolerance: float | None = None  # overrides the accuracy's relative tolerance
    imaginary_edge: float = 0.0  # rad; lean up to which a face turns on a tangent of its rim
    flush_height: float = 1e-8  # characteristic lengths; closer surfaces of one solid are one
    samples: int = 200  # output intervals between 0 and until
    method: str | None = None  # dop853 | rk4 | time-stepping
    step: float | None = None  # s, of rk4 and time-stepping
    scheme: str | None = None  # of time-stepping: stewart-trinkle | anitescu-potra | moreau
    solver: str | None = None  # of complementarity problems: coulomb | qp | ..
    fallback: bool | None = None  # False: an event-driven run ends where it cannot go on
    impacts: str | None = None  # of several contacts: simultaneous | sequential
    newton: int | None = None  # 0 | 1 | 2
    project: int | None = None  # every so many steps; 0 never
    use_gamma: bool | None = None
    estimate: bool | None = None  # by a companion run, of the error
    form: str | None = None  # of the contacts that name none, where it is regular
    real: str | None = None  # double | float | long double
    level: str | None = None  # of the compiler: O1 | O2 | O3

    def said(self) -> dict[str, Any]:
        """The settings as a table; of what may be left open, only what the scene says."""
        table = {each.name: getattr(self, each.name) for each in fields(self)}
        return {key: value for key, value in table.items() if key == "tolerance" or value is not None}


@dataclass(frozen=True, slots=True)
class Parameter:
    """A named number of a scene that runs may change."""

    name: str
    value: float
    nominal: float  # at which the characteristic length, mass and time are taken
    minimum: float | None = None
    maximum: float | None = None
    unit: str = ""
    doc: str = ""
    uses: tuple[str, ...] = ()  # places of the scene whose numbers follow from it


@dataclass(frozen=True, slots=True)
class Origin:
    """The plain tables that a scene was read from, and the form that was forced on its contacts."""

    tables: Mapping[str, Any]
    form: str | None = None


@dataclass(frozen=True, slots=True)
class Scene:
    name: str
    source: str  # file name, for messages; "<python>" when built in Python
    bodies: tuple[Body, ...]
    contacts: tuple[ContactPair, ...]  # of the pairs of a pool, one
    loads: tuple[Load, ...] = ()
    joints: tuple[Joint, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    inputs: tuple[Input, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    gravity: Vector = (0.0, 0.0, -9.81)  # m/s^2
    observe: tuple[str, ...] = ()  # names such as "ball.position"; empty: everything
    fold: bool = False  # numbers become constants of the generated code
    run: RunSettings = field(default_factory=RunSettings)
    remarks: tuple[str, ...] = ()  # on what is allowed but seldom meant, in words
    parameters: tuple[Parameter, ...] = ()
    nominal: Scene | None = None  # at the nominal values of the parameters; None: they are those of the scene
    classes: tuple[tuple[Partner, ...], ...] = ()  # of equal shapes of equal bodies
    pools: tuple[PairPool, ...] = ()
    near_per_body: int = 8  # pairs of pools that are near at a time
    origin: Origin | None = field(default=None, compare=False, repr=False)  # of what was read
