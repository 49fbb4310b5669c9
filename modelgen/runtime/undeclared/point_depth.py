"""How deep points lie in the material of a shape: negative inside, positive outside.

Every function g is at most the distance to the surface in size: |g(x) - g(y)| <= |x - y|. Its sign is exact,
but for shapes known by samples only, of which points within the spacing of the samples count as outside.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.tables.shapes import solid_numbers

Array = np.ndarray[Any, np.dtype[np.float64]]
Depth = Callable[[Array], Array]  # (n, 3) m, axes of the body's centre of mass -> (n,) m

LIPSCHITZ = 1  # MG_LIPSCHITZ
AT_ORIGIN = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def depth_of(entry: Mapping[str, Any], library: Library) -> Depth | None:
    """The function g of one shape of the manifest's tables `unlisted` and `open_edges`, in the axes of its
    body's centre of mass; None of what has no material."""
    if entry["thin"]:
        return None
    if entry["kind"] == "terms":
        return _by_terms(solid_numbers(library.manifest.instance["solids"])[entry["solid"]], library)
    inner = _sampled(entry) if entry["kind"] == "sampled" else None
    if inner is None:
        return None
    placement = np.array(entry["placement"])
    p, R = placement[:3], placement[3:].reshape(3, 3, order="F")
    return lambda x: inner((x - p) @ R)  # normals of samples point out of a cavity's material


def points_of(entry: Mapping[str, Any]) -> Array:
    """(n, 3) m: the samples of a shape known by them, in the axes of its body's centre of mass."""
    placement = np.array(entry["placement"])
    points = np.array(entry["points"]).reshape(-1, 3)
    placed: Array = points @ placement[3:].reshape(3, 3, order="F").T + placement[:3]
    return placed


def _by_terms(solid: int, library: Library) -> Depth:
    """By the core, from the terms of a solid and the cavities of its body."""
    tables = library_tables(library)
    dtype = tables.tables.dtype
    pose = np.array(AT_ORIGIN, dtype=dtype)

    def depth(x: Array) -> Array:
        points, found = np.ascontiguousarray(x, dtype=dtype), np.empty(len(x), dtype=dtype)
        at, given, heights = (ctypes.c_void_p(each.ctypes.data) for each in (pose, points, found))
        library.cdll.mg_solid_heights(
            ctypes.byref(tables.system), solid, at, LIPSCHITZ, len(x), given, heights
        )
        return found.astype(float)

    return depth


def _sampled(entry: Mapping[str, Any]) -> Depth | None:
    """By the nearest sample and its normal; where that is at the end of a surface, points are outside."""
    from scipy.spatial import KDTree

    points, normals = (np.array(entry[key]).reshape(-1, 3) for key in ("points", "normals"))
    if not len(normals):
        return None
    tree, spacing = KDTree(points), float(entry["parameters"][0])
    is_end = np.abs(normals).max(axis=1) == 0

    def depth(x: Array) -> Array:
        distance, nearest = tree.query(x)
        is_inside = (((x - points[nearest]) * normals[nearest]).sum(axis=1) < 0) & ~is_end[nearest]
        return np.asarray(np.where(is_inside, -distance, distance) + spacing)

    return depth
