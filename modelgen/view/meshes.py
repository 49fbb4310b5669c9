"""Triangles and lines of bodies, so fine that they stay within a tolerance of the smooth shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.curves import curve_of
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.features import features_of
from modelgen.geometry.frames import cross
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.rotations import rotation_of
from modelgen.scene.custom_solid_checks import quadric
from modelgen.scene.scene_types import Body, Condition, Feature, Pose, Shape

COARSE, FINE = 4, 96  # cells along a coordinate
ON_BORDER = 40  # halvings in the search for the border of a face

Array = np.ndarray[Any, Any]
Points = Callable[[Array], tuple[Array, Array]]  # uv (n, 2) -> points (n, 3), areas (n, 3) along the normal


@dataclass(frozen=True, slots=True)
class Mesh:
    """A body for drawing, in the axes of its centre of mass, m."""

    vertices: Array  # (n, 3)
    normals: Array  # (n, 3), out of the material
    triangles: Array  # (m, 3) of vertices
    lines: Array  # (k, 2, 3) edges and curves

    @property
    def is_empty(self) -> bool:
        return not len(self.triangles) and not len(self.lines)


def body_mesh(body: Body, centre: Sequence[float], reach: float, tolerance: float) -> Mesh:
    """All shapes of a body.

    Args:
        centre: its centre of mass in body axes as written, m.
        reach: how far unbounded surfaces and curves are drawn, m.
        tolerance: bound of the distance of the triangles from the surfaces, and of the lines from the curves,
            as a part of the size of the shape; a shape that needs more than 96 cells along a coordinate gets
            these.
    """
    parts = [_shape_mesh(shape, reach, tolerance) for shape in body.shapes]
    origin = np.array(centre)
    vertices, normals, triangles, lines, count = [], [], [], [], 0
    for part in parts:
        vertices.append(part.vertices - origin)
        normals.append(part.normals)
        triangles.append(part.triangles + count)
        lines.append(part.lines - origin)
        count += len(part.vertices)
    return _joined(vertices, normals, triangles, lines)


def _joined(vertices: list[Array], normals: list[Array], triangles: list[Array], lines: list[Array]) -> Mesh:
    none = np.zeros((0, 3))
    return Mesh(
        np.concatenate([none, *vertices]),
        np.concatenate([none, *normals]),
        np.concatenate([np.zeros((0, 3), dtype=int), *triangles]),
        np.concatenate([np.zeros((0, 2, 3)), *lines]),
    )


def _shape_mesh(shape: Shape, reach: float, tolerance: float) -> Mesh:
    radius = bounding_radius(shape)
    size = radius if isfinite(radius) else reach
    vertices, normals, triangles, lines, count = [], [], [], [], 0
    for feature in features_of(shape).features:
        if feature.dimension == 2:
            points, directions, corners = _face(feature, size, tolerance * size)
            vertices.append(_placed(shape.pose, points))
            normals.append(directions @ rotation_of(shape.pose.quaternion).T)
            triangles.append(corners + count)
            count += len(points)
        elif feature.dimension == 1:
            lines.append(_placed(shape.pose, _line(feature.shape, size, tolerance * size)))
    return _joined(vertices, normals, triangles, lines)


def _placed(pose: Pose, points: Array) -> Array:
    placed: Array = points @ rotation_of(pose.quaternion).T + np.array(pose.position)
    return placed


def _line(curve: Shape, size: float, allowed: float) -> Array:
    """A curve as segments (k, 2, 3)."""
    ((lower, upper),) = domain_of(curve)
    ends = lower if isfinite(lower) else -size, upper if isfinite(upper) else size
    t, numbers = ca.SX.sym("t"), ca.DM([value for _, value in curve.parameters])
    function = ca.Function("point", [t], [ca.densify(curve_of(curve).jet(t, ca.SX(numbers)).x)])
    count = COARSE
    while True:
        fine = np.asarray(function(np.linspace(*ends, 2 * count + 1).reshape(1, -1))).T
        middle = (fine[:-2:2] + fine[2::2]) / 2
        if np.linalg.norm(fine[1::2] - middle, axis=1).max() <= allowed or count >= 4 * FINE:
            break
        count *= 2
    points = _placed(curve.pose, fine[::2])
    return np.stack([points[:-1], points[1:]], axis=1)


def _face(face: Feature, size: float, allowed: float) -> tuple[Array, Array, Array]:
    """Vertices, normals and triangles of a face, in the axes of its composite."""
    points = _chart(face.shape)
    ends = [
        (lower if isfinite(lower) else -size, upper if isfinite(upper) else size)
        for lower, upper in domain_of(face.shape)
    ]
    cells = _cells(points, ends, allowed)
    if any(condition.kind in ("quadric", "disc") for condition in face.conditions):
        along_border = min(FINE, int(np.ceil(2 / np.sqrt(8 * allowed / size))))  # chords of a round border
        cells = max(cells[0], along_border), max(cells[1], along_border)
    uv, triangles = _grid(ends, cells)
    for condition in face.conditions:
        uv, triangles = _cut(uv, triangles, _value_of(condition, points))
    used, places = np.unique(triangles, return_inverse=True)
    triangles = places.reshape(-1, 3)
    vertices, areas = points(uv[used])
    sizes = np.linalg.norm(areas, axis=1, keepdims=True)
    normals = areas / np.where(sizes > 0, sizes, 1.0)
    singular = np.flatnonzero(sizes[:, 0] <= 1e-9 * sizes.max(initial=0.0))
    normals[singular] = _mean_normals(vertices, normals, triangles, singular)
    turn = rotation_of(face.shape.pose.quaternion)
    return _placed(face.shape.pose, vertices), normals @ turn.T, triangles


def _mean_normals(vertices: Array, normals: Array, triangles: Array, which: Array) -> Array:
    """Normals of vertices at which the chart is singular: from their triangles, on the neighbours' side."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    found = np.zeros((len(which), 3))
    for row, vertex in enumerate(which):
        mine = np.flatnonzero((triangles == vertex).any(axis=1))
        beside = normals[triangles[mine].ravel()].sum(axis=0)
        total = (flat[mine] * np.sign(flat[mine] @ beside)[:, None]).sum(axis=0)
        found[row] = total / (np.linalg.norm(total) or 1.0)
    return found


def _chart(shape: Shape) -> Points:
    """Points and areas of a surface in its own axes; the areas point out of the material."""
    at, numbers = ca.SX.sym("uv", 2), ca.DM([value for _, value in shape.parameters])
    jet = surface_of(shape).jet(at, ca.SX(numbers))
    area = exterior_sign(shape) * cross(jet.first[:, 0], jet.first[:, 1])
    function = ca.Function("face", [at], [ca.densify(jet.x), ca.densify(area)])

    def points(uv: Array) -> tuple[Array, Array]:
        if not len(uv):
            return np.zeros((0, 3)), np.zeros((0, 3))
        found, areas = function(uv.T)
        return np.asarray(found).T, np.asarray(areas).T

    return points


def _cells(points: Points, ends: Sequence[tuple[float, float]], allowed: float) -> tuple[int, int]:
    """Cells along each coordinate, so many that chords along it stay within what is allowed."""
    found = []
    for axis in (0, 1):
        count = 1
        while count < FINE and _sagitta(points, ends, axis, count) > allowed / 2:
            count *= 2
        found.append(min(count, FINE))
    return found[0], found[1]


def _sagitta(points: Points, ends: Sequence[tuple[float, float]], axis: int, count: int) -> float:
    """The largest distance of the surface from chords along a coordinate."""
    along = np.linspace(*ends[axis], 2 * count + 1)
    across = np.linspace(*ends[1 - axis], 9)
    uv = np.array([(a, b) if axis == 0 else (b, a) for b in across for a in along])
    rows = points(uv)[0].reshape(len(across), len(along), 3)
    middle = (rows[:, :-2:2] + rows[:, 2::2]) / 2
    return float(np.linalg.norm(rows[:, 1::2] - middle, axis=-1).max())


def _grid(ends: Sequence[tuple[float, float]], cells: tuple[int, int]) -> tuple[Array, Array]:
    """Coordinates (n, 2) of a grid, and its triangles."""
    u, v = (np.linspace(*each, count + 1) for each, count in zip(ends, cells, strict=True))
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(uv)).reshape(len(u), len(v))
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, c), (a, c, d))])
    return uv, triangles


def _value_of(condition: Condition, points: Points) -> Callable[[Array], Array] | None:
    """A condition as a function of coordinates (n, 2); None of one on normals, which cuts no face."""
    numbers = condition.numbers
    if condition.kind == "quadric":
        return lambda uv: np.asarray(quadric(numbers, points(uv)[0]))
    if condition.kind == "parameter":
        index, sign, bound = numbers
        return lambda uv: np.asarray(sign * (uv[:, int(index)] - bound))
    if condition.kind == "disc":
        return lambda uv: np.asarray(numbers[0] ** 2 - (uv**2).sum(axis=1))
    return None


def _cut(uv: Array, triangles: Array, value: Callable[[Array], Array] | None) -> tuple[Array, Array]:
    """The part of the triangles on which a condition holds."""
    if value is None or not len(triangles):
        return uv, triangles
    inside = value(uv) >= 0
    count = inside[triangles].sum(axis=1)
    kept, crossed = triangles[count == 3], triangles[(count > 0) & (count < 3)]
    edges = {
        tuple(sorted((int(a), int(b))))
        for triangle in crossed
        for a, b in _sides(triangle)
        if inside[a] != inside[b]
    }
    places = {edge: len(uv) + k for k, edge in enumerate(sorted(edges))}
    if places:
        pairs = np.array(list(places))
        first = np.where(inside[pairs[:, 0]], pairs[:, 0], pairs[:, 1])
        second = pairs.sum(axis=1) - first
        uv = np.concatenate([uv, _borders(uv[first], uv[second], value)])
    pieces = [piece for triangle in crossed for piece in _pieces(triangle, inside, places)]
    return uv, np.concatenate([kept, np.array(pieces, dtype=int).reshape(-1, 3)])


def _sides(triangle: Array) -> Iterator[tuple[int, int]]:
    for k in range(3):
        yield int(triangle[k]), int(triangle[(k + 1) % 3])


def _borders(inside: Array, outside: Array, value: Callable[[Array], Array]) -> Array:
    """Where a condition ends between coordinates at which it holds and others at which it does not."""
    for _ in range(ON_BORDER):
        middle = (inside + outside) / 2
        holds = (value(middle) >= 0)[:, None]
        inside, outside = np.where(holds, middle, inside), np.where(holds, outside, middle)
    return inside


def _pieces(triangle: Array, inside: Array, places: dict[tuple[int, ...], int]) -> list[list[int]]:
    """The part of one triangle whose vertices are inside."""
    polygon: list[int] = []
    for a, b in _sides(triangle):
        if inside[a]:
            polygon.append(a)
        if inside[a] != inside[b]:
            polygon.append(places[tuple(sorted((a, b)))])
    return [[polygon[0], polygon[k], polygon[k + 1]] for k in range(1, len(polygon) - 1)]
