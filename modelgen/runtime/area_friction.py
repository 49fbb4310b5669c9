"""Coulomb friction between two planar regions that lie on each other (described in `runtime.planar_regions`).

The pressure is max(0, a + b.x) with the given resultant and centre: a foundation of springs that do not pull
(Winkler 1867; Johnson, Contact Mechanics, 1985, 4.3). It is affine while the centre lies in the kern of the
region and crowds towards the edge of the hull as the centre nears that. Friction acts against the slip of
every point; the limit surface bounds what it can hold (Goyal, Ruina, Papadopoulos, Wear 143 (1991), 307).
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.region_overlap import FINE, IDENTITY, Arc, Core, query_of
from modelgen.runtime.tables.ctypes_structures import Array, address, structure


@dataclass(frozen=True, slots=True)
class AreaFriction:
    """Friction of m loads and motions; NaN where the centre of pressure is not inside the hull."""

    pressure: Array  # (m, 3) at the centre, Pa, and its slope, Pa/m; it is 0 where this says less
    friction: Array  # (m, 3) force, N, and torque about the centre, N m, on f, for a coefficient of 1
    needed: Array  # (m,) the coefficient that it takes to hold the wrench
    limiting: Array  # (m, 3) the twist that asks for this coefficient: m/s and rad/s, up to a factor


def area_friction(
    core: Core,
    o: Sequence[Arc],
    f: Sequence[Arc],
    load: Array,
    twist: Array,
    *,
    wrench: Array | None = None,
    pose: Array = IDENTITY,
) -> AreaFriction:
    """Friction on region f, which slides on region o.

    Args:
        core: a library whose set of kinds holds the curves.
        o: arcs that bound A, or none for the whole plane.
        f: arcs that bound B, in the axes of f's face.
        load: (m, 3) resultant, N, and the centre of pressure, m, in the axes of o's face.
        twist: (m, 3) of f past o: velocity at the centre of pressure, m/s, and spin, rad/s.
        wrench: (m, 3) force, N, and torque about the centre, N m, that friction is to hold; else 0.
        pose: (12,) of f's face in the axes of o's: position, m, and rotation column by column.

    Raises:
        SimulationError: no region f, or boundaries that cross too often.
    """
    if not f:
        raise SimulationError(
            "area_friction", "no arcs for the region of f", "one or more", "give its boundary"
        )
    given = [np.array(x, dtype=core.dtype).reshape(-1, 3) for x in (load, twist)]
    given.append(np.zeros_like(given[0]) if wrench is None else np.array(wrench, dtype=core.dtype))
    m = len(given[0])
    found = np.zeros(m, dtype=np.intc)
    filled = [np.full(shape, np.nan, dtype=core.dtype) for shape in ((m, 3), (m, 3), (m,), (m, 3))]
    regions, _ = query_of(core, o, f, pose, None, FINE)
    pointers = [address(x) for x in (*given, found, *filled)]
    query = _structure()(ctypes.addressof(regions), m, *pointers)
    core.cdll.mg_region_friction_size.restype = ctypes.c_long
    work = np.empty(core.cdll.mg_region_friction_size(len(o) + len(f), len(o)), dtype=core.dtype)
    if core.cdll.mg_region_friction(ctypes.byref(query), ctypes.c_void_p(address(work))) < 0:
        allowed = "two crossings for each pair of arcs, and some more"
        raise SimulationError("area_friction", "more crossings of the boundaries", allowed, "divide the arcs")
    return AreaFriction(*filled)


@cache
def _structure() -> Any:
    """mg_patch_friction_query (modelgen.h)."""
    names = ("load", "twist", "wrench", "found", "pressure", "friction", "friction_needed", "limiting_twist")
    fields: list[tuple[str, Any]] = [("regions", ctypes.c_void_p), ("n", ctypes.c_int)]
    return structure("PatchFrictionQuery", fields + [(name, ctypes.c_void_p) for name in names])
