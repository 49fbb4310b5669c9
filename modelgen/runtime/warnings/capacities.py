"""Warnings about capacities of the core that a run exceeded: which, when first, and what to do."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import CAPACITIES
from modelgen.runtime.tables.scratch_memory import gibibytes

LARGE = "make the shapes simpler, or divide them into several"
EXCEEDED: Mapping[str, tuple[str, str]] = {  # by CAPACITIES: what was too much or not found, and the remedy
    "closed": (
        "contacts closed at a time",
        "list fewer pairs in [[contact]], divide the scene, or use a machine with more memory",
    ),
    "stationary": (
        "stationary points of the distance of two circles",
        "move one of the shapes off the axis of the other by more than rounding, or make them coaxial",
    ),
    "left": (
        "closest points that contacts left in one step",
        "shorter steps, by a tighter accuracy or `step`, leave fewer at a time",
    ),
    "segment": ("parts of a surface along a way through a body", LARGE),
    "slot": (
        "planar contacts of two bodies at a time",
        "planar_contacts = false lets faces stand on their corners",
    ),
    "region": ("intersections of the outlines of two faces", LARGE),
    "events": ("events in one step", "shorter steps, by a tighter accuracy, hold fewer"),
    "near": (
        "near pairs of equal bodies",
        "shorter runs, or fewer bodies among [contacts], have fewer",
    ),
    "pressure": (
        "the pressure between two faces that slip",
        "planar_contacts = false lets faces stand on their corners",
    ),
}


def capacity_warnings(session: Session) -> list[str]:
    """A warning for each capacity that the run exceeded."""
    found = []
    for kind, times, first in zip(
        CAPACITIES, session.run.report.exceeded, session.run.report.exceeded_t, strict=True
    ):
        if not times:
            continue
        what, remedy = EXCEEDED[kind]
        room = f" ({_room(session)})" if kind == "closed" else ""
        told = (
            f"there were more {what} than the core has room for{room}, {times} times",
            "what had no room was left out",
        )
        if kind == "pressure":
            told = f"{what} was not found, {times} times", "the pressure tried last was taken"
        found.append(
            f"{told[0]}, first at t = {float(first):.6g} s: {told[1]}, and the motion may be wrong; {remedy}"
        )
    return found


def _room(session: Session) -> str:
    """How many contacts may be closed, and the memory that they take."""
    bytes_ = session.work.nbytes + session.iwork.nbytes
    return f"{session.system.closed_capacity}, which take {gibibytes(bytes_)} of memory"
