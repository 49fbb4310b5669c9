"""The kinds and the instance of a Model as plain values for the manifest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import lru_cache
from math import isfinite
from typing import Any

from modelgen.assembly import Q_SIZE, U_SIZE
from modelgen.assembly.contact_reuse import models_have_same_contacts
from modelgen.assembly.contact_warnings import stand_ins
from modelgen.assembly.masses import pose_numbers
from modelgen.codegen.load_branches import switch_count
from modelgen.codegen.manifest_open_edges import open_edges_of
from modelgen.codegen.manifest_planar_contacts import face_table, patch_tables
from modelgen.codegen.manifest_pools import pools_of
from modelgen.codegen.manifest_repeated_pairs import all_of
from modelgen.codegen.manifest_solids import solids_of
from modelgen.codegen.manifest_unlisted_shapes import unlisted_of
from modelgen.contact.form_table import FORMS, eta_layout
from modelgen.contact.support_separation import has_separation
from modelgen.dynamics.sensors import sensor_parameters
from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.joint.joint_equations import FORMS as FORMS_OF_JOINTS
from modelgen.joint.joint_kernels import held_row_count, inertial_row_count
from modelgen.model import (
    BodyEntry,
    BodyKind,
    ContactEntry,
    ContactKind,
    FeaturePairEntry,
    FrictionConstraint,
    JointEntry,
    JointKind,
    LimitEntry,
    LimitKind,
    LoadKind,
    Model,
    PairEntry,
    ShapeKind,
    Side,
)
from modelgen.notation import ETA_SIZE
from modelgen.scene.parameter_rereading import SceneReader
from modelgen.scene.scene_types import Scene, Shape
from modelgen.scene.sensors import sensor_sizes

J_SIZE = {"fixed": 0, "driven": 6, "point": 3, "free": 6}
_INERTIA_NAMES = {
    "none": (),
    "isotropic": ("I",),
    "diagonal": ("Ixx", "Iyy", "Izz"),
    "full": ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"),
}
_SPRING_NAMES = ("stiffness", "damping", "rest")
_POSE_NAMES = ("p_x", "p_y", "p_z", *(f"R_{i}{j}" for j in "xyz" for i in "xyz"))


def kinds_of(model: Model) -> dict[str, Any]:
    """The set of kinds, each group in the order of its indices."""
    return {
        "body": [_body_kind(kind) for kind in model.body_kinds],
        "contact": [_contact_kind(kind, model) for kind in model.contact_kinds],
        "load": [_load_kind(kind) for kind in model.load_kinds],
        "shape": [_shape_kind(kind) for kind in model.shape_kinds],
        "joint": [_joint_kind(kind) for kind in model.joint_kinds],
        "limit": [_limit_kind(kind) for kind in model.limit_kinds],
    }


def _body_kind(kind: BodyKind) -> dict[str, Any]:
    moves = kind.motion in ("point", "free")
    names = ("mass", *_INERTIA_NAMES[kind.inertia]) if moves else _POSE_NAMES
    return {
        "name": kind.name,
        "motion": kind.motion,
        "inertia": kind.inertia,
        "loaded": kind.loaded,
        "n_q": Q_SIZE[kind.motion],
        "n_u": U_SIZE[kind.motion],
        "parameters": [] if kind.folded is not None else list(names),
        **_folded(kind),
        **_inputs(kind),
    }


def _folded(kind: BodyKind | ShapeKind) -> dict[str, list[float]]:
    """Numbers that are constants in the code of the kind."""
    return {} if kind.folded is None else {"folded": list(kind.folded)}


def _contact_kind(kind: ContactKind, model: Model) -> dict[str, Any]:
    layout = eta_layout(kind)
    return {
        "name": kind.name,
        "form": kind.form,
        "citation": FORMS[kind.form].citation,
        "eta": list(layout),
        "n_eta": sum(ETA_SIZE[parametrisation] for parametrisation in layout),
        "convex": eta_layout(kind) == ("point", "point") and has_separation(kind.o.shape, kind.f.shape),
        "n_o": J_SIZE[kind.o.motion],
        "n_f": J_SIZE[kind.f.motion],
        "shapes": [model.shape_kinds.index(side.shape) for side in (kind.o, kind.f)],
        "sides": [_side(kind.o), _side(kind.f)],
        "parameters": [*_side_parameters(kind.o, "o"), *_side_parameters(kind.f, "f")],
        **({"rows": kind.rows} if kind.rows > 1 else {}),
    }


def _side(side: Side) -> dict[str, Any]:
    return {
        "shape": side.shape.name, "motion": side.motion, "pose": side.pose, "placement": side.placement
    }  # fmt: skip


def _side_parameters(side: Side, name: str) -> list[str]:
    lengths = [] if side.shape.folded is not None else list(side.shape.parameter_names)
    placement = _POSE_NAMES if side.placement == "general" else ()
    return [f"{name}.{each}" for each in (*lengths, *placement)]


def _load_kind(kind: LoadKind) -> dict[str, Any]:
    return {
        "name": kind.name,
        "kind": kind.kind,
        "motions": list(kind.motions),
        "expressions": list(kind.expressions),
        "joint": kind.joint,
        "n_parameters": _load_size(kind),
        **({"switches": switches} if (switches := switch_count(kind)) else {}),
        **_inputs(kind),
    }


def _load_size(kind: LoadKind) -> int:
    if kind.joint:
        return len(parameters_of_joint(kind))
    return 3 * sum(kind.arms) + (3 if kind.kind == "spring" else 0)


def _joint_kind(kind: JointKind) -> dict[str, Any]:
    form = FORMS_OF_JOINTS[kind.kind]
    return {
        "name": kind.name,
        "kind": kind.kind,
        "rows": held_row_count(kind),
        **({"inertial_rows": inertial_row_count(kind)} if kind.armature else {}),
        "coordinates": [{"name": each.name, "measure": each.measure} for each in form.coordinates],
        "motion": None if kind.motion is None else kind.motion.text,
        "parameters": parameters_of_joint(kind),
        **_inputs(kind),
    }


def _inputs(kind: BodyKind | LoadKind | JointKind) -> dict[str, list[dict[str, str]]]:
    """Names and holds of the inputs that the kernel of the kind takes."""
    return {"inputs": [asdict(each) for each in kind.inputs]} if kind.inputs else {}


def _limit_kind(kind: LimitKind) -> dict[str, Any]:
    named = {key: value for key, value in asdict(kind).items() if key != "coordinate"}
    further = {"coordinate": kind.coordinate} if kind.coordinate else {}
    return {**named, **further, "parameters": parameters_of_joint(kind)}


def _joint_parameters(kind: str) -> list[str]:
    placements = (f"{side}.{name}" for side in "ab" for name in _POSE_NAMES)
    return [*placements, "length", *FORMS_OF_JOINTS[kind].numbers]


def parameters_of_joint(kind: JointKind | LimitKind | LoadKind) -> list[str]:
    """Names of the parameters of the kernels of a kind of joint, of its limits or of its springs, in
    order."""
    if isinstance(kind, LoadKind):
        own = _SPRING_NAMES if kind.is_spring else ("gain", *(("least", "largest") if kind.limited else ()))
        return [*_joint_parameters(kind.joint), *own]
    bound = ["bound"] if isinstance(kind, LimitKind) else []
    inertias = [] if isinstance(kind, LimitKind) else [f"armature_{name}" for name in kind.armature]
    return [*_joint_parameters(kind.kind), *bound, *inertias]


def _shape_kind(kind: ShapeKind) -> dict[str, Any]:
    return {
        "name": kind.name,
        "kind": kind.kind,
        "parameters": list(kind.parameter_names),
        **_folded(kind),
        "cavity": kind.cavity,
        "periodic": list(_periodic(kind)),
    }


def _periodic(kind: ShapeKind) -> tuple[bool, ...]:
    """Whether each chart coordinate is periodic: two of a surface, one of a curve, none of a point."""
    if is_point(kind):
        return ()
    return (curve_of(kind).periodic,) if is_curve(kind) else surface_of(kind).periodic


def _finite(value: float) -> float | None:
    """The value, or None in place of infinity, which JSON lacks."""
    return float(value) if isfinite(value) else None


def instance_of(model: Model, known: tuple[Model, dict[str, Any]] | None = None) -> dict[str, Any]:
    """The scene as tables that refer to the kinds by number.

    `known`: another model with its instance, whose tables of contacts are taken over where the model has
    the same entries.
    """
    scene = model.scene
    return {
        "name": scene.name,
        "source": scene.source,
        "bodies": [_body(model, entry) for entry in model.bodies],
        **(_contacts(model) if known is None else _contacts_like(model, *known)),
        **pools_of(model),
        "loads": [
            {"kind": load.kind, "bodies": list(load.bodies), "parameters": list(load.parameters)}
            for load in model.loads
        ],
        "joints": [_joint(model, entry) for entry in model.joints],
        "limits": [_limit(model, entry) for entry in model.limits],
        "n_q": model.n_q,
        "n_u": model.n_u,
        "n_eta": model.n_eta,
        "scales": asdict(model.scales),
        "inputs": [asdict(each) for each in scene.inputs],
        "sensors": {
            "names": [list(each) for each in sensor_sizes(scene.sensors)],
            "parameters": list(sensor_parameters(model)),
            **_measured_pairs(model),
        },
        "initial_q": list(model.initial_q),
        "initial_u": list(model.initial_u),
        "gravity": list(scene.gravity),
        "observe": list(scene.observe),
        "left_out": list(model.left_out),
        "warnings": list(model.warnings),
        **({"stand_ins": [list(each) for each in replaced]} if (replaced := stand_ins(model.scene)) else {}),
        "run": scene.run.said(),
    }


CONTACTS = (
    "pairs",
    "feature_pairs",
    "contacts",
    "faces",
    "patches",
    "solids",
    "unlisted",
    "open_edges",
    "handovers",
)


def _contacts(model: Model) -> dict[str, Any]:
    """The tables that follow from shapes, their places about the centres of mass, and contact pairs."""
    pairs = [_pair(model, entry) for entry in model.pairs]
    return {
        "pairs": pairs,
        "feature_pairs": _feature_pairs(model, pairs),
        "contacts": [_contact(entry) for entry in model.contacts],
        "faces": [face_table(model, entry) for entry in model.faces],
        "patches": patch_tables(model.patches),
        "solids": solids_of(model),
        "unlisted": unlisted_of(model),
        "open_edges": open_edges_of(model),
        **_handovers(model),
    }


def _handovers(model: Model) -> dict[str, list[list[int]]]:
    """Feature pair, number of its condition, and the feature pair of another pair beyond that."""
    found = [[each.feature_pair, each.condition, each.next] for each in model.handovers]
    return {"handovers": found} if found else {}


def _contacts_like(model: Model, other: Model, known: dict[str, Any]) -> dict[str, Any]:
    """The same, taken over from another model where that has the same contacts and joined bodies."""
    joined = [[(joint.a, joint.b) for joint in each.joints] for each in (model, other)]
    if joined[0] != joined[1] or not models_have_same_contacts(model, other):
        return _contacts(model)
    found = {key: known[key] for key in CONTACTS if key in known}
    if model.scene.contacts != other.scene.contacts:
        found["pairs"] = [_pair(model, entry) for entry in model.pairs]
        found["patches"] = patch_tables(model.patches)
    return found


def parameters_of(scene: Scene) -> dict[str, Any]:
    """The parameters of a scene that has some, and the tables that it can be read from again, for its
    instance.

    The latter are None of a scene that was changed since it was read.
    """
    if not scene.parameters:
        return {}
    origin = scene.origin
    if origin is not None:
        values = {each.name: each.value for each in scene.parameters}
        again = SceneReader(scene.name, scene.source, origin).scene(values)
        origin = origin if again == replace(scene, nominal=None) else None
    return {
        "parameters": [asdict(each) for each in scene.parameters],
        "origin": origin and {"tables": origin.tables, "form": origin.form},
    }


def _measured_pairs(model: Model) -> dict[str, list[int]]:
    """The pairs that sensors measure."""
    measured = (each.measurand for each in model.scene.sensors)
    names = {name for each in measured if each is not None for name in each.pairs}
    pairs = [index for index, entry in enumerate(model.pairs) if entry.name in names]
    return {"pairs": pairs} if pairs else {}


def _body(model: Model, entry: BodyEntry) -> dict[str, Any]:
    return {
        "name": entry.name,
        "kind": entry.kind,
        "motion": model.body_kinds[entry.kind].motion,
        "q": entry.q,
        "u": entry.u,
        "parameters": list(entry.parameters),
        "mass_inverse": list(entry.mass_inverse),
        "centre_of_mass": list(entry.centre_of_mass),
    }


def _joint(model: Model, entry: JointEntry) -> dict[str, Any]:
    pose = pose_numbers(entry.frames[1], model.bodies[entry.b].centre_of_mass)
    return {
        "name": entry.name,
        "kind": entry.kind,
        "a": entry.a,
        "b": entry.b,
        "row": entry.row,
        "anchor": list(pose[:3]),  # origin of the frame in b, from its centre of mass
        "parameters": list(entry.parameters),
    }


def _limit(model: Model, entry: LimitEntry) -> dict[str, Any]:
    """The entry of a limit of a joint. Kinds of limits are numbered after those of contacts."""
    return {
        "name": entry.name,
        "kind": len(model.contact_kinds) + entry.kind,
        "joint": entry.joint,
        "o": entry.a,
        "f": entry.b,
        "eta": entry.eta,
        "restitution": entry.restitution,
        "parameters": list(entry.parameters),
    }


def _pair(model: Model, entry: PairEntry) -> dict[str, Any]:
    return {
        "name": entry.name,
        "bodies": list(entry.bodies),
        **({} if entry.repeats is None else {"repeats": entry.repeats}),
        "feature_pairs": list(entry.feature_pairs),
        "contacts": list(entry.contacts),
        "search": entry.search,
        **({"candidate": True} if entry.candidate else {}),
        "restitution": entry.restitution.value,
        **({"law": entry.restitution.law} if entry.restitution.law != "newton" else {}),
        "normal": entry.normal and list(entry.normal),
        "bounding_balls": [
            {"shape": shape, "centre": list(centre), "radius": _finite(radius)}
            for shape, (centre, radius) in zip(entry.shapes, entry.bounding_balls, strict=True)
        ],
        **({"friction": _friction(entry.friction)} if entry.friction else {}),
    }


@lru_cache(maxsize=64)
def _friction(constraints: tuple[FrictionConstraint, ...]) -> list[dict[str, Any]]:
    return [asdict(constraint) for constraint in constraints]


def _contact(entry: ContactEntry) -> dict[str, Any]:
    return {
        "name": entry.name,
        "pair": entry.pair,
        "eta": entry.eta,
        "room": entry.room,
        "feature_pair": entry.feature_pair,
    }


class _Shapes:
    """The tables of the shapes of feature pairs, each made once."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._known: dict[tuple[int, int, int], dict[str, Any]] = {}

    def of(self, body: int, shape: Shape, side: Side) -> dict[str, Any]:
        key = id(shape), body, id(side.shape)  # both belong to the model
        if key not in self._known:
            self._known[key] = _shape(self._model, body, shape, side)
        return self._known[key]


def _feature_pairs(model: Model, pairs: Sequence[Mapping[str, Any]]) -> Sequence[dict[str, Any]]:
    """`pairs`: the entries of the pairs."""
    shapes = _Shapes(model)
    own = {
        index: [
            _feature_pair(model, entry, shapes) for entry in model.feature_pairs[slice(*pair.feature_pairs)]
        ]
        for index, pair in enumerate(model.pairs)
        if pair.repeats is None
    }
    return all_of(pairs, own)


def _feature_pair(model: Model, entry: FeaturePairEntry, shapes: _Shapes) -> dict[str, Any]:
    kind = model.contact_kinds[entry.kind]
    return {
        "name": entry.name,
        "kind": entry.kind,
        "pair": entry.pair,
        "o": entry.o,
        "f": entry.f,
        "parameters": list(entry.parameters),
        "swapped": entry.swapped,
        "shape_o": shapes.of(entry.o, entry.shapes[0], kind.o),
        "shape_f": shapes.of(entry.f, entry.shapes[1], kind.f),
        "face_group": entry.face_group,
        "conditions": [
            {
                "kind": each.kind,
                "side": each.side,
                "numbers": list(each.numbers),
                "next": each.next,
                **({"line": True} if each.line else {}),
            }
            for each in entry.conditions
        ],
    }


def _shape(model: Model, body: int, shape: Shape, side: Side) -> dict[str, Any]:
    """The shape of one side: its kind, its lengths, its placement in the centre-of-mass axes, its extent."""
    centre, radius = bounding_ball(shape)
    return {
        "name": shape.name,
        "kind": model.shape_kinds.index(side.shape),
        "parameters": [value for _, value in shape.parameters],
        "placement": list(pose_numbers(shape.pose, model.bodies[body].centre_of_mass)),
        "domain": [[_finite(bound) for bound in interval] for interval in domain_of(shape)],
        "bounding_radius": _finite(radius),
        "centre": list(centre),
    }
