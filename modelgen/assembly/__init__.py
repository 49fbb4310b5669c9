"""Assembly: from the scene to the model whose kernels are generated and whose arrays the core reads.

Takes in a `Scene`; gives out a `Model`: the kinds of bodies, contacts, joints and loads that the scene needs
(they decide what is generated and compiled), and its instance, the numbers of each body, contact, joint and
load. States on which no observed quantity depends are left out. May import `geometry`, `contact`, `dynamics`,
`joint` and what lies before them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from modelgen.assembly.body_motions import motion_of, pairs_by_body
from modelgen.assembly.characteristic_scales import flush_height, scales_of
from modelgen.assembly.contact_kinds import Owner, contact_names, find_body, find_shape
from modelgen.assembly.contact_reuse import have_same_contacts, with_coefficients
from modelgen.assembly.contact_warnings import soundness
from modelgen.assembly.faces_across_shapes import Shown, Unions
from modelgen.assembly.feature_pairs import Whole
from modelgen.assembly.friction_constraints import friction_constraints_of
from modelgen.assembly.handovers import handovers_of
from modelgen.assembly.inputs_of_expressions import inputs_of_expressions
from modelgen.assembly.joined_solids import JoinedSolids
from modelgen.assembly.joints import Joined, joined
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.loads import bodies_of, load_kind, load_parameters
from modelgen.assembly.masses import (
    Mass,
    inertia_kind,
    inertia_numbers,
    inverse_numbers,
    mass_of,
    pose_numbers,
)
from modelgen.assembly.observed_influence import influencing
from modelgen.assembly.observed_quantities import check_observed, needed_quantities
from modelgen.assembly.patches import Faces, patches_of
from modelgen.assembly.shared_pair_content import PairContent, PairContents
from modelgen.assembly.welded_bodies import stands_of
from modelgen.errors import SceneError, expect
from modelgen.model import (
    BodyEntry,
    BodyKind,
    BodyMotion,
    ContactEntry,
    ContactKind,
    FaceEntry,
    FeaturePairEntry,
    HandoverEntry,
    LoadEntry,
    LoadKind,
    Model,
    PairEntry,
    PatchEntry,
    Scales,
    ShapeKind,
)
from modelgen.repeated_entries import RepeatedEntries
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, ContactPair, Feature, Scene, Vector

Q_SIZE = {"fixed": 0, "driven": 0, "point": 3, "free": 7}
U_SIZE = {"fixed": 0, "driven": 0, "point": 3, "free": 6}


@dataclass(frozen=True, slots=True)
class Piece:
    """A body with what the scene requires of it."""

    body: Body
    motion: BodyMotion
    mass: Mass | None  # dynamic bodies only
    loaded: bool

    @property
    def centre(self) -> Vector:
        return self.mass.centre if self.mass else (0.0, 0.0, 0.0)

    @property
    def moves(self) -> bool:
        return self.motion in ("point", "free")


@dataclass(frozen=True, slots=True)
class Touching:
    """Pairs of shapes, feature pairs, contacts and patches of the contact pairs of a scene."""

    pairs: tuple[PairEntry, ...]
    feature_pairs: Sequence[FeaturePairEntry]
    contacts: tuple[ContactEntry, ...]
    faces: tuple[FaceEntry, ...]
    patches: tuple[PatchEntry, ...]
    shape_kinds: tuple[ShapeKind, ...]
    contact_kinds: tuple[ContactKind, ...]
    warnings: tuple[str, ...]  # on the shapes
    joined: tuple[str, ...]  # features that nothing touches, in words
    handovers: tuple[HandoverEntry, ...]  # from one pair to another

    @property
    def n_eta(self) -> int:
        """Number of entries of eta of all contacts."""
        return sum(entry.room for entry in self.contacts)


def require(scene: Scene, scales: Scales | None = None, known: Model | None = None) -> Model:
    """The Model of a scene: distinct kinds, offsets, parameters, scales and initial state.

    `scales` are those at the nominal values of the scene's parameters, where they are known; `known` is a
    model of the scene with other values, whose contacts are taken over where they follow from none.

    Raises SceneError where the scene names what does not exist, forces a form that does not suit its pair,
    or leaves the mass or inertia of a moving body open; ModelgenError if it is given something else.
    """
    expect("require", scene, Scene)
    names = contact_names(scene)
    check_observed(scene, names)
    part, dropped = influencing(replace(scene, observe=needed_quantities(scene)), names)
    if scales is None and scene.nominal is not None:
        scales = _scales_at(replace(scene.nominal, observe=needed_quantities(scene)))
    pieces = _pieces(part)
    scales = scales or _scales(part, pieces)
    flush = flush_height(part, scales)
    touching = None if known is None else _taken_over(part, pieces, known, flush)
    return _model(part, pieces, touching or _touching(part, pieces, flush), scene, dropped, scales)


def _model(
    scene: Scene,
    pieces: Sequence[Piece],
    touching: Touching,
    whole: Scene,
    dropped: Sequence[str],
    scales: Scales,
) -> Model:
    """The model of the observed part of a scene; `whole` is the scene as written."""
    body_kinds = KindList[BodyKind]()
    load_kinds, loads, joints = _acting(scene, pieces, scales.length, touching.n_eta)
    return Model(
        scene=scene,
        whole=whole,
        bodies=_body_entries(scene, pieces, body_kinds),
        shape_kinds=touching.shape_kinds,
        body_kinds=body_kinds.kinds,
        contact_kinds=touching.contact_kinds,
        load_kinds=load_kinds,
        joint_kinds=joints.joint_kinds,
        limit_kinds=joints.limit_kinds,
        pairs=touching.pairs,
        feature_pairs=touching.feature_pairs,
        contacts=touching.contacts,
        faces=touching.faces,
        patches=touching.patches,
        loads=loads,
        joints=joints.joints,
        limits=joints.limits,
        n_q=sum(Q_SIZE[piece.motion] for piece in pieces),
        n_u=sum(U_SIZE[piece.motion] for piece in pieces),
        n_eta=touching.n_eta + sum(entry.room for entry in joints.limits),
        scales=scales,
        initial_q=tuple(value for piece in pieces for value in _initial_q(piece)),
        initial_u=tuple(value for piece in pieces for value in _initial_u(piece)),
        joined=touching.joined,
        handovers=touching.handovers,
        left_out=(*_left_out(pieces), *_unobserved(dropped)),
        warnings=(*scene.remarks, *touching.warnings),
    )


def _scales_at(scene: Scene) -> Scales:
    """The scales of a scene of which nothing else is needed."""
    part, _ = influencing(scene, contact_names(scene))
    return _scales(part, _pieces(part))


def _scales(scene: Scene, pieces: Sequence[Piece]) -> Scales:
    return scales_of(scene, [(piece.body, piece.mass) for piece in pieces if piece.mass])


def _pieces(scene: Scene) -> tuple[Piece, ...]:
    pairs = pairs_by_body(scene)
    return tuple(_piece(scene, index, pairs[body.name]) for index, body in enumerate(scene.bodies))


def _piece(scene: Scene, index: int, pairs: Sequence[ContactPair]) -> Piece:
    body = scene.bodies[index]
    where = f"{scene.source}: body[{index}] (body {body.name!r})"
    mass = mass_of(body, where) if body.motion == "dynamic" else None
    motion = motion_of(scene, body, mass, pairs)
    if motion == "free" and mass is not None and mass.inertia is None:
        raise SceneError(where, "no inertia", "a body that can turn needs one", "add inertia, or a density")
    driving = {actuator.joint for actuator in scene.actuators}
    sprung = any(
        body.name in joint.between for joint in scene.joints if joint.is_sprung or joint.name in driving
    )
    loaded = sprung or any(body.name in bodies_of(load) for load in scene.loads)
    return Piece(body, motion, mass, loaded)


def _body_entries(scene: Scene, pieces: Sequence[Piece], kinds: KindList[BodyKind]) -> tuple[BodyEntry, ...]:
    starts_q = accumulate((Q_SIZE[piece.motion] for piece in pieces), initial=0)
    starts_u = accumulate((U_SIZE[piece.motion] for piece in pieces), initial=0)
    return tuple(
        _body_entry(p, q, u, scene, kinds) for p, q, u in zip(pieces, starts_q, starts_u, strict=False)
    )


def _body_entry(piece: Piece, q: int, u: int, scene: Scene, kinds: KindList[BodyKind]) -> BodyEntry:
    name, mass, turns = piece.body.name, piece.mass, piece.motion == "free"
    if mass is None or not piece.moves:
        path = piece.body.path
        used = inputs_of_expressions(scene.inputs, (*path.position, *path.rotation_vector) if path else ())
        kind = kinds.index(BodyKind(piece.motion, piece.motion, path=path, inputs=used))
        return BodyEntry(name, kind, q, u, pose_numbers(piece.body.pose), (0.0,) * 10)
    turning = mass.inertia if turns else None
    inertia = "none" if turning is None else inertia_kind(turning)
    numbers = (mass.mass, *(() if turning is None else inertia_numbers(turning)))
    base = "_".join([piece.motion, *([inertia] if turns else []), *(["loaded"] if piece.loaded else [])])
    kind = kinds.index(
        BodyKind(base, piece.motion, inertia, loaded=piece.loaded, folded=numbers if scene.fold else None)
    )
    inverse = inverse_numbers(mass, turns)
    return BodyEntry(name, kind, q, u, () if scene.fold else numbers, inverse, mass.centre)


def _taken_over(scene: Scene, pieces: Sequence[Piece], known: Model, flush: float) -> Touching | None:
    """The contacts of another model of the scene, where they are the same in this one."""
    motions, centres = [piece.motion for piece in pieces], [piece.centre for piece in pieces]
    if not have_same_contacts(scene, motions, centres, flush, known):
        return None
    pairs, patches = with_coefficients(scene, known)
    return Touching(
        pairs, known.feature_pairs, known.contacts, known.faces, patches,
        known.shape_kinds, known.contact_kinds, known.warnings[len(known.scene.remarks) :], known.joined,
        known.handovers,
    )  # fmt: skip


def _touching(scene: Scene, pieces: Sequence[Piece], flush: float) -> Touching:
    """The pairs that may touch, their feature pairs, and the contacts that follow them; `flush` in m."""
    warnings = soundness(scene)
    contents, wholes = PairContents(scene.run.form or "auto"), Wholes(scene, pieces)
    stands = stands_of(scene, [piece.motion for piece in pieces])
    joined = JoinedSolids(scene, stands, flush)
    faces, shown = Faces(contents.shapes), []
    entries: list[PairEntry] = []
    sources: list[Sequence[FeaturePairEntry]] = []
    bodies: list[tuple[int, int] | None] = []
    first = 0
    all_contacts: list[ContactEntry] = []
    for index, (name, pair) in enumerate(zip(contact_names(scene), scene.contacts, strict=True)):
        where = f"{scene.source}: contact{'s' if pair.candidate else f'[{index}]'}"
        a, b = (
            wholes.of(partner, f"{where}.between", joined.features_left(partner, other))
            for partner, other in (pair.between, pair.between[::-1])
        )
        content = contents.of(a, b, pair, where, index)
        eta = all_contacts[-1].eta + all_contacts[-1].room if all_contacts else 0
        contacts = _contacts(name, index, content, first, eta)
        is_swapped = content.feature_pairs[0].swapped
        normal = _turned_round(pair.normal) if is_swapped else pair.normal
        ranges = (
            (first, first + len(content.feature_pairs)),
            (len(all_contacts), len(all_contacts) + len(contacts)),
        )
        constraints = friction_constraints_of(pair, a.owner.body)
        wholes_of_pair = (b, a) if is_swapped else (a, b)
        entries.append(
            PairEntry(
                name,
                (a.owner.body, b.owner.body),
                *ranges,
                content.search,
                pair.restitution,
                normal,
                constraints,
                tuple(each.ball for each in wholes_of_pair),
                pair.candidate,
                tuple(each.shape.name for each in wholes_of_pair),
                None if content.first == index else content.first,
            )
        )
        patches = patches_of(content.planar_pairs, (a, b), pair, name, index, first, faces)
        shown.append(Shown((a, b), pair, patches))
        sources.append(content.feature_pairs)
        bodies.append(None if content.first == index else entries[-1].bodies)
        first += len(content.feature_pairs)
        all_contacts += contacts
    unions = Unions(faces.entries, stands, [piece.centre for piece in pieces], flush)
    joined_patches = unions.patches(shown)
    feature_pairs = RepeatedEntries(sources, bodies, FeaturePairEntry.between)
    return Touching(
        tuple(entries), feature_pairs, tuple(all_contacts), tuple(unions.faces), joined_patches,
        contents.shapes.kinds, contents.kinds.kinds, warnings, tuple(joined.told()),
        handovers_of(scene.contacts, entries, feature_pairs, joined),
    )  # fmt: skip


def _contacts(name: str, pair: int, content: PairContent, first: int, eta: int) -> tuple[ContactEntry, ...]:
    """The contacts of a pair; `first`, `eta`: the number of its first feature pair, and the offset of eta."""
    found = []
    for k, room in enumerate(content.rooms):
        own = first + k if content.way.own else -1
        label = f":{content.feature_pairs[k].name}" if content.way.own else f"#{k + 1}"
        found.append(ContactEntry(name + (label if len(content.rooms) > 1 else ""), pair, eta, room, own))
        eta += room
    return tuple(found)


def _turned_round(normal: Vector | None) -> Vector | None:
    return None if normal is None else (-normal[0], -normal[1], -normal[2])


class Wholes:
    """The shapes that take part in contacts, each made once."""

    def __init__(self, scene: Scene, pieces: Sequence[Piece]) -> None:
        self.scene, self.pieces = scene, pieces
        self._known: dict[tuple[tuple[str, str], tuple[Feature, ...] | None], Whole] = {}

    def of(self, partner: tuple[str, str], where: str, left: tuple[Feature, ...] | None) -> Whole:
        """The shape of a body by the names of both, with its features that are left; raises SceneError."""
        if (partner, left) not in self._known:
            body = find_body(self.scene, partner[0], where)
            piece = self.pieces[body]
            shape = find_shape(piece.body, partner[1], where)
            at_world = piece.body.pose.is_identity and not (piece.body.repeated or piece.body.placed)
            owner = Owner(body, piece.motion, at_world, piece.centre, self.scene.fold)
            self._known[partner, left] = Whole(owner, shape, left)
        return self._known[partner, left]


def _acting(
    scene: Scene, pieces: Sequence[Piece], length: float, eta: int
) -> tuple[tuple[LoadKind, ...], tuple[LoadEntry, ...], Joined]:
    """The loads and joints of the scene; the springs of joints become loads."""
    kinds: KindList[LoadKind] = KindList()
    loads = _load_entries(scene, pieces, kinds)
    joints = joined(scene, [piece.centre for piece in pieces], length, eta, kinds)
    return kinds.kinds, (*loads, *joints.springs), joints


def _load_entries(scene: Scene, pieces: Sequence[Piece], kinds: KindList[LoadKind]) -> tuple[LoadEntry, ...]:
    entries: list[LoadEntry] = []
    for index, load in enumerate(scene.loads):
        where = f"{scene.source}: load[{index}]"
        bodies = tuple(find_body(scene, name, where) for name in bodies_of(load))
        centres = [pieces[body].centre for body in bodies]
        kind = load_kind(load, tuple(pieces[body].motion for body in bodies), centres, scene.inputs)
        entries.append(LoadEntry(kinds.index(kind), bodies, load_parameters(load, kind, centres)))
    return tuple(entries)


def _initial_q(piece: Piece) -> tuple[float, ...]:
    if not piece.moves:
        return ()
    pose = piece.body.pose
    arm = rotation_of(pose.quaternion) @ piece.centre
    p = tuple(float(a + b) for a, b in zip(pose.position, arm, strict=True))
    return p + (pose.quaternion if piece.motion == "free" else ())


def _initial_u(piece: Piece) -> tuple[float, ...]:
    if not piece.moves:
        return ()
    if piece.motion == "point":
        return piece.body.velocity
    spin = rotation_of(piece.body.pose.quaternion).T @ piece.body.angular_velocity
    return piece.body.velocity + tuple(float(value) for value in spin)


def _left_out(pieces: Sequence[Piece]) -> tuple[str, ...]:
    why = "orientation and spin, for nothing depends on how a sphere about its centre turns"
    return tuple(f"{piece.body.name}: {why}" for piece in pieces if piece.motion == "point")


def _unobserved(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{name}, for nothing observed depends on it" for name in names)
