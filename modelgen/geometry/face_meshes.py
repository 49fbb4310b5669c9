"""Triangles of a face, within a distance of its surface and of its border.

The face is a grid of its coordinates, finer where chords of the grid leave the surface, and is cut where a
condition of the face ends. Distances are taken between points of equal coordinates, and are thus bounds of
the distances between surface and triangles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import hypot
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.coordinate_domains import domain_within
from modelgen.geometry.frames import cross
from modelgen.geometry.mesh_cuts import Border, cut
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.scene.custom_solid_checks import quadric
from modelgen.scene.scene_types import Chart, Condition, Feature, Shape

Array = np.ndarray[Any, Any]
Points = Callable[[Array], tuple[Array, Array]]  # uv (n, 2) -> points (n, 3), areas (n, 3) along the normal
Condition2 = Callable[[Array], Array]  # uv (n, 2) -> (n,), >= 0 on the face
Ends = tuple[tuple[float, float], ...]

FIRST = 7  # cells along a coordinate, at first
MOST = 256  # cells along a coordinate
PROBED = (0.25, 0.5, 0.75)  # places of a chord at which its distance is taken
SOUGHT = 33  # places along a coordinate at which the extent of a face is sought
ZOOMS = 12  # steps of that search
ALONE = 0.45  # of the two chords of a triangle, the part of the allowed distance that each may take
SINGULAR = 1e-9  # area against the largest, at which a chart has no normal


@dataclass(frozen=True, slots=True)
class FaceMesh:
    """Triangles of a face in the axes of its surface, m."""

    vertices: Array  # (n, 3)
    normals: Array  # (n, 3), out of the material
    triangles: Array  # (m, 3)
    deviation: float  # m, the largest distance that was found


def face_mesh(face: Feature, size: float, allowed: float) -> FaceMesh:
    """A face, in the axes of its surface.

    Args:
        face: a feature of dimension 2.
        size: how far unbounded coordinates reach from the origin of the composite, m.
        allowed: largest distance between triangles and face, m. A face that needs more than 256 cells along
            a coordinate gets these.
    """
    points = _points(face.shape)
    conditions = [each for each in (_value_of(c, points) for c in face.conditions) if each is not None]
    reach = size + hypot(*face.shape.pose.position)  # in the axes of the surface
    whole = domain_within(face.shape, reach)
    first = 1 if face.shape.kind == "plane" and not conditions else FIRST
    lines = [np.linspace(*ends, first + 1) for ends in _extent(whole, conditions)]
    while True:
        wrong, deviation = _chords(points, lines, allowed)
        uv, triangles = _grid(lines)
        borders: list[Border] = []
        for condition in conditions:
            uv, triangles, border = cut(uv, triangles, condition)
            borders.append(border)
        far, off = _border_cells(points, lines, borders, allowed)
        finer = [_split(line, a | b) for line, a, b in zip(lines, wrong, far, strict=True)]
        if all(len(new) == len(old) for new, old in zip(finer, lines, strict=True)):
            break
        lines = finer
    return _with_normals(points, uv, triangles, max(deviation, off))


def _with_normals(points: Points, uv: Array, triangles: Array, deviation: float) -> FaceMesh:
    used, places = np.unique(triangles, return_inverse=True)
    triangles = places.reshape(-1, 3)
    vertices, areas = points(uv[used])
    corners = vertices[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(areas, axis=1, keepdims=True)
    normals = areas / np.where(sizes > 0, sizes, 1.0)
    singular = np.flatnonzero(sizes[:, 0] <= SINGULAR * sizes.max(initial=0.0))
    normals[singular] = _mean_normals(flat, normals, triangles, singular)
    outward = (flat * normals[triangles].sum(axis=1)).sum(axis=1) >= 0
    triangles[~outward] = triangles[~outward][:, ::-1]
    areas_of_triangles = np.linalg.norm(flat, axis=1)
    some = areas_of_triangles > SINGULAR * areas_of_triangles.max(initial=0.0)
    return FaceMesh(vertices, normals, triangles[some], deviation)


def _mean_normals(flat: Array, normals: Array, triangles: Array, which: Array) -> Array:
    """Normals of vertices at which the chart is singular: from their triangles, on the neighbours' side."""
    found = np.zeros((len(which), 3))
    for row, vertex in enumerate(which):
        mine = np.flatnonzero((triangles == vertex).any(axis=1))
        beside = normals[triangles[mine].ravel()].sum(axis=0)
        total = (flat[mine] * np.sign(flat[mine] @ beside)[:, None]).sum(axis=0)
        found[row] = total / (np.linalg.norm(total) or 1.0)
    return found


def _points(shape: Shape) -> Points:
    """Points and areas of a surface in its own axes; the areas point out of the material."""
    names = tuple(name for name, _ in shape.parameters)
    function, numbers = _function(shape.kind, shape.chart, names), [value for _, value in shape.parameters]
    sign = exterior_sign(shape)

    def points(uv: Array) -> tuple[Array, Array]:
        if not len(uv):
            return np.zeros((0, 3)), np.zeros((0, 3))
        found, areas = function(uv.T, ca.DM(numbers))
        return np.asarray(found).T, sign * np.asarray(areas).T

    return points


@lru_cache(maxsize=64)
def _function(kind: str, chart: Chart | None, names: tuple[str, ...]) -> ca.Function:
    at, numbers = ca.SX.sym("uv", 2), ca.SX.sym("p", len(names))
    shape = Shape(kind, tuple((name, 0.0) for name in names), chart=chart)
    jet = surface_of(shape).jet(at, numbers)
    area = cross(jet.first[:, 0], jet.first[:, 1])
    return ca.Function("face", [at, numbers], [ca.densify(jet.x), ca.densify(area)])


def _value_of(condition: Condition, points: Points) -> Condition2 | None:
    """A condition as a function of coordinates; None of one on normals, which cuts no face."""
    numbers = condition.numbers
    if condition.kind == "quadric":
        return lambda uv: np.asarray(quadric(numbers, points(uv)[0]))
    if condition.kind == "parameter":
        index, sign, bound = numbers
        return lambda uv: np.asarray(sign * (uv[:, int(index)] - bound))
    if condition.kind == "disc":
        return lambda uv: np.asarray(numbers[0] ** 2 - (uv**2).sum(axis=1))
    return None


def _extent(whole: Ends, conditions: Sequence[Condition2]) -> Ends:
    """A part of the coordinates outside of which the conditions do not hold; a face that is small against its
    coordinates is found where the conditions come nearest to holding."""
    ends = whole
    for _ in range(ZOOMS if conditions else 0):
        lines = [np.linspace(*each, SOUGHT) for each in ends]
        uv = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        near = [_nearness(condition(uv).reshape(SOUGHT, SOUGHT)) for condition in conditions]
        least = np.min(near, axis=0).ravel()
        inside = uv[least >= -1] if (least >= -1).any() else uv[[int(np.argmax(least))]]
        room = np.array([line[1] - line[0] for line in lines])
        low = np.maximum(inside.min(axis=0) - room, [each[0] for each in ends])
        high = np.minimum(inside.max(axis=0) + room, [each[1] for each in ends])
        before = np.array([each[1] - each[0] for each in ends])
        ends = tuple(zip(low.tolist(), high.tolist(), strict=True))
        if (high - low > 0.5 * before).all():
            break
    return ends


def _nearness(values: Array) -> Array:
    """Values of a condition on a grid, in units of their change over a cell: from -1 on it may hold in one of
    the cells that meet there."""
    change = np.zeros_like(values)
    for axis in (0, 1):
        step = np.abs(np.diff(values, axis=axis))
        ends = np.zeros_like(np.take(values, [0], axis=axis))
        before, after = np.concatenate([ends, step], axis), np.concatenate([step, ends], axis)
        change += np.maximum(before, after)
    return values / np.where(change > 0, change, np.abs(values).max() or 1.0)


def _grid(lines: Sequence[Array]) -> tuple[Array, Array]:
    """Coordinates (n, 2) of a grid, and its triangles."""
    uv = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(uv)).reshape(len(lines[0]), len(lines[1]))
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, c), (a, c, d))])
    return uv, triangles


def _chords(points: Points, lines: Sequence[Array], allowed: float) -> tuple[tuple[Array, Array], float]:
    """Which intervals of u and v are too long, and the largest distance that is found."""

    def at(u: Array, v: Array) -> Array:
        uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        return points(uv)[0].reshape(len(u), len(v), 3)

    u, v = lines
    x = at(u, v)
    along_u: Array = np.zeros(len(u) - 1)
    along_v: Array = np.zeros(len(v) - 1)
    diagonal = np.zeros((len(u) - 1, len(v) - 1))
    for s in PROBED:
        u_mid, v_mid = u[:-1] + s * np.diff(u), v[:-1] + s * np.diff(v)
        off_u = np.linalg.norm(at(u_mid, v) - x[:-1] - s * (x[1:] - x[:-1]), axis=-1)
        off_v = np.linalg.norm(at(u, v_mid) - x[:, :-1] - s * (x[:, 1:] - x[:, :-1]), axis=-1)
        along_u = np.maximum(along_u, off_u.max(axis=1))
        along_v = np.maximum(along_v, off_v.max(axis=0))
        chord = x[:-1, :-1] + s * (x[1:, 1:] - x[:-1, :-1])
        diagonal = np.maximum(diagonal, np.linalg.norm(at(u_mid, v_mid) - chord, axis=-1))
    far = diagonal > allowed
    far_u: Array = np.any(far, axis=1)
    far_v: Array = np.any(far, axis=0)
    wrong_u = (along_u > ALONE * allowed) | (far_u & (along_u > 0))
    wrong_v = (along_v > ALONE * allowed) | (far_v & (along_v > 0))
    if not (wrong_u.any() or wrong_v.any()):  # the surface is twisted, its coordinate lines are straight
        wrong_u, wrong_v = far_u, far_v
    return (wrong_u, wrong_v), float(max(diagonal.max(), along_u.max(), along_v.max()))


def _border_cells(
    points: Points, lines: Sequence[Array], borders: Sequence[Border], allowed: float
) -> tuple[tuple[Array, Array], float]:
    """The intervals in which the border of the face bulges too far from its chord, and how far it does."""
    far = tuple(np.zeros(len(line) - 1, dtype=bool) for line in lines)
    largest = 0.0
    for border in borders:
        if not len(border.middles):
            continue
        off = np.linalg.norm(points(border.nearest)[0] - points(border.middles)[0], axis=1)
        largest = max(largest, float(off.max()))
        for axis, line in enumerate(lines):
            cell = np.clip(np.searchsorted(line, border.middles[:, axis]) - 1, 0, len(line) - 2)
            far[axis][cell[off > allowed]] = True
    return (far[0], far[1]), largest


def _split(line: Array, which: Array) -> Array:
    """The ends of intervals, with those named halved, if there is room for all of them."""
    if len(line) - 1 + which.sum() > MOST:
        return line
    middles = (line[:-1] + line[1:])[which] / 2
    return np.sort(np.concatenate([line, middles]))
