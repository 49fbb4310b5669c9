"""Where faces of shapes that form one solid go over into each other smoothly: contacts go on there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite
from typing import NamedTuple

import numpy as np

from modelgen.assembly.placed_shapes import Partner, Partners, PlacedShapes
from modelgen.geometry.exposed_features import is_hidden
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.smooth_borders import Border, borders_of, end_at, is_joined, is_under, placed
from modelgen.scene.pose_arithmetic import to_inner
from modelgen.scene.scene_types import Condition, Feature

BorderName = tuple[str, str, tuple[float, ...]]  # of a face; kind and numbers of the condition that ends it
Beyond = tuple[Partner, str]  # a shape and its face
End = tuple[str, Condition, Beyond]  # a face, the condition by which it ends, and what is beyond
STRAIGHT = ("plane", "cylinder", "cone", "conical_side")  # faces that touch a plane along a line


class Group(NamedTuple):
    """Shapes that form one solid for a partner."""

    all: Partners
    alike: Partners  # those that touch it on the same terms, between which contacts may go over
    on_plane: bool  # the partner has flat faces


class SmoothBorders:
    """The borders of shapes at which faces of others go on."""

    def __init__(
        self, shapes: PlacedShapes, exposed: Callable[[Partner, Partners], Sequence[Feature]]
    ) -> None:
        """`exposed`: the features of a shape that the material of others leaves."""
        self._shapes, self._exposed = shapes, exposed
        self._borders: dict[tuple[Partner, Partners], Sequence[Border]] = {}
        self._ends: dict[tuple[Partner, Group], Sequence[End]] = {}
        self._known: dict[tuple[Partner, Group], Mapping[BorderName, Beyond]] = {}

    def of(self, shape: Partner, group: Group) -> Mapping[BorderName, Beyond]:
        """Those of a shape, and the faces beyond."""
        if len(group.alike) < 2:
            return {}
        if (shape, group) not in self._known:
            found = dict(self._found(shape, group))
            for face, condition, beyond in self.ends_of(shape, group):
                found[face, condition.kind, condition.numbers] = beyond
            self._known[shape, group] = found
        return self._known[shape, group]

    def ends_of(self, name: Partner, group: Group) -> Sequence[End]:
        """Where faces of a shape end at faces of others that go over into them, by conditions that they have
        not themselves: what they have behind is covered."""
        if (name, group) not in self._ends:
            self._ends[name, group] = tuple(self._found_ends(name, group)) if len(group.alike) > 1 else ()
        return self._ends[name, group]

    def counts(self) -> Iterator[tuple[Partner, int]]:
        """How many each shape has."""
        yield from {name: len(found) for (name, _), found in self._known.items() if found}.items()

    def _found(self, name: Partner, group: Group) -> Iterator[tuple[BorderName, Beyond]]:
        """Borders that go over into faces of others, each with the face that has the most of it.

        A border with an edge has to do so all along.
        """
        near, flush = self._shapes.near(name, group.alike), self._shapes.flush
        faces = {each: self._faces(each, group) for each in near}
        edges = {each.name: each for each in self._exposed(name, group.all)}
        for border in self._borders_of(name, group) if near else ():
            count, is_covered, best = 0, np.zeros(len(border.points), dtype=bool), None
            is_round = bool(border.edge) and edges[border.edge].shape.kind != "edge"
            for each in near:
                seen = placed(border, self._shapes.seen_from(each, name))
                for face in faces[each]:
                    if is_round and group.on_plane and _is_one_straight(border.face, face):
                        continue
                    has = is_joined(seen, face, flush)
                    is_covered |= has
                    if has.sum() > count:
                        count, best = int(has.sum()), (each, face.name)
            if best is not None and (is_covered.all() or not border.edge):
                condition = border.condition
                yield (border.face.name, condition.kind, condition.numbers), best

    def _found_ends(self, name: Partner, group: Group) -> Iterator[End]:
        near, shape = self._shapes.near(name, group.alike), self._shapes.shape(name)
        flush, reach = self._shapes.flush, bounding_radius(shape)
        if shape.cavity or not isfinite(reach) or not near:
            return
        faces, cells = self._faces(name, group), self._shapes.cells(name, near)
        for each in near:
            to = self._shapes.seen_from(name, each)
            for border in self._borders_of(each, group):
                for face in faces:
                    if face.shape.kind == border.face.shape.kind == "plane":
                        continue
                    found = end_at(placed(border, to), face, reach, flush)
                    if found is None:
                        continue
                    is_covered = is_under(border.face, to_inner(to, found[1]), flush)
                    for cell in cells:
                        inside = [bool(cell.heights(x).max() <= flush) for x in found[1]]
                        is_covered = is_covered | np.array(inside, dtype=bool)
                    if is_covered.all():
                        yield face.name, found[0], (each, border.face.name)

    def _faces(self, name: Partner, group: Group) -> list[Feature]:
        features = self._exposed(name, group.all)
        return [each for each in features if each.dimension == 2 and not is_hidden(each)]

    def _borders_of(self, name: Partner, group: Group) -> Sequence[Border]:
        key = name, group.all
        if key not in self._borders:
            self._borders[key] = tuple(borders_of(self._exposed(name, group.all)))
        return self._borders[key]


def _is_one_straight(a: Feature, b: Feature) -> bool:
    """Whether a plane touches one of two faces along a line: the round edge between them holds it there."""
    return a.shape.kind in STRAIGHT or b.shape.kind in STRAIGHT
