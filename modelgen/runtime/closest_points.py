"""Closest points of one contact at many poses, in one call of the core.

Two convex shapes without edges (spheres, ellipsoids, superellipsoids) are solved from nothing: the maximum of
their separation function is the signed distance. It is certified down to an overlap of the sum of the shapes'
smallest radii of curvature (of a superellipsoid 0); deeper, a local extremum is given, the highest found or
the one that continues `eta`. Closed forms (two spheres, a convex shape on a plane) are certified too. All
other pairs start from `eta` and end in an extremum near it; `outcome` tells whether it is a minimum.

>>> import numpy as np
>>> from modelgen import build, closest_points, derive, emit, require
>>> from modelgen.scene.read import read_text
>>> eggs = '''
... run = { until = 1.0 }
... body = [
...   { name = "a", density = 1.0, shape = { kind = "ellipsoid", semi_axes = [3.0, 2.0, 1.0] } },
...   { name = "b", density = 1.0, shape = { kind = "ellipsoid", semi_axes = [3.0, 2.0, 1.0] } },
... ]
... contact = [{ between = ["a", "b"] }]
... '''
>>> library = build(emit(derive(require(read_text(eggs, "eggs.toml")))))
>>> rotation = np.eye(3).ravel()
>>> here, above = np.append([0, 0, 0], rotation), np.append([0, 0, 2.25], rotation)
>>> found = closest_points(library, "a-b", here, above)
>>> found.d, found.normal, found.certified
(array([0.25]), array([[0., 0., 1.]]), array([ True]))
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from modelgen.codegen.library import Library, kernel_table
from modelgen.errors import SimulationError, nearest
from modelgen.notation import ETA_SIZE
from modelgen.runtime.accuracy import RESOLVED, Accuracy
from modelgen.runtime.tables.ctypes_structures import QUERY_FOUND, QUERY_GIVEN, Array, address, tables_of

SIGNS = (float("inf"),) * 2  # entries that jump
PART = 8  # an entry of eta moves by an eighth of its range in one step at most
OUTPUTS = {"d": 1, "normal": 3, "point_o": 3, "point_f": 3, "margin": 2}


class Extremum(IntEnum):
    """The outcome of one row of `ClosestPoints`."""

    NOWHERE = 0  # no extremum was found from there
    STATIONARY = 1  # a saddle or a maximum of the distance
    MINIMUM = 2  # a local minimum of the distance
    CLOSEST = 3  # the least of all, by certificate or closed form


@dataclass(frozen=True, slots=True)
class ClosestPoints:
    """Results, one row per pair of poses; o and f are the first and second body of the contact."""

    d: Array  # (n,) m, signed distance: positive apart, negative overlapping
    normal: Array  # (n, 3) world, unit, from o to f
    point_o: Array  # (n, 3) m, world
    point_f: Array  # (n, 3) m, world
    eta: Array  # (n, n_eta) the contact parameters, to start the next call from
    margin: Array  # (n, 2) mu and sigma (1/m), the distance from singular contact; 0 and below: no minimum
    outcome: Array  # (n,) Extremum

    @property
    def certified(self) -> Array:
        """(n,) True where the points are proved to be the closest of all; normal and d then are unique."""
        return np.asarray(self.outcome == Extremum.CLOSEST)


def closest_points(
    library: Library,
    contact: str | int,
    pose_o: Array,
    pose_f: Array,
    eta: Array | None = None,
    *,
    parameters: Array | None = None,
) -> ClosestPoints:
    """The closest points of two shapes of a scene at n pairs of poses; the module says how, with an example.

    Args:
        library: what `build` returned.
        contact: the names of its bodies, as "a-b"; of shapes with edges or vertices, one pair of features
            that can touch, as "a-b:rim". Or its index among the feature pairs of the manifest.
        pose_o: (n, 12) or (12,) of body o: centre of mass (m, world), then the rotation body -> world column
            by column. Not read of a body fixed at the world frame, nor the rotation of a point mass.
        pose_f: the same of body f; a single pose goes with all of the other body.
        eta: (n, n_eta) contact parameters near those wanted, as a call at near poses returned them.
        parameters: (n, n_parameters) lengths and placements in the place of the scene's, in the order of
            the manifest's contact kind.

    Raises:
        SimulationError: no such contact, arrays that do not fit, or no `eta` where one is needed.
    """
    name, entry = feature_pair_of(library, contact)
    kind, where = library.manifest.kinds["contact"][entry["kind"]], f"contact {name!r}"
    own = parameters if parameters is not None else np.array(entry["parameters"], dtype=float)
    given = [
        _rows(f"{where}: pose_o", pose_o, 12),
        _rows(f"{where}: pose_f", pose_f, 12),
        _rows(f"{where}: parameters", own, len(kind["parameters"])),
        _rows(f"{where}: eta", _start(where, kind) if eta is None else eta, kind["n_eta"]),
    ]
    n, real = _common(where, given), library.dtype
    whole = [np.array(np.broadcast_to(rows, (n, rows.shape[1])), dtype=real, order="C") for rows in given]
    queries, points = prepared(library, entry, whole)
    queries.is_warm_start = eta is not None
    library.cdll.mg_closest(ctypes.byref(queries))
    return points


def _start(where: str, kind: Mapping[str, Any]) -> Array:
    """Starting values of eta where none are given; SimulationError for kinds that need them."""
    if kind["n_eta"] and not kind["convex"]:
        raise SimulationError(
            where,
            "no contact parameters to start from",
            "eta is found from nothing for two convex shapes alone",
            "give eta, for example that of a trajectory",
        )
    return np.zeros(kind["n_eta"])


def prepared(library: Library, entry: Mapping[str, Any], rows: list[Array]) -> tuple[Any, ClosestPoints]:
    """The mg_closest_queries of a feature pair, and the arrays that `mg_closest` then fills in.

    `rows`: pose_o, pose_f, parameters and eta, n contiguous rows of each, of the library's type.
    """
    real, (pose_o, pose_f, lengths, eta) = library.dtype, rows
    out = {name: np.zeros((len(eta), size), dtype=real) for name, size in OUTPUTS.items()}
    outcome = np.zeros(len(eta), dtype=np.intc)
    limits = np.array([*_step_limits(library, entry), 0], dtype=real)
    queries = tables_of(real).Queries(
        kernel_table(library.cdll), entry["kind"], len(eta), 0, lengths.shape[1]
    )
    queries.kept = [lengths, pose_o, pose_f, limits, eta, *out.values(), outcome]
    for name, array in zip((*QUERY_GIVEN, *QUERY_FOUND), queries.kept, strict=True):
        setattr(queries, name, address(array))
    queries.length = library.manifest.instance["scales"]["length"]
    resolved = RESOLVED["extremality_residual"] * float(np.finfo(real).eps)
    queries.residual = max(Accuracy().extremality_residual, resolved)
    out["d"] = out["d"][:, 0]
    return queries, ClosestPoints(**out, eta=eta, outcome=outcome)


def feature_pair_of(library: Library, contact: str | int) -> tuple[str, Mapping[str, Any]]:
    """The name and the entry of a feature pair of the instance."""
    instance = library.manifest.instance
    feature_pairs: Sequence[Mapping[str, Any]] = instance["feature_pairs"]
    names = [
        instance["pairs"][feature_pair["pair"]]["name"]
        + (":" + feature_pair["name"]) * bool(feature_pair["name"])
        for feature_pair in feature_pairs
    ]
    if isinstance(contact, str) and contact in names:
        return contact, feature_pairs[names.index(contact)]
    if isinstance(contact, int) and 0 <= contact < len(feature_pairs):
        return names[contact], feature_pairs[contact]
    found, known = f"no contact {contact!r}", f"contacts: {', '.join(names)}"
    raise SimulationError("closest_points", found, known, nearest(str(contact), names))


def _rows(where: str, values: Array, size: int) -> Array:
    """The values as (rows, size)."""
    array = np.asarray(values)
    array = array[None] if array.ndim == 1 else array
    if array.ndim != 2 or array.shape[1] != size:
        raise SimulationError(where, f"an array of shape {np.shape(values)}", f"(n, {size}) or ({size},)")
    return array


def _common(where: str, given: list[Array]) -> int:
    """The common number of rows; arrays of one row are repeated."""
    counts = {len(rows) for rows in given} - {1}
    if len(counts) > 1:
        found = f"arrays of {' and '.join(str(count) for count in sorted(counts))} rows"
        raise SimulationError(where, found, "as many rows in each, or one")
    return counts.pop() if counts else 1


def _step_limits(library: Library, entry: Mapping[str, Any]) -> list[float]:
    """The longest Newton step of each entry of eta: a part of the shape's size for points, of the range for
    parameters."""
    kinds, length = library.manifest.kinds, library.manifest.instance["scales"]["length"]
    limits: list[float] = []
    for name, side in zip(kinds["contact"][entry["kind"]]["eta"], ("shape_o", "shape_f"), strict=True):
        size = 2 * (entry[side]["bounding_radius"] or length) / PART
        domain = entry[side]["domain"]
        ranges = [size if None in ends else (ends[1] - ends[0]) / PART for ends in domain]
        points = [size] * 3 if name == "point" else [] if name == "sign" else ranges
        limits += [*points, *SIGNS][: ETA_SIZE[name]]
    return limits
