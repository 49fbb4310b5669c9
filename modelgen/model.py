"""The Model: the kinds that a scene needs, and the instance that says which bodies use them.

The set of kinds decides what is generated and compiled; the instance is run-time data. Two scenes with the
same set of kinds share one library.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from modelgen.scene.expression import Expression
from modelgen.scene.scene_types import (
    Chart,
    Curve,
    ForceLoad,
    Path,
    Pose,
    Restitution,
    Scene,
    Shape,
    TorqueLoad,
    Vector,
)

BodyMotion = Literal["fixed", "driven", "point", "free"]
InertiaKind = Literal["none", "isotropic", "diagonal", "full"]
Posing = Literal["identity", "general"]
Rows = Literal[1, 3, 6]  # of a contact: N; and t1, t2; and spin about N, rolling about t1, t2
Search = Literal["never", "moved", "always", "ahead", "apart"]  # for more contacts of a pair in a run


@dataclass(frozen=True, slots=True)
class ShapeKind:
    """The structure of a surface or curve; its lengths are parameters."""

    name: str  # C identifier, unique within a Model; equals `kind` for shapes of the catalogue
    kind: str  # name in the catalogue, "chart" or "curve"
    parameter_names: tuple[str, ...]
    cavity: bool = False
    chart: Chart | None = None
    curve: Curve | None = None
    folded: tuple[float, ...] | None = None  # values when numbers are folded: no parameters then


@dataclass(frozen=True, slots=True)
class InputKind:
    """An input of the scene as the kernels take it."""

    name: str  # in expressions
    hold: Literal["zero", "linear"]


@dataclass(frozen=True, slots=True)
class BodyKind:
    name: str  # C identifier
    motion: BodyMotion
    inertia: InertiaKind = "none"
    path: Path | None = None
    inputs: tuple[InputKind, ...] = ()  # of the scene, if the path depends on one
    loaded: bool = False  # a load acts on it; otherwise its wrench has size 0
    folded: tuple[float, ...] | None = None  # mass and inertia when numbers are folded


@dataclass(frozen=True, slots=True)
class Side:
    """One partner of a contact as the generated code sees it."""

    shape: ShapeKind
    motion: BodyMotion
    pose: Posing = "general"  # identity: a fixed body that sits at the world frame
    placement: Posing = "identity"  # of the shape in the body's centre-of-mass axes


@dataclass(frozen=True, slots=True)
class ContactKind:
    """A distinct pair of sides and the form of its equations. `o` and `f` as in the paper."""

    name: str  # C identifier
    form: str
    o: Side
    f: Side
    rows: Rows = 1


@dataclass(frozen=True, slots=True)
class LoadKind:
    name: str  # C identifier
    kind: Literal["force", "torque", "spring", "joint_spring", "actuator"]
    motions: tuple[BodyMotion, ...]  # one body, or two for a spring
    expressions: tuple[str, ...] = ()  # texts, for the identity of the kind
    load: ForceLoad | TorqueLoad | None = None  # whose expressions it compiles; without its body and point
    arms: tuple[bool, ...] = ()  # per body: its point is off the centre of mass and is a parameter
    joint: str = ""  # the kind of joint whose coordinate a joint_spring or an actuator acts on
    law: Expression | None = None  # of an actuator
    limited: bool = False  # an actuator whose force has limits, which are parameters
    inputs: tuple[InputKind, ...] = ()  # of the scene, if the load depends on one

    @property
    def is_spring(self) -> bool:
        """Whether it is a spring with a damper: along a line, or along the coordinate of a joint."""
        return self.kind in ("spring", "joint_spring")


@dataclass(frozen=True, slots=True)
class JointKind:
    """The structure of a joint; its frames and lengths are parameters."""

    name: str  # C identifier
    kind: str  # name in `joint.kinds.FORMS`
    motion: Expression | None = None  # of t and inputs: what its first coordinate is held at
    inputs: tuple[InputKind, ...] = ()  # of the scene, if the motion depends on one
    armature: tuple[str, ...] = ()  # rates that have one: of coordinates, or the relative spin


@dataclass(frozen=True, slots=True)
class LimitKind:
    """One bound of a coordinate of a kind of joint."""

    name: str  # C identifier
    kind: str  # of joint
    upper: bool
    coordinate: int = 0


@dataclass(frozen=True, slots=True)
class BodyEntry:
    """A body of the instance: offsets into q, u and the parameter vector."""

    name: str
    kind: int
    q: int
    u: int
    parameters: tuple[float, ...]  # free: mass + inertia as its kind lists; fixed: pose (12)
    mass_inverse: tuple[float, ...]  # 1/m, inverse inertia (9, column-major, body axes); zeros if not dynamic
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0)  # centre of mass in the body axes as written


ENDS, WATCHED = -1, -2  # beyond a condition: the contact ends; it stays, but others may begin


@dataclass(frozen=True, slots=True)
class FeatureCondition:
    """An inequality that holds while a contact stays on a feature pair (`scene.scene_types.Condition`)."""

    kind: str
    side: int  # 0: of o, 1: of f
    numbers: tuple[float, ...]
    next: int  # the feature pair beyond, by its number within the pair; ENDS or WATCHED
    line: bool = False  # beyond, the features touch along a line if they are parallel; it ends here


@dataclass(frozen=True, slots=True)
class FeaturePairEntry:
    """Two features, one of each shape of a pair, that can touch in a point."""

    name: str  # "rim_top", "v0-top"; empty where both shapes are one feature each
    kind: int  # of contact
    pair: int
    o: int  # body index
    f: int
    parameters: tuple[float, ...]  # shape o, [placement o (12)], shape f, [placement f (12)]
    swapped: bool  # the user named f first
    shapes: tuple[Shape, Shape]  # of o and f; poses in the body axes as written
    features: tuple[str, str]  # of the first and the second shape as the user named them
    face_group: int = -1  # of feature pairs of one flat face with the other of two convex solids
    conditions: tuple[FeatureCondition, ...] = ()

    def between(self, pair: int, bodies: tuple[int, int]) -> FeaturePairEntry:
        """The same of another pair and other bodies, as the user named them."""
        o, f = bodies[::-1] if self.swapped else bodies
        return replace(self, pair=pair, o=o, f=f)

    @property
    def bodies(self) -> tuple[int, int]:
        """As the user named them."""
        return (self.f, self.o) if self.swapped else (self.o, self.f)

    @property
    def is_coaxial_support(self) -> bool:
        """Whether it replaces another one while two features of revolution are coaxial."""
        return any(each.kind == "coaxial" and each.numbers[-1] > 0 for each in self.conditions)


@dataclass(frozen=True, slots=True)
class HandoverEntry:
    """A condition beyond which a contact goes over to a feature pair of another pair of shapes."""

    feature_pair: int
    condition: int  # its number within the feature pair
    next: int  # the feature pair beyond


@dataclass(frozen=True, slots=True)
class FrictionConstraint:
    """One or two rows of a contact below its normal one, whose force is bounded by the normal force."""

    kind: Literal["slip", "spin", "roll"]
    row: int  # its first among the contact's rows below the normal one
    rows: int
    static: tuple[float, float]  # slip: coefficients along the direction and across it; others: m, twice
    kinetic: tuple[float, float]
    body: int = -1  # whose axes the direction is in; -1: alike in all directions
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PairEntry:
    """Two shapes that the scene lets touch: a range of feature pairs and a range of contacts."""

    name: str  # "egg-table"
    bodies: tuple[int, int]  # as the user named them
    feature_pairs: tuple[int, int]  # first, end
    contacts: tuple[int, int]
    search: Search
    restitution: Restitution
    normal: tuple[float, float, float] | None = None  # roughly N at t = 0, from o to f; two curves only
    friction: tuple[FrictionConstraint, ...] = ()  # of each of its contacts
    bounding_balls: tuple[
        tuple[Vector, float], ...
    ] = ()  # around its shapes, m, axes of the bodies o, f of its first feature pair
    candidate: bool = False  # followed only while its shapes are near to each other
    shapes: tuple[str, ...] = ()  # their names in their bodies, in the order of the balls
    repeats: int | None = None  # an earlier pair whose feature pairs these are, but for the bodies


@dataclass(frozen=True, slots=True)
class ContactEntry:
    """A contact: it follows one local minimum of the distance of a pair, on one feature pair at a time."""

    name: str  # "egg-table", "box-table:v0", "ball-groove#2"
    pair: int
    eta: int  # offset
    room: int  # entries of eta
    feature_pair: int  # its own for good, or -1: any of the pair


@dataclass(frozen=True, slots=True)
class BoundaryEntry:
    """A piece of the boundary of a face, traversed from the first of its ends to the second."""

    kind: int  # of shape
    curve: Shape  # in its own axes
    pose: Pose  # of the curve in the axes of the face
    ends: tuple[float, float]
    loop: int


@dataclass(frozen=True, slots=True)
class FaceEntry:
    """A planar region of a body; without boundary a whole plane."""

    name: str  # "bottom"; empty for a shape of one feature
    body: int
    pose: Pose  # in the body axes as written, z outward
    boundary: tuple[BoundaryEntry, ...]


@dataclass(frozen=True, slots=True)
class ShareEntry:
    """The part of a patch of several pairs that belongs to one of them: where its own two faces overlap."""

    pair: int
    boundary_o: tuple[int, int]  # range of the entries of o's boundary in that of the union; empty: a plane
    boundary_f: tuple[int, int]  # the same of f


@dataclass(frozen=True, slots=True)
class PatchEntry:
    """Two faces that may rest on each other, held by three points of f's on o's plane."""

    name: str  # "glass-table:bottom"
    pair: int  # the first, where it is of several
    kind: int  # of contact, of its points
    faces: tuple[int, int]  # of o and f
    parameters: tuple[tuple[float, ...], ...]  # of each point's contact
    feature_pairs: tuple[int, ...]  # that lie in it
    patch_slots: tuple[int, int] = (0, 0)  # places, first and end, for those of the pair that rest
    friction_kind: int = -1  # kind of the first point's contact where there is friction: with slip and spin
    friction: tuple[float, float] = (0.0, 0.0)  # static and kinetic coefficient
    shares: tuple[ShareEntry, ...] = ()  # of the pairs, where it is of several


@dataclass(frozen=True, slots=True)
class LoadEntry:
    kind: int
    bodies: tuple[int, ...]
    parameters: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class JointEntry:
    """A joint of the instance between bodies a and b."""

    name: str
    kind: int
    a: int
    b: int
    row: int  # its first among the rows of all joints
    rows: int  # that it holds
    inertial_rows: int  # of its armature, after the others
    frames: tuple[Pose, Pose]  # in the axes of a and b as written
    geometry: tuple[float, ...]  # frames, length, the kind's numbers
    armature: tuple[float, ...] = ()  # kg or kg m^2, those above zero

    @property
    def parameters(self) -> tuple[float, ...]:
        """Of its rows."""
        return (*self.geometry, *self.armature)


@dataclass(frozen=True, slots=True)
class LimitEntry:
    """A bound of a joint: a contact without shapes."""

    name: str  # "elbow:min"
    kind: int
    joint: int
    a: int
    b: int
    eta: int  # offset
    room: int  # entries of eta: 1 for an angle
    restitution: float
    parameters: tuple[float, ...]  # of the joint, then the bound


@dataclass(frozen=True, slots=True)
class Scales:
    """Characteristic length (m), mass (kg) and time (s); every tolerance is dimensionless against them."""

    length: float
    mass: float
    time: float


@dataclass(frozen=True, slots=True)
class Model:
    scene: Scene  # what its `observe` depends on
    whole: Scene  # as written
    shape_kinds: tuple[ShapeKind, ...]
    body_kinds: tuple[BodyKind, ...]
    contact_kinds: tuple[ContactKind, ...]
    load_kinds: tuple[LoadKind, ...]
    joint_kinds: tuple[JointKind, ...]
    limit_kinds: tuple[LimitKind, ...]
    bodies: tuple[BodyEntry, ...]
    pairs: tuple[PairEntry, ...]
    feature_pairs: Sequence[FeaturePairEntry]
    contacts: tuple[ContactEntry, ...]
    faces: tuple[FaceEntry, ...]
    patches: tuple[PatchEntry, ...]
    loads: tuple[LoadEntry, ...]
    joints: tuple[JointEntry, ...]
    limits: tuple[LimitEntry, ...]
    n_q: int
    n_u: int
    n_eta: int
    scales: Scales
    initial_q: tuple[float, ...]
    initial_u: tuple[float, ...]
    left_out: tuple[str, ...] = ()  # what pruning removed, in words
    joined: tuple[str, ...] = ()  # features of shapes that are fixed together and nothing touches, in words
    handovers: tuple[HandoverEntry, ...] = ()  # where shapes that are fixed together join smoothly
    warnings: tuple[str, ...] = ()  # what is remarkable about the shapes, in words
