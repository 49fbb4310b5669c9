"""Faces of several shapes in one plane that rest as one planar contact: a stool on feet, a plank on two."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import accumulate
from math import cos, pi, sin
from operator import attrgetter
from typing import Any

import numpy as np

from modelgen.assembly.feature_pairs import Whole
from modelgen.assembly.rim_support_points import SUPPORT_POINTS
from modelgen.assembly.welded_bodies import Stand
from modelgen.geometry.face_regions import in_one_plane, to_axes
from modelgen.geometry.shape_features import is_convex
from modelgen.model import FaceEntry, PatchEntry, ShareEntry
from modelgen.scene.pose_arithmetic import compose, to_inner, to_outer
from modelgen.scene.scene_types import ContactPair, Pose, Vector

Array = np.ndarray[Any, np.dtype[np.float64]]

SLOTS = 3  # patches that a pair may rest on at a time where one of its shapes is not convex


@dataclass(frozen=True, slots=True)
class Shown:
    """A pair of shapes with its patches: their bodies and the terms of their contact."""

    wholes: tuple[Whole, Whole]
    pair: ContactPair
    patches: tuple[PatchEntry, ...]


Member = tuple[int, PatchEntry]  # the number of a pair, and a patch of it


class Unions:
    """The patches of all pairs, with those in one plane between the same bodies as one."""

    def __init__(
        self, faces: Sequence[FaceEntry], stands: Sequence[Stand], centres: Sequence[Vector], flush: float
    ) -> None:
        """Of faces as single shapes have them; `stands`, `centres`: of the bodies, and their centres of mass
        in their axes, m; `flush`: m, height up to which faces are in one plane."""
        self.given, self._flush = faces, flush
        self._centred = [  # the axes of the centres of mass where the bodies stand
            compose(pose, Pose(centre)) for (_, pose), centre in zip(stands, centres, strict=True)
        ]
        self._placed = [_placed(face, stands[face.body]) for face in faces]
        self.faces: list[FaceEntry] = []
        self._known: dict[tuple[int, ...], int] = {}

    def patches(self, shown: Sequence[Shown]) -> tuple[PatchEntry, ...]:
        """The patches, each with the range of slots that it shares with the other patches of its pair."""
        found: list[list[PatchEntry]] = [[] for _ in shown]
        for group in self._groups(
            [(k, patch) for k, each in enumerate(shown) for patch in each.patches], shown
        ):
            first = group[0][0]
            name = _name([(shown[k].pair, patch) for k, patch in group])
            found[first].append(self._joined(group, name))
        return tuple(_with_slots(found, shown))

    def _groups(self, members: Sequence[Member], shown: Sequence[Shown]) -> Iterator[list[Member]]:
        """The groups of patches that become one, in order of their first patches."""
        groups: list[list[Member]] = []
        alike: defaultdict[tuple[object, ...], list[list[Member]]] = defaultdict(list)
        terms = [terms_of(each.pair) for each in shown]
        for member in members:
            bodies = (self._placed[face][0] for face in member[1].faces)
            possible = alike[terms[member[0]], *bodies]
            others = (each for each in possible if each[0][0] != member[0])
            group = next((each for each in others if self._are_level(each[0], member)), None)
            if group is None:
                groups.append([member])
                possible.append(groups[-1])
            else:
                group.append(member)
        for each in groups:
            yield from _complete(each)

    def _are_level(self, a: Member, b: Member) -> bool:
        """Whether patches between the same bodies lie in one plane."""
        faces = zip(a[1].faces, b[1].faces, strict=True)
        return all(in_one_plane(self._placed[i][1], self._placed[j][1], self._flush) for i, j in faces)

    def _joined(self, members: Sequence[Member], name: str) -> PatchEntry:
        group = [patch for _, patch in members]
        sides = [list(dict.fromkeys(patch.faces[side] for patch in group)) for side in range(2)]
        first = replace(group[0], faces=(self._union(sides[0]), self._union(sides[1])))
        if len(group) == 1:
            return first
        support_points = self._support_points(group, sides[1][0])
        return replace(
            first,
            name=name,
            parameters=tuple(
                numbers[:-3] + point for numbers, point in zip(first.parameters, support_points, strict=True)
            ),
            feature_pairs=tuple(
                sorted({feature_pair for patch in group for feature_pair in patch.feature_pairs})
            ),
            shares=tuple(self._shares(members, sides)),
        )

    def _shares(self, members: Sequence[Member], sides: Sequence[Sequence[int]]) -> Iterator[ShareEntry]:
        """The parts of a union that belong to each member."""
        ranges = []
        for faces in sides:
            ends = list(accumulate(len(self.given[face].boundary) for face in faces))
            ranges.append(dict(zip(faces, zip([0, *ends[:-1]], ends, strict=True), strict=True)))
        for pair, patch in members:
            yield ShareEntry(pair, ranges[0][patch.faces[0]], ranges[1][patch.faces[1]])

    def _union(self, members: Sequence[int]) -> int:
        """The number of the union of coplanar faces, in the axes of the first of them."""
        key = tuple(members)
        if key not in self._known:
            self._known[key] = len(self.faces)
            self.faces.append(self._face_of(members))
        return self._known[key]

    def _face_of(self, members: Sequence[int]) -> FaceEntry:
        """The face with the loops of all members. One loop number is skipped between members, which may
        overlap (core/region/region.h)."""
        first = self.given[members[0]]
        if len(members) == 1:
            return first
        axes, boundary, loops = self._placed[members[0]][1], [*first.boundary], 1 + _loops(first)
        for index in members[1:]:
            face, shift = self.given[index], to_axes(axes, self._placed[index][1])
            boundary += [
                replace(arc, pose=compose(shift, arc.pose), loop=arc.loop + loops) for arc in face.boundary
            ]
            loops += 1 + _loops(face)
        return replace(first, name=_listed(self.given[k].name for k in members), boundary=tuple(boundary))

    def _seen_from(self, body: int, patch: PatchEntry) -> Array:
        """The support points (3, 3) of a patch, given in the axes of its f, in those of another body that is
        fixed to that."""
        points = np.array([numbers[-3:] for numbers in patch.parameters])
        other = self.given[patch.faces[1]].body
        if other == body:
            return points
        return to_inner(self._centred[body], to_outer(self._centred[other], points))

    def _support_points(self, group: Sequence[PatchEntry], face: int) -> list[Vector]:
        """Points on a circle round those of all members, in the axes of f about its centre of mass."""
        points = np.array([self._seen_from(self.given[face].body, patch) for patch in group])
        centres = points.mean(axis=1)
        centre = (centres.min(axis=0) + centres.max(axis=0)) / 2
        radius = float(np.linalg.norm(points - centre, axis=2).max())
        around = Pose(_vector(centre), self.given[face].pose.quaternion)
        angles = [2 * pi * k / SUPPORT_POINTS for k in range(SUPPORT_POINTS)]
        return [_vector(to_outer(around, (radius * cos(a), radius * sin(a), 0.0))) for a in angles]


def _placed(face: FaceEntry, stand: Stand) -> Stand:
    """The first of the bodies that are fixed to a face, or FIXED, and the axes of the face there."""
    first, pose = stand
    return (first, face.pose) if first == face.body else (first, compose(pose, face.pose))


def _name(group: Sequence[tuple[ContactPair, PatchEntry]]) -> str:
    """ "stool-floor:bottom"."""
    bodies = [_listed(pair.between[side][0] for pair, _ in group) for side in range(2)]
    return f"{'-'.join(bodies)}:{_listed(patch.name.rpartition(':')[2] for _, patch in group)}"


def _listed(names: Iterable[str]) -> str:
    """The items in order, without repetitions."""
    return "+".join(dict.fromkeys(filter(None, names)))


def _vector(x: Any) -> Vector:
    return float(x[0]), float(x[1]), float(x[2])


_OF_SHAPES = ("between", "features", "form", "normal")
_TERMS = attrgetter(*(field.name for field in fields(ContactPair) if field.name not in _OF_SHAPES))


def terms_of(pair: ContactPair) -> tuple[object, ...]:
    """A pair without its shapes: the terms that patches must have in common to be one."""
    terms: tuple[object, ...] = _TERMS(pair)
    return terms


def _loops(face: FaceEntry) -> int:
    return 1 + max((arc.loop for arc in face.boundary), default=-1)


def _complete(group: list[Member]) -> list[list[Member]]:
    """The group itself if every face of o may touch every face of f; else one group per face of o."""
    first = list(dict.fromkeys(patch.faces[0] for _, patch in group))
    if len(group) == len(first) * len({patch.faces[1] for _, patch in group}):
        return [group]
    return [[member for member in group if member[1].faces[0] == face] for face in first]


def _with_slots(found: Sequence[Sequence[PatchEntry]], shown: Sequence[Shown]) -> Iterator[PatchEntry]:
    """The patches of each pair with the slots that they share: one slot where both shapes are convex."""
    first = 0
    for patches, each in zip(found, shown, strict=True):
        convex = all(is_convex(whole.shape) for whole in each.wholes)
        end = first + min(len(patches), 1 if convex else SLOTS)
        yield from (replace(patch, patch_slots=(first, end)) for patch in patches)
        first = end
