"""Closest points of two bodies at many poses, in one call of the core.

Two convex shapes without edges (spheres, ellipsoids, superellipsoids) are solved from nothing: the maximum of
their separation function is the signed distance. It is certified down to an overlap of the sum of the shapes'
smallest radii of curvature (of a superellipsoid 0); deeper, a local extremum is given, the highest found or
the one that continues `eta`. Closed forms (two spheres, a convex shape on a plane) are certified too. All
other pairs are searched as `distance_minima` does, and the minimum with the least |d| is given; it is
certified where the bodies are apart, the search was complete, and not both bodies have vertices. With `eta`,
one pair of features is followed from there instead, to an extremum near it; `outcome` tells whether it is a
minimum.

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
>>> here, above = np.eye(3, 4), np.column_stack([np.eye(3), [0, 0, 2.25]])
>>> found = closest_points(library, "a-b", here, above)
>>> found.d, found.normal, found.certified
(array([0.25]), array([[0., 0., 1.]]), array([ True]))
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any

import numpy as np

from modelgen.codegen.library import Library, kernel_table
from modelgen.errors import SimulationError
from modelgen.notation import ETA_SIZE
from modelgen.runtime.accuracy import RESOLVED
from modelgen.runtime.arguments import common_rows, rows_of
from modelgen.runtime.distance_minima import (
    Searched,
    eta_size,
    given_poses,
    nearest_minima,
    searched_pair,
)
from modelgen.runtime.tables.ctypes_structures import QUERY_FOUND, QUERY_GIVEN, Array, address, tables_of
from modelgen.runtime.thresholds import Thresholds

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
    """Results, one row per pair of poses; o and f are the first and second body in the contact's name."""

    d: Array  # (n,) m, signed distance: positive apart, negative overlapping
    normal: Array  # (n, 3) world, unit, from o to f
    point_o: Array  # (n, 3) m, world
    point_f: Array  # (n, 3) m, world
    eta: Array  # (n, n_eta) the contact parameters, to start the next call from; of several features (n, 6)
    margin: Array  # (n, 2) mu and sigma (1/m), the distance from singular contact; 0 and below: no minimum
    outcome: Array  # (n,) Extremum
    feature_pair: Array  # (n,) index in the manifest's instance; -1 where nothing was found

    @property
    def certified(self) -> Array:
        """(n,) True where no other pair of points is nearer, by proof."""
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
    """The closest points of two bodies of a scene at n pairs of poses; the module says how, with an example.

    Args:
        library: what `build` returned.
        contact: the names of its bodies, as "a-b"; or one pair of their features, as "a-b:rim", or its index
            among the feature pairs of the manifest.
        pose_o: (n, 3, 4) or (3, 4) of body o, [R | p]: rotation body -> world and centre of mass, m. The
            point x of the body is at R @ x + p. That of a body fixed at the world frame is `np.eye(3, 4)`.
        pose_f: the same of body f; a single pose goes with all of the other body.
        eta: (n, n_eta) contact parameters near those wanted, as a call at near poses returned them; for one
            pair of features.
        parameters: (n, n_parameters) lengths and placements in the place of the scene's, in the order of
            the manifest's contact kind; for two convex shapes, or with `eta`.

    Raises:
        SimulationError: no such contact; arrays that do not fit; rotations that are none; another pose of a
            body that is fixed at the world frame.
    """
    searched = searched_pair(library, contact)
    where = f"contact {searched.name!r}"
    if not searched.is_single and (eta is not None or parameters is not None):
        found = f"{searched.end - searched.first} pairs of features"
        raise SimulationError(
            where, found, "one pair of features, for eta or parameters", "name it, as 'a-b:rim'"
        )
    entry = library.manifest.instance["feature_pairs"][searched.first]
    kind = library.manifest.kinds["contact"][entry["kind"]]
    if not searched.is_single or (eta is None and kind["n_eta"] and not kind["convex"]):
        if parameters is not None:
            raise SimulationError(
                where, "parameters without eta", "eta with them, of shapes that are not convex", "give eta"
            )
        return _nearest(library, searched, pose_o, pose_f)
    return _followed(library, searched, [pose_o, pose_f], eta, parameters)


def _nearest(library: Library, searched: Searched, pose_o: Array, pose_f: Array) -> ClosestPoints:
    """The first minimum of each row, by search."""
    minima = nearest_minima(library, searched, pose_o, pose_f)
    n = len(minima.complete)
    row, first = np.unique(minima.row, return_index=True)
    width = eta_size(library, searched.first) if searched.is_single else minima.eta.shape[1]
    columns = {name: getattr(minima, name) for name in OUTPUTS} | {"eta": minima.eta[:, :width]}
    out = {name: np.full((n, *of.shape[1:]), np.nan, dtype=of.dtype) for name, of in columns.items()}
    for name, of in columns.items():
        out[name][row] = of[first]
    outcome, feature_pair = np.full(n, Extremum.NOWHERE), np.full(n, -1)
    is_certified = minima.complete[row] & (minima.d[first] > 0)
    outcome[row] = np.where(is_certified, Extremum.CLOSEST, Extremum.MINIMUM)
    feature_pair[row] = minima.feature_pair[first]
    return ClosestPoints(**out, outcome=outcome, feature_pair=feature_pair)


def _followed(
    library: Library, searched: Searched, poses: list[Array], eta: Array | None, parameters: Array | None
) -> ClosestPoints:
    """Closest points of one pair of features from eta, or of convex shapes from nothing."""
    entry, where = library.manifest.instance["feature_pairs"][searched.first], f"contact {searched.name!r}"
    kind = library.manifest.kinds["contact"][entry["kind"]]
    own = parameters if parameters is not None else np.array(entry["parameters"], dtype=float)
    start = np.zeros(kind["n_eta"]) if eta is None else eta
    pose_o, pose_f = given_poses(library, searched, *poses)
    given = [
        *((pose_f, pose_o) if entry["swapped"] else (pose_o, pose_f)),
        rows_of(f"{where}: parameters", own, len(kind["parameters"])),
        rows_of(f"{where}: eta", start, kind["n_eta"]),
    ]
    n, real = common_rows(where, given), library.dtype
    whole = [np.array(np.broadcast_to(rows, (n, rows.shape[1])), dtype=real, order="C") for rows in given]
    queries, points = prepared(library, searched.first, whole)
    queries.is_warm_start = eta is not None
    library.cdll.mg_closest(ctypes.byref(queries))
    if not entry["swapped"]:
        return points
    return replace(points, normal=-points.normal, point_o=points.point_f, point_f=points.point_o)


def prepared(library: Library, feature_pair: int, rows: list[Array]) -> tuple[Any, ClosestPoints]:
    """The mg_closest_queries of a feature pair, and the arrays that `mg_closest` then fills in.

    `rows`: poses of the feature pair's o and f, parameters and eta, n contiguous rows of each, of the type of
    the library.
    """
    real, (pose_o, pose_f, lengths, eta) = library.dtype, rows
    entry = library.manifest.instance["feature_pairs"][feature_pair]
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
    queries.residual = max(Thresholds().extremality_residual, resolved)
    out["d"] = out["d"][:, 0]
    of = np.full(len(eta), feature_pair)
    return queries, ClosestPoints(**out, eta=eta, outcome=outcome, feature_pair=of)


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
