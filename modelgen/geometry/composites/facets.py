"""Flat faces to features: edges where they meet at an angle, vertices where edges meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from modelgen.geometry.composites.feature_constructors import (
    at_least,
    at_most,
    edge,
    face,
    linear,
    smooth,
    vertex,
    wing,
)
from modelgen.scene.pose_arithmetic import frame, to_inner
from modelgen.scene.scene_types import Condition, Feature

Array = np.ndarray[Any, np.dtype[np.float64]]

FLAT = 1e-9  # sine of the dihedral angle below which two faces are one


@dataclass(frozen=True)
class Facets:
    """A closed surface of convex flat faces, and the names of its parts."""

    points: Array  # (n,3) m
    loops: tuple[tuple[int, ...], ...]  # points of each face, counterclockwise from outside
    faces: tuple[str, ...]
    edges: dict[tuple[int, int], str]  # by points in ascending order
    vertices: tuple[str, ...]


@dataclass(frozen=True)
class Join:
    """Where two faces meet: `left` has the points in the order of `ends`, `right` in the other."""

    ends: tuple[int, int]
    left: int
    right: int
    tangent: Array  # (3,) unit
    into_left: Array  # (3,) unit, in the plane of the face, perpendicular to the tangent
    into_right: Array
    rise: float  # sine of the dihedral angle: positive on a convex edge

    @property
    def key(self) -> tuple[int, int]:
        return min(self.ends), max(self.ends)


def normal_of(points: Array, loop: Sequence[int]) -> Array:
    """The unit normal (3,) of a flat polygon (Newell's sum)."""
    corners = points[list(loop)] - points[loop[0]]
    total = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
    return np.asarray(total / np.linalg.norm(total))


def facet_features(facets: Facets) -> tuple[Feature, ...]:
    """Faces, convex edges, and vertices all of whose edges are convex."""
    normals = [normal_of(facets.points, loop) for loop in facets.loops]
    joins = {join.key: join for join in _joins(facets, normals)}
    bent: dict[int, list[Join]] = {}
    for join in joins.values():
        for end in join.ends:
            if abs(join.rise) > FLAT:
                bent.setdefault(end, []).append(join)
    corners = {at for at, meeting in bent.items() if all(join.rise > 0 for join in meeting)}
    faces = [_face(facets, index, normal, joins) for index, normal in enumerate(normals)]
    edges = [_edge(facets, join, normals, corners) for join in joins.values() if join.rise > FLAT]
    return (*faces, *edges, *(_vertex(facets, at, bent[at]) for at in sorted(corners)))


def _joins(facets: Facets, normals: list[Array]) -> list[Join]:
    sides = {
        ends: index
        for index, loop in enumerate(facets.loops)
        for ends in pairwise((*loop, loop[0]))
    }  # fmt: skip
    joins = []
    for (i, j), left in sides.items():
        if i < j:
            right = sides[j, i]
            along = facets.points[j] - facets.points[i]
            tangent = along / np.linalg.norm(along)
            into_left, into_right = np.cross(normals[left], tangent), np.cross(tangent, normals[right])
            rise = float(-into_left @ normals[right])
            joins.append(Join((i, j), left, right, tangent, into_left, into_right, rise))
    return joins


def _face(facets: Facets, index: int, normal: Array, joins: dict[tuple[int, int], Join]) -> Feature:
    loop = facets.loops[index]
    along = facets.points[loop[1]] - facets.points[loop[0]]
    pose = frame(facets.points[list(loop)].mean(axis=0), along / np.linalg.norm(along), normal)
    conditions = []
    for i, j in pairwise((*loop, loop[0])):
        a, b = to_inner(pose, facets.points[i]), to_inner(pose, facets.points[j])
        x, y, _ = (b - a) / np.linalg.norm(b - a)
        beyond = _beyond(facets, joins[min(i, j), max(i, j)], index)
        conditions.append(linear((a[0], a[1], 0.0), (-y, x, 0.0), beyond))
    return face(facets.faces[index], smooth("plane", pose), *conditions)


def _beyond(facets: Facets, join: Join, here: int) -> str | None:
    """The edge, the other face where the two are one plane, nothing behind a concave edge."""
    if abs(join.rise) <= FLAT:
        return facets.faces[join.right if here == join.left else join.left]
    return facets.edges[join.key] if join.rise > 0 else None


def _edge(facets: Facets, join: Join, normals: list[Array], corners: set[int]) -> Feature:
    i, j = join.ends
    a, b = facets.points[i], facets.points[j]
    z = normals[join.left]
    length = float(np.linalg.norm(b - a))
    shape = smooth("edge", frame((a + b) / 2, join.tangent, z), length=length)
    outward = np.cross(join.tangent, z)
    wings: list[Condition] = []
    for into, which in ((join.into_left, join.left), (join.into_right, join.right)):
        wings.append(wing(float(into @ outward), float(into @ z), facets.faces[which]))
    names = [facets.vertices[end] if end in corners else None for end in (i, j)]
    ends = at_least(0, -length / 2, names[0]), at_most(0, length / 2, names[1])
    return edge(facets.edges[join.key], shape, *wings, *ends)


def _vertex(facets: Facets, at: int, meeting: list[Join]) -> Feature:
    directions = [
        Condition("direction", tuple(float(e) for e in sign * join.tangent), facets.edges[join.key])
        for join in meeting
        for sign in (1.0 if join.ends[0] == at else -1.0,)
    ]
    return vertex(facets.vertices[at], facets.points[at], *directions)
