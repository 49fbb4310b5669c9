"""The feature pairs of two shapes: which features can touch, and what follows each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from modelgen.assembly.coaxial_supports import (
    bearer_of,
    coaxial_supports_of,
    eccentric,
    has_coaxial_supports,
    is_coaxial_support,
    seen_from_body,
)
from modelgen.assembly.contact_kinds import Owner, Partner, contact_kind_of, place_of, shape_kind
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.rim_support_points import is_support_point, lies_flat, support_points_of, tilted
from modelgen.contact.form_table import eta_layout, no_isolated_points, regular_forms
from modelgen.errors import SceneError
from modelgen.geometry.composites.feature_constructors import turned, vertex
from modelgen.geometry.curvature_bounds import touches_once
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.shape_features import features_of, is_composite, is_convex
from modelgen.model import ENDS, WATCHED, ContactKind, FeatureCondition, FeaturePairEntry, ShapeKind
from modelgen.name_suggestions import nearest
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import compose, to_outer
from modelgen.scene.scene_types import Condition, ContactPair, Feature, Pose, Shape, Vector

Array = np.ndarray[Any, Any]

STRAIGHT = frozenset(  # touch a plane along a line
    {"plane", "line", "segment", "edge", "cylinder", "cone", "conical_side"}
)
ENDED = {
    "segment": (0.0, 0.0, 1.0),
    "edge": (1.0, 0.0, 0.0),
}  # straight wires with ends, and their directions
ENDLESS = frozenset({"line", "cylinder"})  # straight shapes that have no ends where they are one feature
WIRE, ENDS_OF_WIRE = "wire", ("end_bottom", "end_top")
CONES = ("wing", "direction", "tip")  # conditions of the normal; the others are of the place
INNER_POINT = vertex("inner", (0.0, 0.0, 0.0), Condition("tip", (0.0, 0.0, 0.0, 1.0), None))  # of no normal


@dataclass(frozen=True)
class Whole:
    """A body's shape as the scene has it, with all its features."""

    owner: Owner
    shape: Shape
    left: tuple[Feature, ...] | None = None  # its features beside shapes that are fixed to it, if not all
    _placed: dict[int, tuple[Feature, tuple[Feature, Partner]]] = field(
        default_factory=dict, compare=False, repr=False
    )  # by the feature's identity, which it keeps

    @cached_property
    def without_body(self) -> tuple[Owner, Shape, tuple[Feature, ...] | None]:
        """All that its feature pairs follow from but the body."""
        return replace(self.owner, body=-1), self.shape, self.left

    @cached_property
    def ball(self) -> tuple[Vector, float]:
        """Centre (m, body axes, from the centre of mass) and radius (m, or infinite) of a ball around it."""
        centre, radius = bounding_ball(replace(self.shape, cavity=False))
        x, y, z = map(float, to_outer(self.shape.pose, centre) - np.array(self.owner.centre))
        return (x, y, z), radius

    @cached_property
    def features(self) -> tuple[Feature, ...]:
        """Its features, with the support points of those that can lie flat, and the coaxial supports."""
        features = features_of(self.shape).features if self.left is None else self.left
        points = (point for feature in features for point in support_points_of(feature))
        parts = (part for feature in features for part in coaxial_supports_of(feature))
        return (*features, *points, *parts)

    def placed(self, feature: Feature, shapes: KindList[ShapeKind]) -> tuple[Feature, Partner]:
        """The shape with the feature in place of the whole, made once for each feature; a vertex has its
        coordinates in the axes of the body."""
        if id(feature) not in self._placed:
            self._placed[id(feature)] = feature, _placed(self, feature, shapes)
        return self._placed[id(feature)][1]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A pair of features with the kind of contact between them."""

    features: tuple[Feature, Feature]  # of the first and the second shape as the user named them
    partners: tuple[Partner, Partner]
    faces: tuple[frozenset[str], frozenset[str]]  # joined smoothly to the feature, where it is a face itself
    kind: ContactKind
    swapped: bool


Candidates = Mapping[tuple[str, str], Candidate]
Two = tuple[Feature, Feature]
Face = tuple[int, str]  # of the first or second shape; its name


def feature_pairs_of(
    a: Whole,
    b: Whole,
    pair: ContactPair,
    wish: str,
    where: str,
    shapes: KindList[ShapeKind],
    kinds: KindList[ContactKind],
    index: int,
) -> tuple[FeaturePairEntry, ...]:
    """The feature pairs of a pair. Raises SceneError if there is none.

    `wish` is the form that they take where it is regular, if the pair names none.
    """
    found = _candidates(a, b, pair, wish, where, shapes)
    numbers = {names: k for k, names in enumerate(found)}
    convex = is_convex(a.shape) and is_convex(b.shape)
    known = convex and not pair.features and not _is_endless(a.shape) and not _is_endless(b.shape)
    groups = _parting_faces(found) if known else {}
    surfaces = [{each.name: each.shape.kind for each in whole.features} for whole in (a, b)]
    return tuple(
        _entry(candidate, names, numbers, kinds, index, groups, surfaces)
        for names, candidate in found.items()
    )


def _parting_faces(found: Candidates) -> dict[Face, int]:
    """Numbers of the flat faces whose gaps to all features of the other solid have no contact parameters."""
    faces: dict[Face, bool] = {}
    for names, candidate in found.items():
        face = _flat_face(names, candidate)
        if face is not None:
            faces[face] = faces.get(face, True) and eta_layout(candidate.kind) == ("none", "none")
    return {face: k for k, face in enumerate(face for face, explicit in faces.items() if explicit)}


def _flat_face(names: tuple[str, str], candidate: Candidate) -> Face | None:
    side = 1 if candidate.swapped else 0
    return (side, names[side]) if candidate.partners[side].shape.kind == "plane" else None


def _candidates(
    a: Whole, b: Whole, pair: ContactPair, wish: str, where: str, shapes: KindList[ShapeKind]
) -> dict[tuple[str, str], Candidate]:
    if _are_endless(a.shape, b.shape):
        raise no_isolated_points(place_of(pair, where), a.shape.kind, b.shape.kind)
    sides = _ended([whole.features for whole in (a, b)])
    _check_restriction(pair, sides, where)
    alone = all(sum(not is_coaxial_support(each) for each in side) == 1 for side in sides)
    once = touches_once(a.shape, b.shape)
    found: dict[tuple[str, str], Candidate] = {}
    joined = [{feature.name: _joined(feature, side) for feature in side} for side in sides]
    for (one, bearer_one), (two, bearer_two) in product(*(_allowed(side, pair) for side in sides)):
        names, bearers = (one.name, two.name), (bearer_one, bearer_two)
        if not _may_touch((one, two), bearers, alone, once):
            continue
        features = _flattened(one, two)
        if not once and features == bearers:
            features = _off_axis(*features)
        (one, first), (two, second) = (
            whole.placed(feature, shapes) for whole, feature in zip((a, b), features, strict=True)
        )
        forced = pair
        if not alone or pair.form == "auto":
            forced = _where_it_fits(pair, wish if pair.form == "auto" else pair.form, first, second)
        kind, swapped = contact_kind_of(first, second, forced, where)
        faces = joined[0][names[0]], joined[1][names[1]]
        found[names] = Candidate((one, two), (first, second), faces, kind, swapped)
    if not found:
        raise no_isolated_points(place_of(pair, where), a.shape.kind, b.shape.kind)
    return found


def is_allowed(feature: str, pair: ContactPair) -> bool:
    """Whether the scene lets a feature of that name touch."""
    return not pair.features or any(_names(each, feature) for each in pair.features)


def _names(written: str, feature: str) -> bool:
    return feature.startswith(written[:-1]) if written.endswith("*") else feature == written


def _check_restriction(pair: ContactPair, sides: list[tuple[Feature, ...]], where: str) -> None:
    known = {each.name for side in sides for each in side if each.name and _is_nameable(each)}
    for name in pair.features:
        if not any(_names(name, each) for each in known):
            raise SceneError(
                f"{where}.features",
                f"no feature {name!r}",
                f"features: {', '.join(sorted(known)) or 'none'}",
                nearest(name, known),
            )


def _ended(sides: list[tuple[Feature, ...]]) -> list[tuple[Feature, ...]]:
    """The features that can touch.

    A torus or a closed wire touches a bounded flat face with itself, and with points of it while it lies
    flat; on a whole plane it then ends the run. A straight wire touches a plane with its ends, other surfaces
    with itself too. A point within a straight shape without ends, which is parallel to the flat faces that
    it touches, is touched by nothing, but its feature pairs tell the core where the faces are.
    """
    return [_with_ends(mine, other) for mine, other in (sides, sides[::-1])]


def _with_ends(mine: tuple[Feature, ...], other: tuple[Feature, ...]) -> tuple[Feature, ...]:
    wire = mine[0]
    is_solid = not wire.name and wire.shape.kind in ENDLESS and not wire.shape.cavity
    if is_solid and any(each.shape.kind == "plane" for each in other):
        return *mine, INNER_POINT
    ring = replace(wire, name=wire.shape.kind)
    has_face = any(each.shape.kind == "plane" and each.name for each in other)
    if not wire.name and not wire.shape.cavity and has_face and lies_flat(ring):
        return ring, *support_points_of(ring), *mine[1:]
    if len(mine) > 1 or wire.shape.kind not in ENDED or all(each.dimension < 2 for each in other):
        return mine
    half, axis = wire.shape.parameters[0][1] / 2, np.array(ENDED[wire.shape.kind])
    ends = tuple(
        vertex(name, sign * half * axis, Condition("direction", tuple(-sign * axis), WIRE))
        for name, sign in zip(ENDS_OF_WIRE, (-1.0, 1.0), strict=True)
    )
    if [each.shape.kind for each in other] == ["plane"]:
        alone = tuple(replace(each, conditions=()) for each in ends)
        return alone if wire.shape.kind == "segment" else mine
    borders = (replace(each, next=name) for each, name in zip(wire.conditions, ENDS_OF_WIRE, strict=True))
    return replace(wire, name=WIRE, conditions=tuple(borders)), *ends


def _allowed(side: Sequence[Feature], pair: ContactPair) -> list[Two]:
    """The features that the scene lets touch, each with what it is a part of: a coaxial support with the
    feature that it replaces, others with themselves."""
    bearers = [bearer_of(each, side) if is_coaxial_support(each) else each for each in side]
    return [
        (feature, bearer)
        for feature, bearer in zip(side, bearers, strict=True)
        if not bearer.name or bearer is INNER_POINT or is_allowed(bearer.name, pair)
    ]


def _is_nameable(feature: Feature) -> bool:
    """Whether a scene may name the feature among those that may touch."""
    return feature is not INNER_POINT and not is_coaxial_support(feature)


def _may_touch(features: Two, bearers: Two, alone: bool, once: bool) -> bool:
    """`bearers`: what the features are parts of, or they themselves; `alone`: the shapes have one feature
    each; `once`: they touch in one point at a time."""
    for k, (support, bearer) in enumerate(zip(features, bearers, strict=True)):
        if is_coaxial_support(support):
            return not once and has_coaxial_supports(bearer, features[1 - k], k == 0)
    return alone or _touch_in_points(*features)


def _are_endless(a: Shape, b: Shape) -> bool:
    """Whether one is a plane and the other straight without ends: it touches the plane along a line, or
    passes through it."""
    return any(
        one.kind == "plane" and (_is_endless(other) or other.kind in ("plane", "edge"))
        for one, other in ((a, b), (b, a))
    )


def _is_endless(shape: Shape) -> bool:
    """Whether a shape is straight and has no ends: a bare cone has a tip, but no base."""
    return shape.kind == "cone" or (shape.kind in ENDLESS and not is_composite(shape))


def _touch_in_points(a: Feature, b: Feature) -> bool:
    orders = ((a, b), (b, a))
    if a.shape.kind == b.shape.kind == "point":
        return False
    if any(
        (is_support_point(one) or one is INNER_POINT) and other.shape.kind != "plane" for one, other in orders
    ):
        return False
    return not any(one.shape.kind == "plane" and other.shape.kind in STRAIGHT for one, other in orders)


def _flattened(a: Feature, b: Feature) -> tuple[Feature, Feature]:
    """The condition by which a rim or ring against a plane hands over to its support points where it lies
    flat."""
    return (
        tilted(a) if b.shape.kind == "plane" and lies_flat(a) else a,
        tilted(b) if a.shape.kind == "plane" and lies_flat(b) else b,
    )


def _off_axis(a: Feature, b: Feature) -> Two:
    """The condition by which a ring or funnel hands over to its coaxial supports where it is coaxial with
    another body."""
    return (
        eccentric(a) if has_coaxial_supports(a, b, True) else a,
        eccentric(b) if has_coaxial_supports(b, a, False) else b,
    )


def _joined(feature: Feature, all_of_it: tuple[Feature, ...]) -> frozenset[str]:
    """Names of the faces that a face runs into without an edge."""
    faces = {each.name for each in all_of_it if each.dimension == 2}
    nexts = {each.next for each in feature.conditions if each.next}
    return frozenset(faces & nexts) if feature.dimension == 2 else frozenset()


def _placed(whole: Whole, feature: Feature, shapes: KindList[ShapeKind]) -> tuple[Feature, Partner]:
    pose = compose(whole.shape.pose, feature.shape.pose) if feature.name else whole.shape.pose
    placed = whole.shape.placed and feature.shape.kind != "point"
    shape = replace(feature.shape, pose=pose, name=whole.shape.name, placed=placed)
    if shape.kind == "point":
        at = to_outer(pose, [value for _, value in shape.parameters]) - whole.owner.centre
        numbers = tuple(zip("xyz", map(float, at), strict=True))
        shape = replace(shape, parameters=numbers, pose=Pose(whole.owner.centre))
        rotation = rotation_of(pose.quaternion)
        feature = replace(feature, conditions=tuple(turned(each, rotation) for each in feature.conditions))
    feature = seen_from_body(feature, whole.shape.pose, whole.owner.centre)
    return feature, Partner(whole.owner, shape, shapes.named(shape_kind(shape, whole.owner.fold)))


def _where_it_fits(pair: ContactPair, form: str, a: Partner, b: Partner) -> ContactPair:
    fits = form != "auto" and form in (*regular_forms(a.side, b.side), *regular_forms(b.side, a.side))
    return replace(pair, form=form if fits else "auto")


def _entry(
    candidate: Candidate,
    names: tuple[str, str],
    numbers: Mapping[tuple[str, str], int],
    kinds: KindList[ContactKind],
    pair: int,
    groups: Mapping[Face, int],
    surfaces: Sequence[Mapping[str, str]],
) -> FeaturePairEntry:
    order = (1, 0) if candidate.swapped else (0, 1)
    o, f = (candidate.partners[k] for k in order)
    face = _flat_face(names, candidate)
    return FeaturePairEntry(
        name="-".join(filter(None, names)),
        kind=kinds.index(candidate.kind),
        pair=pair,
        o=o.owner.body,
        f=f.owner.body,
        parameters=o.parameters + f.parameters,
        swapped=candidate.swapped,
        shapes=(o.shape, f.shape),
        features=names,
        face_group=-1 if face is None else groups.get(face, -1),
        conditions=_conditions(candidate, names, numbers, order, surfaces),
    )


def _conditions(
    candidate: Candidate,
    names: tuple[str, str],
    numbers: Mapping[tuple[str, str], int],
    order: tuple[int, int],
    surfaces: Sequence[Mapping[str, str]],
) -> tuple[FeatureCondition, ...]:
    """`surfaces`: the kinds of the features of both shapes, by name."""
    found = []
    for side, mine in enumerate(order):
        other = candidate.features[1 - mine]
        faces = candidate.faces[mine]
        for condition in candidate.features[mine].conditions:
            beyond = [*names]
            beyond[mine] = condition.next or ""
            to = numbers.get((beyond[0], beyond[1]), ENDS) if condition.next else ENDS
            if to < 0 and _is_moot(condition, other, faces):
                to = WATCHED
            line = to != WATCHED and _ends_line(
                candidate.features[mine], surfaces[mine].get(condition.next or "", ""), other
            )
            found.append(FeatureCondition(condition.kind, side, condition.numbers, to, line))
    return tuple(found)


def _ends_line(feature: Feature, beyond: str, other: Feature) -> bool:
    """True if a surface or curve of the kind `beyond`, and another feature parallel to it, touch along a line
    that ends at `feature`: a vertex, an edge or a round cap, all of which belongs to the solid."""
    kinds = {beyond, other.shape.kind}
    if not kinds <= STRAIGHT or kinds == {"plane"} or feature.dimension + other.dimension < 2:
        return False
    if feature.dimension == 2:
        return feature.shape.kind == "sphere" and not feature.shape.cavity
    return beyond == "plane" or feature.shape.kind not in STRAIGHT


def _is_moot(condition: Condition, other: Feature, faces: frozenset[str]) -> bool:
    """True if the features beyond the condition touch the plane along a line or everywhere: this feature pair
    keepsits contact there."""
    return other.shape.kind == "plane" and (condition.kind in CONES or condition.next in faces)
