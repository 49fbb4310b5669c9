"""Patches: a planar region of one shape that may rest on one of another as a single planar contact."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import cos, pi, sin

from modelgen.assembly.contact_kinds import Partner, contact_kind_of, shape_kind
from modelgen.assembly.feature_pairs import Whole, is_allowed
from modelgen.assembly.friction_constraints import has_friction
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.rim_support_points import SUPPORT_POINTS, rim_of
from modelgen.geometry.exposed_features import is_hidden
from modelgen.geometry.face_regions import Region, regions_of
from modelgen.model import BoundaryEntry, ContactKind, FaceEntry, FeaturePairEntry, PatchEntry, ShapeKind
from modelgen.scene.pose_arithmetic import compose, to_outer
from modelgen.scene.scene_types import ContactPair, Pose, Shape


class Faces:
    """The planar faces of a scene, without repetitions, with the curves that bound them."""

    def __init__(self, shapes: KindList[ShapeKind]) -> None:
        self.shapes = shapes
        self.entries: list[FaceEntry] = []
        self._known: dict[tuple[int, str, str], int] = {}

    def index(self, whole: Whole, region: Region) -> int:
        """The number of a region of a body's shape, which is added if new."""
        key = whole.owner.body, whole.shape.name, region.name
        if key not in self._known:
            self._known[key] = len(self.entries)
            self.entries.append(self._entry(whole, region))
        return self._known[key]

    def _entry(self, whole: Whole, region: Region) -> FaceEntry:
        boundary = tuple(
            BoundaryEntry(
                self.shapes.index(shape_kind(arc.curve, whole.owner.fold)),
                *_placed(arc.curve),
                arc.ends,
                arc.loop,
            )
            for arc in region.arcs
        )
        return FaceEntry(region.name, whole.owner.body, _pose(whole, region), boundary)


def _placed(curve: Shape) -> tuple[Shape, Pose]:
    return replace(curve, pose=Pose()), curve.pose


@dataclass(frozen=True, slots=True)
class Half:
    """A planar region of one of the two shapes of a pair."""

    whole: Whole
    region: Region


@dataclass(frozen=True, slots=True)
class PlanarPair:
    """Planar regions of the two shapes of a pair, o first, that may rest on each other."""

    name: str
    regions: tuple[Region, Region]
    swapped: bool  # o is the second shape as the user named them
    kind: int  # of contact, of its support points
    friction_kind: int  # that of the first point where there is friction, or -1
    parameters: tuple[tuple[float, ...], ...]  # of each point's contact
    covered: tuple[int, ...]  # feature pairs that lie in it, by their numbers within the pair


def planar_pairs_of(
    a: Whole,
    b: Whole,
    pair: ContactPair,
    where: str,
    feature_pairs: Sequence[FeaturePairEntry],
    shapes: KindList[ShapeKind],
    kinds: KindList[ContactKind],
) -> tuple[PlanarPair, ...]:
    """The planar regions of a pair of shapes with these feature pairs that may rest on each other.

    Faces with friction that depends on the direction, or with resistances, stand on points.
    """
    if pair.friction is not None and not has_friction(pair):
        return ()
    found: list[PlanarPair] = []
    numbered = _numbers_by_features(feature_pairs)
    for one, two in product(_allowed(a, pair), _allowed(b, pair)):
        if not one.arcs and not two.arcs:
            continue
        within = product({*one.features}, {*two.features})
        covered = tuple(sorted(number for names in within for number in numbered.get(names, ())))
        swapped = not two.arcs  # o first: a whole plane if there is one
        order = (Half(b, two), Half(a, one)) if swapped else (Half(a, one), Half(b, two))
        kind, friction_kind, parameters = _support_points(order, pair, where, shapes, kinds)
        label = "-".join(filter(None, (one.name, two.name)))
        regions = order[0].region, order[1].region
        found.append(PlanarPair(label, regions, swapped, kind, friction_kind, parameters, covered))
    return tuple(found)


def patches_of(
    planar_pairs: Sequence[PlanarPair],
    wholes: tuple[Whole, Whole],
    pair: ContactPair,
    name: str,
    index: int,
    first: int,
    faces: Faces,
) -> tuple[PatchEntry, ...]:
    """The patches of the pair of that number, whose first feature pair has the number `first`."""
    coefficients = (
        (0.0, 0.0) if pair.friction is None else (pair.friction.static[0], pair.friction.kinetic[0])
    )
    return tuple(
        PatchEntry(
            f"{name}:{each.name}",
            index,
            each.kind,
            (
                faces.index(wholes[each.swapped], each.regions[0]),
                faces.index(wholes[not each.swapped], each.regions[1]),
            ),
            each.parameters,
            tuple(first + number for number in each.covered),
            friction_kind=each.friction_kind,
            friction=coefficients,
        )
        for each in planar_pairs
    )


def _allowed(whole: Whole, pair: ContactPair) -> Iterable[Region]:
    """The planar regions whose contact the scene allows, but those of which all faces are hidden."""
    faces = [each for each in whole.left or () if each.dimension == 2 and not is_hidden(each)]
    seen = {each.name.partition(".")[0] for each in faces}
    return (
        region
        for region in regions_of(whole.shape)
        if (not region.name or is_allowed(region.name, pair))
        and (whole.left is None or seen & region.features)
    )


def _numbers_by_features(
    feature_pairs: Sequence[FeaturePairEntry],
) -> Mapping[tuple[str, str], Sequence[int]]:
    """The numbers of feature pairs within their pair by the names of both features, those of points of a rim
    by the rim's."""
    found: defaultdict[tuple[str, str], list[int]] = defaultdict(list)
    for k, feature_pair in enumerate(feature_pairs):
        one, two = feature_pair.features
        found[rim_of(one), rim_of(two)].append(k)
    return found


def _pose(whole: Whole, region: Region) -> Pose:
    """The axes of a region in the body as written."""
    return compose(whole.shape.pose, region.pose)


def _support_points(
    order: Sequence[Half],
    pair: ContactPair,
    where: str,
    shapes: KindList[ShapeKind],
    kinds: KindList[ContactKind],
) -> tuple[int, int, tuple[tuple[float, ...], ...]]:
    """The kind of contact of three points of f on the plane of o, that of the first with friction, and the
    parameters of each."""
    o, f = order
    face = Shape("plane", pose=_pose(o.whole, o.region), name="plane", placed=o.whole.shape.placed)
    plane = _partner(o.whole, face, shapes)
    free = replace(pair, form="auto")
    parameters, kind, friction_kind = [], -1, -1
    for k in range(SUPPORT_POINTS):
        point = _partner(f.whole, _support_point(f, 2 * pi * k / SUPPORT_POINTS), shapes)
        kind = kinds.index(contact_kind_of(plane, point, free, where, 1)[0])
        if pair.friction is not None and k == 0:
            friction_kind = kinds.index(contact_kind_of(plane, point, free, where, 6)[0])
        parameters.append(plane.parameters + point.parameters)
    return kind, friction_kind, tuple(parameters)


def _partner(whole: Whole, shape: Shape, shapes: KindList[ShapeKind]) -> Partner:
    return Partner(whole.owner, shape, shapes.named(shape_kind(shape, False)))


def _support_point(f: Half, angle: float) -> Shape:
    """A point of the plane of f, in the axes of its body about the centre of mass."""
    (x, y), radius = f.region.centre, f.region.radius
    at = to_outer(_pose(f.whole, f.region), (x + radius * cos(angle), y + radius * sin(angle), 0.0))
    numbers = tuple(zip("xyz", map(float, at - f.whole.owner.centre), strict=True))
    return Shape("point", numbers, pose=Pose(f.whole.owner.centre), name="point")
