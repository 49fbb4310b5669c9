"""The space of a picture: where the bodies of a run move, and how far they reach."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.geometry.body_meshes import Mesh
from modelgen.rotations import rotation_of

Array = np.ndarray[Any, Any]

FOLLOWED = 5.0  # of all motion, against the group of bodies that move, from which on the picture follows
NEAR = 2.2  # of a picture that follows, against the group
WIDE = 3.0  # of what stands still, against all motion, from which on the picture shows the motion alone
WHOLE = 8.0  # of all bodies, against the group, up to which the picture shows all of them nevertheless
INSTANTS = 60  # samples by which it is measured


@dataclass(frozen=True, slots=True)
class Space:
    """Where a run takes place, m, world axes."""

    centre: Array  # (3,)
    size: float  # half the size of the picture
    follow: bool  # the picture moves with the bodies
    reach: float  # half the size of the space of all bounded bodies
    away: tuple[float, ...]  # of each body, at first, from the middle of that space


def space_of(
    columns: Mapping[str, Array], meshes: Sequence[Mesh], bounded: Sequence[bool], moving: Collection[int]
) -> Space:
    """The space of a run from the meshes of its bodies, which of them have an end, and which move."""
    places = {index: _places(columns, index, mesh) for index, mesh in enumerate(meshes) if bounded[index]}
    centre, reach = _ball(list(places.values()))
    radii = {index: radius_of(meshes[index]) for index in places if index in moving}
    follow = False
    size = reach
    away = tuple(_distance(columns, k, centre) for k in range(len(meshes)))
    if radii:
        centre_of_motion, motion = _ball([places[index] for index in radii])
        group = _group(columns, radii)
        is_wide = reach > WHOLE * group
        follow = is_wide and motion > FOLLOWED * group
        if follow or (is_wide and reach > WIDE * motion):
            centre, size = centre_of_motion, NEAR * group if follow else motion
    return Space(centre, size, follow, reach, away)


def pose_at(columns: Mapping[str, Array], body: int, sample: int) -> tuple[Array, Array]:
    """Rotation (3, 3) and centre of mass (3,) of a body at a sample; not turned, or in the origin, where
    that is not known."""
    q, p = columns["quaternion"][sample, body], columns["p"][sample, body]
    turned = rotation_of(q) if np.isfinite(q).all() else np.eye(3)
    return turned, np.nan_to_num(p)


def _own_points(mesh: Mesh) -> Array:
    points = np.concatenate([mesh.vertices, mesh.lines.reshape(-1, 3)])
    return points if len(points) else np.zeros((1, 3))


def radius_of(mesh: Mesh) -> float:
    """Largest distance of the points of a mesh from its origin, m."""
    return float(np.linalg.norm(_own_points(mesh), axis=1).max())


def _samples(columns: Mapping[str, Array]) -> list[int]:
    """Samples by which a run is measured."""
    count = len(columns["t"])
    return np.unique(np.linspace(0, count - 1, min(count, INSTANTS)).astype(int)).tolist() if count else []


def _distance(columns: Mapping[str, Array], body: int, centre: Array) -> float:
    """How far a body is from the middle of the space at first."""
    return float(np.linalg.norm(centre - pose_at(columns, body, 0)[1])) if len(columns["t"]) else 0.0


def _places(columns: Mapping[str, Array], body: int, mesh: Mesh) -> Array:
    """Where the points of a body come to lie in the run, (n, 3)."""
    own = _own_points(mesh)
    poses = (pose_at(columns, body, k) for k in _samples(columns))
    return np.concatenate([np.zeros((0, 3)), *(own @ turn.T + place for turn, place in poses)])


def _group(columns: Mapping[str, Array], radii: Mapping[int, float]) -> float:
    """How far bodies reach, at any time, from the mean of their centres, m."""
    found = 1e-6
    for sample in _samples(columns):
        centres = np.array([pose_at(columns, body, sample)[1] for body in radii])
        off = np.linalg.norm(centres - centres.mean(axis=0), axis=1) + list(radii.values())
        found = max(found, float(off.max()))
    return found


def _ball(points: Sequence[Array]) -> tuple[Array, float]:
    """Centre of the box around points, and their largest distance from it."""
    whole = np.concatenate([np.zeros((0, 3)), *points])
    if not len(whole):
        return np.zeros(3), 1.0
    centre = (whole.min(axis=0) + whole.max(axis=0)) / 2
    return centre, max(float(np.linalg.norm(whole - centre, axis=1).max()), 1e-6)
