"""All local minima of the distance of two bodies at many poses, by a search that misses none.

Nothing is needed to start from: the core bounds the shapes over cells of their coordinates and drops only
cells that cannot hold a minimum (design_notes in the manual). Bodies of several pieces, edges and vertices
are searched at once, in the pairs that can touch in one point: two vertices, or a vertex and an edge, are
none. A minimum with d < 0 is a penetration, or belongs to sides that face away from each other, as those of
two links: then -d is at least the width of both. A `depth` less than that leaves those out.

>>> import numpy as np
>>> from modelgen import build, derive, distance_minima, emit, require
>>> from modelgen.scene.read import read_text
>>> links = '''
... run = { until = 1.0 }
... body = [
...   { name = "a", density = 1.0, shape = { kind = "torus", major = 2.0, minor = 0.5 } },
...   { name = "b", density = 1.0, shape = { kind = "torus", major = 2.0, minor = 0.5 } },
... ]
... contact = [{ between = ["a", "b"] }]
... '''
>>> library = build(emit(derive(require(read_text(links, "links.toml")))))
>>> upright = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
>>> here, across = np.eye(3, 4), np.column_stack([upright, [2.2, 0, 0]])
>>> found = distance_minima(library, "a-b", here, across, depth=1.0)
>>> found.d.round(12), found.complete
(array([0.8]), array([ True]))
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.name_suggestions import listed, nearest
from modelgen.notation import ETA_SIZE
from modelgen.rotations import ROUNDING
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import common_rows, is_number, shown
from modelgen.runtime.core_session import Session
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.poses import pose_rows
from modelgen.runtime.tables.ctypes_structures import MINIMA, MINIMA_FOUND, MINIMA_GIVEN, Array, address

EFFORT = 10_000_000  # pairs of cells looked at before a search is given up: about two seconds
WORLD_FRAME = np.append(np.zeros(3), np.eye(3))
WIDTHS = {"d": 1, "normal": 3, "point_o": 3, "point_f": 3, "eta": 6, "margin": 2}  # numbers of a minimum


@dataclass(frozen=True, slots=True)
class DistanceMinima:
    """Minima of n pairs of poses, m in all: by row, and in a row by |d|."""

    complete: Array  # (n,) True: the row has no others; False: the search was given up, or 24 were found
    row: Array  # (m,) the pair of poses
    feature_pair: Array  # (m,) index in the manifest's instance
    d: Array  # (m,) m, signed distance: positive apart, negative overlapping
    normal: Array  # (m, 3) world, unit, from o to f
    point_o: Array  # (m, 3) m, world
    point_f: Array  # (m, 3) m, world
    eta: Array  # (m, 6) contact parameters, 0 beyond those of the kind
    margin: Array  # (m, 2) mu and sigma (1/m), the distance from singular contact


@dataclass(frozen=True, slots=True)
class Searched:
    """Feature pairs of one pair of bodies, and the bodies in the order of its name."""

    name: str
    first: int
    end: int
    body_o: int
    body_f: int

    @property
    def is_single(self) -> bool:
        return self.end == self.first + 1


def distance_minima(
    library: Library,
    contact: str,
    pose_o: Array,
    pose_f: Array,
    *,
    gap: float = np.inf,
    depth: float = np.inf,
) -> DistanceMinima:
    """All local minima of the distance of two bodies with -depth <= d <= gap; the module has an example.

    Args:
        library: what `build` returned.
        contact: the names of its bodies, as "a-b", or one pair of their features, as "a-b:rim".
        pose_o: (n, 3, 4) or (3, 4) of body o, [R | p]: rotation body -> world and centre of mass, m. The
            point x of the body is at R @ x + p. That of a body fixed at the world frame is `np.eye(3, 4)`.
        pose_f: the same of body f; a single pose goes with all of the other body.
        gap: m, 0 or more. The smaller, the cheaper the search.
        depth: m, 0 or more.

    Raises:
        SimulationError: no such contact; arrays or bounds that do not fit; rotations that are none; another
            pose of a body that is fixed at the world frame.
    """
    searched = searched_pair(library, contact)
    for name, bound in (("gap", gap), ("depth", depth)):
        if not (is_number(bound) and bound >= 0):
            raise SimulationError(f"distance_minima: {name}", shown(bound), "a length of 0 m or more")
    return _search(library, searched, pose_o, pose_f, nearest_only=False, gap=gap, depth=depth)


def nearest_minima(library: Library, searched: Searched, pose_o: Array, pose_f: Array) -> DistanceMinima:
    """The minimum with the least |d| of each pair of poses, which comes first in its row; perhaps others."""
    return _search(library, searched, pose_o, pose_f, nearest_only=True, gap=np.inf, depth=np.inf)


def _search(
    library: Library, searched: Searched, pose_o: Array, pose_f: Array, *,
    nearest_only: bool, gap: float, depth: float,
) -> DistanceMinima:  # fmt: skip
    session = Session(library, Accuracy())
    where, real = f"contact {searched.name!r}", session.tables.dtype
    given = given_poses(library, searched, pose_o, pose_f)
    n = common_rows(where, given)
    poses = [np.array(np.broadcast_to(rows, (n, 12)), dtype=real, order="C") for rows in given]
    counts = {"count": n, "is_complete": n, "feature_pair": n * MINIMA}
    out = {name: np.zeros(size, dtype=np.intc) for name, size in counts.items()}
    out |= {name: np.zeros((n * MINIMA, width), dtype=real) for name, width in WIDTHS.items()}
    largest = float(np.finfo(real).max)
    queries = session.tables.MinimaQueries(
        searched.first, searched.end, searched.body_o, searched.body_f, n, nearest_only, EFFORT,
        min(gap, largest), min(depth, largest),
    )  # fmt: skip
    arrays = {**dict(zip(MINIMA_GIVEN, poses, strict=True)), **{name: out[name] for name in MINIMA_FOUND}}
    for name, array in arrays.items():
        setattr(queries, name, address(array))
    interruptible(lambda: session.find_minima(queries), session.stop)
    row, place = np.nonzero(np.arange(MINIMA) < out["count"][:, None])
    found = {name: out[name][row * MINIMA + place] for name in ("feature_pair", *WIDTHS)}
    found["d"] = found["d"][:, 0]
    return DistanceMinima(complete=out["is_complete"].astype(bool), row=row, **found)


def given_poses(library: Library, searched: Searched, pose_o: Array, pose_f: Array) -> list[Array]:
    """The poses of o and f as rows of 12 numbers; raises SimulationError where they are none, or move a body
    that is fixed at the world frame."""
    bodies, fixed = library.manifest.instance["bodies"], _at_world_frame(library, searched)
    given = []
    for side, body, poses in (("o", searched.body_o, pose_o), ("f", searched.body_f, pose_f)):
        where = f"contact {searched.name!r}: pose_{side}"
        given.append(pose_rows(where, poses))
        if body not in fixed:
            continue
        off = np.abs(given[-1] - WORLD_FRAME).max(axis=1)
        if (moved := np.flatnonzero(~(off <= ROUNDING))).size:
            found = (
                f"row {moved[0]} moves or turns {bodies[body]['name']!r}, which is fixed at the world frame"
            )
            allowed = "its pose there, np.eye(3, 4)"
            remedy = "give the other body the pose that it has seen from this one, or make this body dynamic"
            raise SimulationError(where, found, allowed, remedy)
    return given


def _at_world_frame(library: Library, searched: Searched) -> set[int]:
    """The bodies whose pose no formula of the feature pairs takes, as they are fixed at the world frame."""
    entries, kinds = library.manifest.instance["feature_pairs"], library.manifest.kinds["contact"]
    return {
        entry[side]
        for entry in entries[searched.first : searched.end]
        for side, taken in zip("of", kinds[entry["kind"]]["sides"], strict=True)
        if taken["pose"] == "identity"
    }


def searched_pair(library: Library, contact: str | int) -> Searched:
    """The feature pairs of a pair of bodies ("a-b"), or one of them ("a-b:rim", or its index)."""
    expect("closest_points", library, Library)
    instance = library.manifest.instance
    feature_pairs: Sequence[Mapping[str, Any]] = instance["feature_pairs"]
    pairs = {str(pair["name"]): pair for pair in instance["pairs"]}
    names = [
        instance["pairs"][entry["pair"]]["name"] + (":" + entry["name"]) * bool(entry["name"])
        for entry in feature_pairs
    ]
    if isinstance(contact, str) and contact in names:
        contact = names.index(contact)
    if isinstance(contact, int) and 0 <= contact < len(names):
        return Searched(names[contact], contact, contact + 1, *_bodies(feature_pairs[contact]))
    if isinstance(contact, str) and contact in pairs:
        first, end = pairs[str(contact)]["feature_pairs"]
        return Searched(str(contact), first, end, *_bodies(feature_pairs[first]))
    known = list(dict.fromkeys([*pairs, *names]))
    found = f"no contact {shown(contact)}"
    raise SimulationError("closest points", found, f"contacts: {listed(known)}", nearest(str(contact), known))


def _bodies(entry: Mapping[str, Any]) -> tuple[int, int]:
    """The bodies of a feature pair in the order of its name."""
    return (entry["f"], entry["o"]) if entry["swapped"] else (entry["o"], entry["f"])


def eta_size(library: Library, feature_pair: int) -> int:
    """The number of contact parameters of a feature pair."""
    kind = library.manifest.instance["feature_pairs"][feature_pair]["kind"]
    return sum(ETA_SIZE[name] for name in library.manifest.kinds["contact"][kind]["eta"])
