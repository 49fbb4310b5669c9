"""Shapes that passed through each other in a run: pairs that no contact lists, and shapes over an open edge.

Balls around the shapes are compared at the samples, with the motion between them. Where they meet, a point in
both materials is searched: at samples, and between two samples at interpolated poses. There it must be deeper
by how far the interpolation is from the poses to which each of the samples leads at its velocity, so that
neither an impact nor an acceleration in between makes an overlap of none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from modelgen.codegen.library import Library
from modelgen.rotations import quaternion_of, rotation_of
from modelgen.runtime.solids import Array, Common, Materials, points_of
from modelgen.runtime.trajectory import Passage, Trajectory

STEP = 0.25  # part of the smaller ball's radius that the bodies move between two searches, at most
PARTS = 1000  # into which the way between two samples is divided, at most
HALVINGS = 8  # of the time within which an overlap begins


@dataclass(frozen=True, slots=True)
class _Solid:
    """A shape of the table `unlisted` in the centre-of-mass axes of its body."""

    body: int
    label: str
    centre: Array  # (3,) m, of its ball
    radius: float  # m; infinite where the material is not bounded
    solid: int | None  # its material, less the cavities of its body
    points: Array  # (n, 3) m, in place of a material
    spacing: float  # m, of the points

    @property
    def extent(self) -> float:
        """m: the largest distance of its points from the centre of mass."""
        return float(np.linalg.norm(self.centre)) + self.radius


class _Placed(NamedTuple):
    """A pose, and how far it is from those to which the samples before and after it lead."""

    p: Array  # (3,) m
    R: Array  # (3, 3)
    far: float  # m
    turned: float  # rad


@dataclass(frozen=True, slots=True)
class _Motion:
    """The poses and twists of all bodies at the samples, world axes, and the material of their shapes."""

    t: Array  # (n,) s
    p: Array  # (n, nb, 3) m
    R: Array  # (n, nb, 3, 3)
    v: Array  # (n, nb, 3) m/s
    w: Array  # (n, nb, 3) rad/s
    materials: Materials

    def pose(self, body: int, sample: int, after: float) -> _Placed:
        """The pose of a body `after` s from a sample, before the next: position by the cubic with the
        velocities at both, orientation by a turn about one axis."""
        if not after:
            return _Placed(self.p[sample, body], self.R[sample, body], 0.0, 0.0)
        (p, q), (R, S), (v, u), (w, z) = (
            column[sample : sample + 2, body] for column in (self.p, self.R, self.v, self.w)
        )
        h = float(self.t[sample + 1] - self.t[sample])
        share, left = after / h, h - after
        turn = _rotation_vector(S @ R.T)
        cubic = (1 + 2 * share) * p + after * v
        cubic = (1 - share) ** 2 * cubic + share**2 * ((3 - 2 * share) * q - left * u)
        far = max(np.linalg.norm(cubic - p - after * v), np.linalg.norm(cubic - q + left * u))
        turned = max(np.linalg.norm(share * turn - after * w), np.linalg.norm((1 - share) * turn - left * z))
        return _Placed(cubic, _rotation(share * turn) @ R, float(far), float(turned))


def passages(path: Trajectory, library: Library, depth: float) -> tuple[Passage, ...]:
    """The pairs of shapes that no contact lists and that passed through each other, by time.

    Args:
        path: the run.
        library: of which it is a run.
        depth: `Accuracy.thresholds.overlap_depth`: a point in both materials is deeper than this times the
            smaller ball's radius.
    """
    instance = library.manifest.instance
    table = instance["unlisted"]
    if not table["shapes"] or not len(path.t):
        return ()
    moves = [body["motion"] in ("point", "free") for body in instance["bodies"]]
    materials = Materials(table, library)
    solids = _solids(table, materials, library)
    excepted = {tuple(pair) for pair in table["listed"]}
    joined = {tuple(pair) for pair in table["joined"]}
    return _seen(path, materials, solids, _pairs(solids, moves, excepted, joined), depth)


def passages_over_edges(path: Trajectory, library: Library, depth: float) -> tuple[Passage, ...]:
    """The shapes with open edges, and those that an edge entered although a contact lists the pair, by time.

    Args:
        path, library, depth: as of `passages`.
    """
    table = library.manifest.instance["open_edges"]
    if not table["pairs"] or not len(path.t):
        return ()
    materials = Materials(table, library)
    solids = _solids(table, materials, library)
    partners: dict[int, list[int]] = {}
    for edge, shape in table["pairs"]:
        if solids[shape].solid is not None:
            partners.setdefault(edge, []).append(shape)
    return _seen(path, materials, solids, iter(partners.items()), depth)


def _seen(
    path: Trajectory,
    materials: Materials,
    solids: list[_Solid],
    pairs: Iterator[tuple[int, list[int]]],
    depth: float,
) -> tuple[Passage, ...]:
    """The pairs that overlapped, by time."""
    motion, found = _motion(path, materials), []
    for i, partners in pairs:
        for j, clear in _near(motion, solids, i, partners):
            t = _first_overlap(motion, solids[i], solids[j], clear, depth)
            if t is not None:
                found.append(Passage((solids[i].label, solids[j].label), t))
    return tuple(sorted(found, key=lambda each: each.t))


def _motion(path: Trajectory, materials: Materials) -> _Motion:
    """What the samples know of the motion; a body whose turning is unknown counts as one that does not
    turn."""
    quaternion = np.where(np.isnan(path.quaternion), (1.0, 0.0, 0.0, 0.0), path.quaternion).astype(float)
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    R = np.moveaxis(rotation_of((w, x, y, z)), (0, 1), (-2, -1))
    spin = np.nan_to_num(path.w.astype(float))
    return _Motion(path.t.astype(float), path.p.astype(float), R, path.v.astype(float), spin, materials)


def _solids(table: Mapping[str, Any], materials: Materials, library: Library) -> list[_Solid]:
    names = [body["name"] for body in library.manifest.instance["bodies"]]
    return [_solid(entry, materials, names[entry["body"]]) for entry in table["shapes"]]


def _solid(entry: Mapping[str, Any], materials: Materials, name: str) -> _Solid:
    placement = np.array(entry["placement"])
    R = placement[3:].reshape(3, 3, order="F")
    bounded = entry["radius"] is not None and not entry["cavity"]
    is_thin = entry["thin"] and "points" in entry
    return _Solid(
        entry["body"],
        name if entry["alone"] else f"{name}/{entry['name']}",
        placement[:3] + R @ np.array(entry["centre"]),
        float(entry["radius"]) if bounded else np.inf,
        materials.number(entry),
        points_of(entry) if is_thin else np.zeros((0, 3)),
        float(entry["parameters"][0]) if is_thin else 0.0,
    )


def _pairs(
    solids: list[_Solid], moves: list[bool], excepted: set[Any], joined: set[Any]
) -> Iterator[tuple[int, list[int]]]:
    """Each shape with those after it that it may pass through; at least one has a material and an end."""
    partners: dict[int, list[int]] = {}
    for (i, a), (j, b) in combinations(enumerate(solids), 2):
        bodies = (min(a.body, b.body), max(a.body, b.body))
        if a.body == b.body or not (moves[a.body] or moves[b.body]):
            continue
        if (i, j) in excepted or bodies in joined or np.isinf(min(a.radius, b.radius)):
            continue
        solid = [each.solid is not None for each in (a, b)]
        if any(solid) and (solid[0] or len(a.points)) and (solid[1] or len(b.points)):
            partners.setdefault(i, []).append(j)
    return iter(partners.items())


def _near(motion: _Motion, solids: list[_Solid], i: int, partners: list[int]) -> Iterator[tuple[int, Array]]:
    """Partners of a shape that come near it, with the distance (n,) m of the balls at the samples."""
    own, others = solids[i], [solids[j] for j in partners]
    centre, speed = _ball(motion, [own])
    centres, speeds = _ball(motion, others)
    radii = np.array([other.radius for other in others])
    if np.isfinite(own.radius):
        apart = np.linalg.norm(centres - centre, axis=-1) - radii - own.radius
    else:
        apart = np.full(radii.shape, -np.inf)[None] + np.zeros((len(motion.t), 1))
    for k, other in enumerate(others):
        if np.isinf(apart[0, k]):
            apart[:, k] = _from_unbounded(motion, own, other)
    moved = np.linalg.norm(speeds - speed, axis=-1)
    reach = np.diff(motion.t)[:, None] * np.maximum(moved[1:], moved[:-1])
    least = np.minimum(apart[1:], apart[:-1]) - reach if len(motion.t) > 1 else apart
    for k in np.flatnonzero((least < 0).any(axis=0)).tolist():
        yield partners[k], apart[:, k]


def _ball(motion: _Motion, solids: list[_Solid]) -> tuple[Array, Array]:
    """(n, number of solids, 3) centres of their balls, m, and velocities of these, m/s; world axes."""
    bodies = [solid.body for solid in solids]
    arms = np.einsum("nbij,bj->nbi", motion.R[:, bodies], np.array([solid.centre for solid in solids]))
    return motion.p[:, bodies] + arms, motion.v[:, bodies] + np.cross(motion.w[:, bodies], arms)


def _from_unbounded(motion: _Motion, a: _Solid, b: _Solid) -> Array:
    """(n,) m: a bound from below on the distance of two shapes of which one has no end."""
    wide, ball = (a, b) if np.isinf(a.radius) else (b, a)
    if wide.solid is None:
        return np.full(len(motion.t), -ball.radius)
    centre, _ = _ball(motion, [ball])
    local = np.einsum("nji,nj->ni", motion.R[:, wide.body], centre[:, 0] - motion.p[:, wide.body])
    return motion.materials.heights(wide.solid, local) - ball.radius


def _first_overlap(motion: _Motion, a: _Solid, b: _Solid, clear: Array, depth: float) -> float | None:
    """The first time found, s, at which two shapes overlap; None if they do not.

    `slack` bounds from below how far they can move before they overlap.
    """
    if b.radius > a.radius:
        a, b = b, a
    deep, moved = depth * b.radius, _moved(motion, a, b)
    slack = 0.0
    for k in range(len(motion.t)):
        way = moved[k - 1] if k else 0.0
        if k and way > slack:
            seen = _overlap_between(motion, a, b, k - 1, way, (slack, max(clear[k], 0.0)), deep)
            if seen is not None:
                return _refined(motion, a, b, k - 1, seen, deep)
        before, slack = slack, max(slack - way, clear[k])
        if slack <= 0:
            is_deep, slack = _overlap(motion, a, b, k, 0.0, deep)
            if is_deep and not k:
                return float(motion.t[0])
            if is_deep:
                h = float(motion.t[k] - motion.t[k - 1])
                return _refined(motion, a, b, k - 1, (h * min(before / way, 1.0) if way else 0.0, h), deep)
    return None


def _overlap_between(
    motion: _Motion, a: _Solid, b: _Solid, k: int, way: float, apart: tuple[float, float], deep: float
) -> tuple[float, float] | None:
    """Times after sample k, s, at the first of which two shapes do not overlap, and at the second do.

    Args:
        way: m, how far they move up to the next sample.
        apart: m, how far they can move from each of the two samples without an overlap.
    """
    h, end = float(motion.t[k + 1] - motion.t[k]), way - apart[1]
    step = max(STEP * b.radius, (end - apart[0]) / PARTS)
    last, gone = 0.0, max(apart[0], step)
    while gone < end:
        after = float(h * gone / way)
        is_deep, slack = _overlap(motion, a, b, k, after, deep)
        if is_deep:
            return last, after
        gone, last = gone + max(step, slack), after
    return None


def _refined(
    motion: _Motion, a: _Solid, b: _Solid, k: int, between: tuple[float, float], deep: float
) -> float:
    """The time, s, at which an overlap begins that is seen between two times after sample k, by bisection."""
    low, high = between
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if _overlap(motion, a, b, k, middle, deep).is_deep:
            high = middle
        else:
            low = middle
    return float(motion.t[k] + high)


def _moved(motion: _Motion, a: _Solid, b: _Solid) -> Array:
    """(n - 1,) m: how far points of b move between samples in the axes of a's body, at most."""
    arm = motion.p[:, b.body] - motion.p[:, a.body]
    frame = np.cross(motion.w[:, a.body], arm)
    v = np.linalg.norm(motion.v[:, b.body] - motion.v[:, a.body] - frame, axis=-1)
    speed = v + b.extent * np.linalg.norm(motion.w[:, b.body] - motion.w[:, a.body], axis=-1)
    return np.asarray(np.diff(motion.t) * np.maximum(speed[1:], speed[:-1]))


def _overlap(motion: _Motion, a: _Solid, b: _Solid, k: int, after: float, deep: float) -> Common:
    """Whether the materials have a point in common deeper than `deep` and than the poses are uncertain,
    `after` s from sample k."""
    of_a, of_b = (motion.pose(solid.body, k, after) for solid in (a, b))
    unsure = of_a.far + of_b.far + (of_a.turned + of_b.turned) * _reach(of_a, of_b, b)
    found = _common(motion.materials, a, b, of_a.R.T @ of_b.R, of_a.R.T @ (of_b.p - of_a.p), deep + unsure)
    return Common(found.is_deep, max(found.slack - 2 * unsure, 0.0))


def _reach(of_a: _Placed, of_b: _Placed, b: _Solid) -> float:
    """m: the largest distance of a point of b from both centres of mass."""
    return float(np.linalg.norm(of_b.p - of_a.p)) + b.extent


def _common(materials: Materials, a: _Solid, b: _Solid, R: Array, p: Array, deep: float) -> Common:
    """Whether two materials have a point in common deeper than `deep`; R and p lead from b's axes to a's."""
    if a.solid is not None and b.solid is not None:
        return materials.common(a.solid, b.solid, R, p, b.centre, b.radius, deep)
    if a.solid is not None:
        value, spacing = materials.heights(a.solid, b.points @ R.T + p), b.spacing
    elif b.solid is not None:
        value, spacing = materials.heights(b.solid, (a.points - p) @ R), a.spacing
    else:
        return Common(False, np.inf)
    least = float(value.min())
    return Common(least < -deep, max(least - spacing / 2 + deep, 0.0))


def _rotation_vector(R: Array) -> Array:
    """(3,) rad: the axis of a rotation (3, 3), as long as its angle, which is at most half a turn."""
    quaternion = np.array(quaternion_of(R))
    w, axis = quaternion[0], quaternion[1:]
    sine = float(np.linalg.norm(axis))
    if not sine:
        return np.zeros(3)
    angle = 2 * np.arctan2(sine, abs(w)) * (1.0 if w >= 0 else -1.0)
    return np.asarray(angle / sine * axis)


def _rotation(vector: Array) -> Array:
    """(3, 3) the rotation about a vector by its length, rad."""
    angle = float(np.linalg.norm(vector))
    if not angle:
        return np.eye(3)
    x, y, z = np.sin(angle / 2) / angle * vector
    return rotation_of((float(np.cos(angle / 2)), float(x), float(y), float(z)))
