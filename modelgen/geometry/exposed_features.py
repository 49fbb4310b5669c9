"""The features of a shape that are features of its union with others: what lies in their material, or flush
with it, is none.

At a point of several solids the union has the outward normals that all of them have there. So an edge ends
where its range of normals shrinks to one, as at the seam of two level plates, or to none. What is no feature
of the union stays in the list, since it bounds the shape, with a condition that no normal fulfils.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modelgen.geometry.composites.convex_pieces import is_convex_polygon
from modelgen.geometry.composites.feature_constructors import at_least, at_most, linear
from modelgen.geometry.convex_cells import Cell, ends_of, highest, is_bounded, range_of
from modelgen.geometry.face_regions import is_linear, polygon_of
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Condition, Feature

Array = np.ndarray[Any, np.dtype[np.float64]]

SAME = 1e-9  # sine of an angle between normals that are one
SHARES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the way from one normal of an edge to the other
LEAST = 4.0  # tolerances, length of a part that is left
NEVER = Condition("tip", (0.0, 0.0, 0.0, 1.0), None)  # of the normal, which no normal fulfils


@dataclass(frozen=True, slots=True)
class Beside:
    """A convex piece of the material beside a shape.

    If it comes first, the shape is moved to its level where a flat face is flush with one of it, and that
    face is covered there.
    """

    cell: Cell
    is_first: bool


def exposed(features: Sequence[Feature], beside: Sequence[Beside], flush: float) -> tuple[Feature, ...]:
    """The features, or parts of them, that are left beside other solids.

    Args:
        features: of the shape, in its axes.
        beside: the convex pieces of the others, in the same axes.
        flush: m, distance from a surface of what counts as lying in it.

    Returns:
        The same objects where the shape is not moved and nothing of a feature is covered.
    """
    off = _off_level(features, [each.cell for each in beside if each.is_first], flush)
    level = [_moved(each, -off) for each in features] if off.any() else features
    others = {each.name: each for each in level}
    parts = [part for each in level for part in _parts(each, beside, others, flush)]
    seen = {each.name for each in parts if NEVER not in each.conditions}
    return tuple(_without(each, seen) for each in parts)


def without_edges(
    features: Sequence[Feature], borders: Container[tuple[str, str, tuple[float, ...]]]
) -> tuple[Feature, ...]:
    """The features without the edges behind borders at which a face goes over into another shape.

    Args:
        features: of the shape, in its axes.
        borders: names of faces, and kinds and numbers of conditions by which they end.

    Returns:
        The same objects where nothing is left out.
    """
    gone = {
        condition.next
        for face in features
        for condition in face.conditions
        if (face.name, condition.kind, condition.numbers) in borders
    }
    named = {each.name for each in features if each.dimension == 1}
    parts = [_hidden(each) if each.name in gone & named else each for each in features]
    seen = {each.name for each in parts if NEVER not in each.conditions}
    return tuple(_without(each, seen) for each in parts)


def is_hidden(feature: Feature) -> bool:
    """Whether a feature only bounds its shape, and nothing touches it."""
    return NEVER in feature.conditions


def _hidden(feature: Feature) -> Feature:
    return replace(feature, conditions=(*feature.conditions, NEVER))


def _off_level(features: Sequence[Feature], cells: Sequence[Cell], flush: float) -> Array:
    """(3,) m: the least vector by which flat faces lie off the first cell that has a face flush with each."""
    found = []
    for face in features:
        if face.dimension == 2 and face.shape.kind == "plane":
            beside = (height for cell in cells for height in _heights_beside(cell, face)[:1])
            height = next((each for each in beside if abs(each) <= flush), None)
            found += [] if height is None else [(_outward(face), height)]
    if not any(height for _, height in found):
        return np.zeros(3)
    normals, heights = (np.array(each) for each in zip(*found, strict=True))
    return np.asarray(np.linalg.lstsq(normals, heights, rcond=SAME)[0])


def _moved(feature: Feature, by: Array) -> Feature:
    shape = feature.shape
    if feature.dimension == 0:
        moved = zip(shape.parameters, by, strict=True)
        at = tuple((name, value + float(step)) for (name, value), step in moved)
        return replace(feature, shape=replace(shape, parameters=at))
    x, y, z = map(float, np.array(shape.pose.position) + by)
    return replace(feature, shape=replace(shape, pose=replace(shape.pose, position=(x, y, z))))


def _without(feature: Feature, names: set[str]) -> Feature:
    """The feature with nothing behind its borders to features that are hidden."""
    if all(each.next is None or each.next in names for each in feature.conditions):
        return feature
    conditions = tuple(
        each if each.next is None or each.next in names else replace(each, next=None)
        for each in feature.conditions
    )
    return replace(feature, conditions=conditions)


def _parts(
    feature: Feature, beside: Sequence[Beside], others: dict[str, Feature], flush: float
) -> Iterator[Feature]:
    """The feature, or its parts, of which some may be hidden."""
    cells = [each.cell for each in beside]
    if feature.shape.kind == "edge" and is_bounded(feature):
        yield from _parts_of_edge(feature, cells, flush)
    elif feature.shape.kind == "plane" and feature.conditions and all(map(is_linear, feature.conditions)):
        yield from _parts_of_face(feature, beside, flush)
    elif feature.dimension == 0:
        yield _hidden(feature) if any(_covers_vertex(cell, feature, flush) for cell in cells) else feature
    else:
        is_within = any(_is_within(each, feature, others, flush) for each in beside)
        yield _hidden(feature) if is_within else feature


def _is_within(beside: Beside, feature: Feature, others: dict[str, Feature], flush: float) -> bool:
    bound = highest(feature, beside.cell, others)
    if bound is None or bound.max() > flush:
        return False
    is_flat = feature.dimension == 2 and feature.shape.kind == "plane"
    return beside.is_first or not (is_flat and _shares_plane(beside.cell, feature, flush))


def _outward(feature: Feature) -> Array:
    normal = rotation_of(feature.shape.pose.quaternion)[:, 2]
    return np.asarray(-normal if feature.shape.cavity else normal)


def _heights_beside(cell: Cell, face: Feature) -> Array:
    """(k,) m: how far a flat face is outside of the planes of a cell that have the same side outward."""
    heights = cell.heights(np.array(face.shape.pose.position))
    return np.asarray(heights[cell.normals @ _outward(face) > 1 - SAME])


def _shares_plane(cell: Cell, face: Feature, flush: float) -> bool:
    """Whether a flat face lies in a face of the cell, with the same side outward."""
    return bool((np.abs(_heights_beside(cell, face)) <= flush).any())


def _active(cell: Cell, x: Array, flush: float) -> Array:
    """(k, 3) the normals of the planes of a cell in which a point of it lies."""
    return np.asarray(cell.normals[np.abs(cell.heights(x)) <= flush])


def _is_in_cone(normals: Array, n: Array) -> bool:
    from scipy.optimize import nnls  # slow to import

    return bool(len(normals) and nnls(normals.T, n)[1] <= 1e-6)


def _covers_vertex(cell: Cell, vertex: Feature, flush: float) -> bool:
    at = np.array([value for _, value in vertex.shape.parameters])
    if cell.heights(at).max() > flush:
        return False
    edges = [each.numbers for each in vertex.conditions if each.kind == "direction"]
    if not edges:
        return False
    mean = -np.sum(edges, axis=0)
    return not _is_in_cone(_active(cell, at, flush), mean / np.linalg.norm(mean))


def _normals_of_edge(edge: Feature) -> tuple[Array, Array] | None:
    """The outward normals of both faces beside an edge; None where it has not two."""
    R = rotation_of(edge.shape.pose.quaternion)
    T, z = R[:, 0], R[:, 2]
    wings = [
        each.numbers[0] * np.cross(T, z) + each.numbers[1] * z
        for each in edge.conditions
        if each.kind == "wing"
    ]
    if len(wings) != 2:
        return None
    found = []
    for mine, other in (wings, wings[::-1]):
        n = np.cross(T, mine)
        found.append(n * (-1.0 if n @ other > 0 else 1.0) / np.linalg.norm(n))
    return found[0], found[1]


def _parts_of_edge(edge: Feature, cells: Sequence[Cell], flush: float) -> Iterator[Feature]:
    start, end = range_of(edge)
    a, b = ends_of(edge)
    normals = _normals_of_edge(edge)
    left = [(start, end)]
    for cell in cells:
        within = _clipped(cell, (a, b), flush)
        if within is None or normals is None:
            continue
        low, high = (float(start + share * (end - start)) for share in within)
        if high - low <= LEAST * flush or _shares_edge(cell, (a, b), within, normals, flush):
            continue
        left = [part for each in left for part in _less(each, (low, high), LEAST * flush)]
    if left == [(start, end)]:
        yield edge
        return
    if not left:
        yield _hidden(edge)
        return
    for k, (low, high) in enumerate(sorted(left, key=lambda each: each[0] - each[1])):
        yield _cut(edge, low, high, (low > start, high < end), "" if k == 0 else f".{k + 1}")


def _clipped(cell: Cell, ends: tuple[Array, Array], flush: float) -> tuple[float, float] | None:
    """The shares of the way from one end of an edge to the other between which it is in a cell.

    An edge in a plane of the cell, within `flush`, is on its inner side. One that crosses the plane ends
    exactly there, as faces do, since what slides on the plane may touch it at that end alone.
    """
    low, high = 0.0, 1.0
    slight = SAME * np.linalg.norm(ends[1] - ends[0])
    for first, last in zip(cell.heights(ends[0]), cell.heights(ends[1]), strict=True):
        allowed = flush if abs(last - first) <= slight else 0.0
        if first > allowed and last > allowed:
            return None
        if allowed == 0.0 and (first > 0 or last > 0):
            cut = first / (first - last)
            low, high = (max(low, cut), high) if first > 0 else (low, min(high, cut))
    return (low, high) if low < high else None


def _shares_edge(
    cell: Cell,
    ends: tuple[Array, Array],
    within: tuple[float, float],
    normals: tuple[Array, Array],
    flush: float,
) -> bool:
    """Whether the cell has an edge there too, with a range of normals in common."""
    middle = ends[0] + sum(within) / 2 * (ends[1] - ends[0])
    active = _active(cell, middle, flush)
    return len(active) > 1 and any(
        _is_in_cone(active, (1 - share) * normals[0] + share * normals[1]) for share in SHARES
    )


def _less(a: tuple[float, float], b: tuple[float, float], least: float) -> Iterator[tuple[float, float]]:
    """The parts of one interval outside of another that are not short."""
    yield from (
        part for part in ((a[0], min(a[1], b[0])), (max(a[0], b[1]), a[1])) if part[1] - part[0] > least
    )


def _cut(edge: Feature, low: float, high: float, is_new: tuple[bool, bool], tail: str) -> Feature:
    """The part of an edge; nothing is behind its new ends."""
    kept = [
        each
        for each in edge.conditions
        if each.kind != "parameter" or not is_new[0 if each.numbers[1] > 0 else 1]
    ]
    if is_new[0]:
        kept.append(at_least(0, low, None))
    if is_new[1]:
        kept.append(at_most(0, high, None))
    return replace(edge, name=edge.name + tail, conditions=tuple(kept))


@dataclass(frozen=True, slots=True)
class _Polygon:
    """A convex part of a flat face in its axes: corners counterclockwise, and the condition of each side."""

    corners: Array  # (n, 2)
    sides: tuple[Condition, ...]  # from each corner to the next

    def split(self, normal: Array, offset: float, flush: float) -> tuple[_Polygon | None, _Polygon | None]:
        """The parts with normal x <= offset and beyond; None in place of slivers."""
        return self._kept(-normal, -offset, flush), self._kept(normal, offset, flush)

    def _kept(self, normal: Array, offset: float, flush: float) -> _Polygon | None:
        """The part with normal x >= offset."""
        height = self.corners @ normal - offset
        size = float(np.ptp(self.corners, axis=0).max())
        points: list[Array] = []
        sides: list[Condition] = []
        new = _line(normal, offset)
        for k, side in enumerate(self.sides):
            after = (k + 1) % len(self.sides)
            a, b = height[k], height[after]
            if a >= 0:
                points.append(self.corners[k])
                sides.append(side)
            if (a >= 0) != (b >= 0):
                points.append(self.corners[k] + a / (a - b) * (self.corners[after] - self.corners[k]))
                sides.append(new if a >= 0 else side)
        if len(points) < 3:
            return None
        found = _Polygon(np.array(points), tuple(sides))
        return found if found.area > max(SAME * size, LEAST * flush) * size else None

    @property
    def area(self) -> float:
        x, y = self.corners.T
        return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def _line(normal: Array, offset: float) -> Condition:
    return linear((*(offset * normal), 0.0), (*normal, 0.0), None)


def _polygon_of(face: Feature) -> _Polygon | None:
    """The polygon of a face by its half-planes; None where they do not bound one."""
    found = polygon_of(face.conditions)
    if found is None or len(found[1]) < 3 or not is_convex_polygon(found[1]):
        return None
    return _Polygon(found[1], tuple(found[0]))


def _parts_of_face(face: Feature, beside: Sequence[Beside], flush: float) -> Iterator[Feature]:
    whole = _polygon_of(face)
    if whole is None:
        yield face
        return
    left, hidden = [whole], []
    for each in beside:
        is_level = _shares_plane(each.cell, face, flush) and not each.is_first
        lines = None if is_level else _lines_in(face, each.cell, flush)
        if lines is not None:
            split = [_split(part, lines, flush) for part in left]
            left = [part for outside, _ in split for part in outside]
            hidden += [inside for _, inside in split if inside is not None]
    if not hidden:
        yield face
        return
    parts = [
        replace(face, conditions=tuple(dict.fromkeys(each.sides)))
        for each in sorted(left, key=lambda each: -each.area)
    ]
    parts += [_hidden(replace(face, conditions=tuple(dict.fromkeys(each.sides)))) for each in hidden]
    for k, part in enumerate(parts):
        yield replace(part, name=face.name + (f".{k + 1}" if k else ""))


def _lines_in(face: Feature, cell: Cell, flush: float) -> list[tuple[Array, float]] | None:
    """The half-planes (normal x <= offset) of a face that lie in a cell, in the axes of the face; None where
    the cell does not reach the plane of the face."""
    R = rotation_of(face.shape.pose.quaternion)
    heights, found = cell.heights(np.array(face.shape.pose.position)), []
    for normal, height in zip(cell.normals, heights, strict=True):
        across = normal @ R[:, :2]
        slope = float(np.linalg.norm(across))
        if slope > SAME:
            found.append((across / slope, -float(height) / slope))
        elif height > flush:
            return None
    return found


def _split(
    part: _Polygon, lines: Sequence[tuple[Array, float]], flush: float
) -> tuple[list[_Polygon], _Polygon | None]:
    """The parts of a polygon outside of a convex region, and inside.

    A region that has no border with the polygon in common hides nothing: what touches a point within the
    polygon touches what is around it, too.
    """
    inside: _Polygon | None = part
    outside: list[_Polygon] = []
    for normal, offset in lines:
        if inside is None:
            break
        inside, beyond = inside.split(normal, offset, flush)
        if beyond is not None:
            outside.append(beyond)
    if inside is None or not any(_runs_along(inside, side, flush) for side in part.sides):
        return [part], None
    return outside, inside


def _runs_along(part: _Polygon, side: Condition, flush: float) -> bool:
    """Whether a stretch of the border of a polygon lies on the line of a side."""
    height = side.numbers[0] + part.corners @ np.array(side.numbers[1:3])
    on = part.corners[np.abs(height) <= flush]
    return len(on) > 1 and bool(np.ptp(on, axis=0).max() > LEAST * flush)
