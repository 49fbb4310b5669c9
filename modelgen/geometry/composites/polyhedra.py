"""Convex bodies with flat faces: the box, and the hull of given points."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from modelgen.errors import SceneError
from modelgen.geometry.composites.facets import Facets, facet_features
from modelgen.scene.scene_types import Composite, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

# Against the size of the body: the distance of points that are one, and from the plane of a face of points
# that lie in it. Tried in this order until the faces close up.
COPLANAR = (1e-9, 1e-11, 1e-13, 1e-7, 1e-5)

_BOX_NAMES = (("left", "right"), ("front", "back"), ("bottom", "top"))  # at -x, +x; -y, +y; -z, +z
_BOX_ORDER = (2, 1, 0)  # of the axes in the names of edges and vertices: top_back_right


def box(shape: Shape) -> Composite:
    """A box centred at the origin; parameters x, y, z: its edges."""
    return Composite(facet_features(box_facets(shape)), convex=True)


def polyhedron(shape: Shape) -> Composite:
    """The convex hull of points; parameters x0, y0, z0, x1, ..."""
    return Composite(facet_features(polyhedron_facets(shape)), convex=True)


def box_facets(shape: Shape) -> Facets:
    """Point 4 i + 2 j + k stands at -x or +x for i = 0, 1, and so on."""
    half = np.array([value for _, value in shape.parameters]) / 2
    signs = [np.array([k >> 2 & 1, k >> 1 & 1, k & 1]) for k in range(8)]
    points = np.array([(2 * sign - 1) * half for sign in signs])
    loops, faces = [], []
    for axis in range(3):
        a, b = 4 >> (axis + 1) % 3, 4 >> (axis + 2) % 3
        for side in range(2):
            start = side * (4 >> axis)
            loop = (start, start + a, start + a + b, start + b)
            loops.append(loop if side else loop[::-1])
            faces.append(_BOX_NAMES[axis][side])
    names = [tuple(_BOX_NAMES[axis][sign[axis]] for axis in _BOX_ORDER) for sign in signs]
    edges = {}
    for i in range(8):
        for bit in (1, 2, 4):
            if not i & bit:
                shared = (name for name, other in zip(names[i], names[i + bit], strict=True) if name == other)
                edges[i, i + bit] = "_".join(shared)
    return Facets(points, tuple(loops), tuple(faces), edges, tuple("_".join(name) for name in names))


def polyhedron_facets(shape: Shape) -> Facets:
    """Faces f0, f1, ...; edges e<i>_<j> and vertices v<i> by the number of the point as written."""
    points = np.array([value for _, value in shape.parameters]).reshape(-1, 3)
    loops = _hull_loops(points, shape.name)
    edges = {
        (min(ends), max(ends)): f"e{min(ends)}_{max(ends)}"
        for loop in loops
        for ends in pairwise((*loop, loop[0]))
    }
    names = tuple(f"v{index}" for index in range(len(points)))
    return Facets(points, loops, tuple(f"f{index}" for index in range(len(loops))), edges, names)


def _hull_loops(points: Array, name: str) -> tuple[tuple[int, ...], ...]:
    """The faces of the convex hull, triangles of one plane merged, each from its lowest point on."""
    from scipy.spatial import ConvexHull

    size = float(np.ptp(points, axis=0).max())
    for share in COPLANAR:
        kept = _apart(points, share * size)
        hull = ConvexHull(points[kept])
        loops = _merged(points, kept[hull.simplices], hull.equations, share * size)
        if _closed(loops):
            return loops
    raise SceneError(
        f"shape {name!r}", "vertices that lie nearly, but not quite, in common planes",
        "faces are flat or meet at an angle", "write more digits, or move them apart",
    )  # fmt: skip


def _apart(points: Array, reach: float) -> Array:
    """Numbers of the points that are no nearer than `reach` m to one before them."""
    from scipy.spatial import cKDTree

    merged = {second for _, second in cKDTree(points).query_pairs(reach)}
    return np.array([index for index in range(len(points)) if index not in merged])


def _merged(points: Array, triangles: Array, planes: Array, reach: float) -> tuple[tuple[int, ...], ...]:
    """Loops of the triangles (n,3), those within `reach` m of the plane of a larger one merged with it."""
    areas = [_area(points[triangle]) for triangle in triangles]
    free = set(range(len(areas)))
    flat: list[tuple[Array, set[int]]] = []
    for index in sorted(free, key=lambda k: -areas[k]):
        if index in free:
            heights = np.abs(points[triangles] @ planes[index, :3] + planes[index, 3]).max(axis=1)
            merged = {k for k in free if heights[k] <= reach}
            free -= merged
            flat.append((planes[index, :3], {int(at) for k in merged for at in triangles[k]}))
    corners = {at for _, face in flat for at in face if sum(at in other for _, other in flat) > 2}
    return tuple(
        sorted(
            _loop(points, normal, sorted(face & corners)) for normal, face in flat if len(face & corners) > 2
        )
    )


def _closed(loops: tuple[tuple[int, ...], ...]) -> bool:
    """Whether every side is passed once each way, and Euler's formula holds."""
    sides = [ends for loop in loops for ends in pairwise((*loop, loop[0]))]
    corners = {at for loop in loops for at in loop}
    paired = len(set(sides)) == len(sides) and all((j, i) in sides for i, j in sides)
    return paired and len(corners) - len(sides) // 2 + len(loops) == 2


def _loop(points: Array, normal: Array, face: list[int]) -> tuple[int, ...]:
    """The corners of a convex face counterclockwise about its normal."""
    centre = points[face].mean(axis=0)
    first = points[face[0]] - centre
    second = np.cross(normal, first)
    arms = points[face] - centre
    angles = np.arctan2(arms @ second, arms @ first) % (2 * np.pi)
    angles[0] = 0.0
    return tuple(face[k] for k in np.argsort(angles))


def _area(triangle: Array) -> float:
    return float(np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])))
