"""Two planar regions: their intersection, its convex hull, and the depth of points inside it.

The regions lie in one plane: A on the face of body o, or the whole plane; B on the face of body f, which
looks against o's. Boundaries are arcs of the plane curves of a library's set of kinds. All results are in the
axes of o's face.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol

import numpy as np

from modelgen.codegen.library import kernel_table
from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import SHARED
from modelgen.runtime.tables.ctypes_structures import KERNELS, Array, address, structure, tables_of

FINE = 8  # points of an outline to each part of a curve that turns by less than 0.3 rad
IDENTITY = np.array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], dtype=float)


class Core(Protocol):
    """A compiled core, alone or in a library."""

    @property
    def cdll(self) -> ctypes.CDLL: ...

    @property
    def dtype(self) -> Any: ...


@dataclass(frozen=True, slots=True)
class Arc:
    """A piece of a region's boundary. The arcs of a loop follow each other and run end to start."""

    shape: int  # index of the curve's kind in the set of kinds
    parameters: Sequence[float]  # of the curve, as the kind orders them
    ends: tuple[float, float]  # first and last parameter of the curve
    placement: Sequence[float] = tuple(IDENTITY)  # (12,) position and rotation, in the axes of the face
    loop: int = 0


@dataclass(frozen=True, slots=True)
class Overlap:
    """The intersection of two regions, its hull, and the position of m points relative to the hull."""

    outline: tuple[Array, ...]  # each (n, 2) m: closed curves that bound the intersection
    hull: Array  # (n, 2) m: the boundary of its convex hull, anticlockwise, curves sampled
    sides: int  # of the hull: 0 where there is no intersection, 1 for a point, 2 for a segment
    margin: Array  # (m,) m: signed distance to the hull's boundary, positive inside; -inf without a hull
    normal: Array  # (m, 2) outward unit normal of the hull where it is nearest
    supports: Array  # (m,) what is nearest: 1 a point of the boundary, 2 a straight side, 0 nothing
    identity: Array  # (m, 2, 3) per support: its boundary (0 o, 1 f), arc, arc of the other boundary or -1
    support_position: Array  # (m, 2, 4) per support: parameters on those two arcs, then the point, m


def overlap(
    core: Core,
    o: Sequence[Arc],
    f: Sequence[Arc],
    pose: Array = IDENTITY,
    points: Array | None = None,
    *,
    fine: int = FINE,
) -> Overlap:
    """Intersects two regions, given as the module describes.

    Args:
        core: a library whose set of kinds holds the curves.
        o: arcs that bound A, or none for the whole plane.
        f: arcs that bound B, in the axes of f's face; numbered on from those of o in the result.
        pose: (12,) of f's face in the axes of o's: position, m, and rotation column by column; flattened.
        points: (m, 2) m, in the axes of o's face.
        fine: points of an outline to each part of a curve that turns by less than 0.3 rad.

    Raises:
        SimulationError: no region f, or boundaries that cross too often.
    """
    if not f:
        raise SimulationError("overlap", "no arcs for the region of f", "one or more", "give its boundary")
    query, found = query_of(core, o, f, pose, points, fine)
    core.cdll.mg_region_size.restype = ctypes.c_long
    work = np.empty(core.cdll.mg_region_size(len(o) + len(f), len(o)), dtype=core.dtype)
    sides = core.cdll.mg_region(ctypes.byref(query), ctypes.c_void_p(address(work)))
    if sides < 0:
        allowed = "two crossings for each pair of arcs, and some more"
        raise SimulationError("overlap", "more crossings of the boundaries", allowed, "divide the arcs")
    loops, hull = (_points(core.dtype, query, work, core, name) for name in ("outline", "hull"))
    found["margin"][found["margin"] <= -np.finfo(core.dtype).max] = -np.inf
    return Overlap(outline=loops, hull=hull[0] if hull else np.zeros((0, 2)), sides=sides, **found)


def query_of(
    core: Core, o: Sequence[Arc], f: Sequence[Arc], pose: Array, points: Array | None, fine: int
) -> tuple[Any, dict[str, Array]]:
    """The mg_region_query without space for outlines, and the arrays of its results."""
    real: Any = core.dtype
    arcs = [*o, *f]
    lengths = [len(arc.parameters) for arc in arcs]
    x = np.array(points if points is not None else np.zeros((0, 2)), dtype=real, order="C").reshape(-1, 2)
    given = {
        "shape": np.array([arc.shape for arc in arcs], dtype=np.intc),
        "loop": np.array([arc.loop for arc in arcs], dtype=np.intc),
        "first": np.cumsum([0, *lengths[:-1]]).astype(np.intc),
        "parameters": np.array([x for arc in arcs for x in arc.parameters] or [0], dtype=real),
        "numbers": np.array([[*arc.placement, *arc.ends] for arc in arcs], dtype=real),
        "pose": np.array(pose, dtype=real),
        "points": x,
    }
    found = {
        "margin": np.zeros(len(x), dtype=real),
        "normal": np.zeros((len(x), 2), dtype=real),
        "supports": np.zeros(len(x), dtype=np.intc),
        "identity": np.zeros((len(x), 2, 3), dtype=np.intc),
        "support_position": np.zeros((len(x), 2, 4), dtype=real),
    }
    outline, regions = _structures(np.dtype(real))
    outlines = {"outline": outline(), "hull": outline()}
    query = regions(
        kernels=kernel_table(core.cdll), n_arc=len(arcs), n_o=len(o), points_per_turn=fine, n_point=len(x)
    )
    query.kept = [given, found, outlines]
    for name, array in (given | found).items():
        setattr(query, name, address(array))
    for name, outline in outlines.items():
        setattr(query, name, ctypes.addressof(outline))
    query.coincidence = SHARED * float(np.finfo(real).eps) * _size(arcs, given["pose"])
    return query, found


@cache
def _structures(real: np.dtype[Any]) -> tuple[Any, Any]:
    """mg_outline and mg_region_query (modelgen.h)."""
    integers = ("n_arc", "n_o", "points_per_turn", "n_point")
    given = ("shape", "loop", "first", "parameters", "numbers", "pose")
    found = ("points", "margin", "normal", "supports", "identity", "support_position", "outline", "hull")
    fields: list[tuple[str, Any]] = [(KERNELS, ctypes.c_void_p)]
    fields += [(name, ctypes.c_int) for name in integers]
    fields += [(name, ctypes.c_void_p) for name in given] + [("coincidence", tables_of(real).real)]
    fields += [(name, ctypes.c_void_p) for name in found]
    counts: list[tuple[str, Any]] = [(name, ctypes.c_int) for name in ("capacity", "count", "n_loop")]
    return (
        structure("Outline", [*counts, ("point", ctypes.c_void_p), ("loop", ctypes.c_void_p)]),
        structure("RegionQuery", fields),
    )


def _size(arcs: Sequence[Arc], pose: Array) -> float:
    """A bound on the coordinates of both regions, m."""
    reach = [np.abs(arc.placement[:3]).max() + max(map(abs, arc.parameters), default=0) for arc in arcs]
    straight = [max(map(abs, arc.ends)) for arc in arcs if not arc.parameters]
    return float(max([*reach, *straight]) + np.abs(pose[:3]).max())


def _points(real: Any, query: Any, work: Array, core: Core, name: str) -> tuple[Array, ...]:
    """The loops of an outline, from a second call with space for its points."""
    outline = query.kept[2][name]
    point, loop = np.zeros((outline.count, 2), dtype=real), np.zeros(outline.count, dtype=np.intc)
    outline.capacity, outline.point, outline.loop = outline.count, address(point), address(loop)
    core.cdll.mg_region(ctypes.byref(query), ctypes.c_void_p(address(work)))
    outline.capacity = 0
    return tuple(point[loop == i] for i in range(outline.n_loop))
