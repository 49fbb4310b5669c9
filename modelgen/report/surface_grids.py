"""The surfaces and curves of the contacts as grids of points, for drawing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.scene.custom_solid_checks import quadric

if TYPE_CHECKING:
    from modelgen.codegen.library import Library

Array = np.ndarray[Any, Any]
CONTACTS = 4  # the first so many get grids
ROWS, COLUMNS = 17, 33
REACH = 1.3  # of an unbounded surface, against the farthest contact point
PARTS, PART_ROWS = 100, 5  # most features of a solid in the picture, and rows of each if there are so many


def contact_meshes(library: Library, curve: Callable[[int, str], Array]) -> dict[str, Array]:
    """Grids (rows, COLUMNS, 3) m of both shapes of the first contacts, keyed "0_o", "0_f", "1_o", ...; a
    curve or a point is one row. Of a solid or spline all features that can touch, one below the other with a
    row of NaN between: its edges, and its curved faces up to them.

    In the axes of the body's centre of mass. `curve(contact, side)` gives the contact points there, (n, 3) m;
    an unbounded surface is cut where it has gone past them.
    """
    instance = library.manifest.instance
    return {
        f"{k}_{side}": _features(library, k, side, curve(k, side))
        for k in range(min(CONTACTS, len(instance["contacts"])))
        for side in "of"
    }


def feature_pair_of(instance: Mapping[str, Any], contact: int) -> Mapping[str, Any]:
    """The feature pair that a contact has for its own, or the first of its pair."""
    entry = instance["contacts"][contact]
    own, first = int(entry["feature_pair"]), instance["pairs"][entry["pair"]]["feature_pairs"][0]
    found: Mapping[str, Any] = instance["feature_pairs"][own if own >= 0 else first]
    return found


def _features(library: Library, contact: int, side: str, curve: Array) -> Array:
    """All features of the shape on one side of a contact."""
    instance = library.manifest.instance
    own = feature_pair_of(instance, contact)
    first, end = instance["pairs"][instance["contacts"][contact]["pair"]]["feature_pairs"]
    parts: dict[str, tuple[Mapping[str, Any], list[Any]]] = {}
    for feature_pair in instance["feature_pairs"][first:end]:
        here = "o" if feature_pair["o"] == own[side] else "f"
        shape = feature_pair[f"shape_{here}"]
        borders = [each for each in feature_pair["conditions"] if each["side"] == "of".index(here)]
        parts.setdefault(str([shape[key] for key in ("kind", "parameters", "placement")]), (shape, borders))
    if len(parts) == 1:
        return _mesh(library, own[f"shape_{side}"], curve, ROWS)
    drawn = [part for part in parts.values() if _is_drawn(library, part[0])][:PARTS]
    gap = np.full((1, COLUMNS, 3), np.nan)
    rows = min(ROWS, PARTS * PART_ROWS // max(len(drawn), 1))
    grids = [_cut(_mesh(library, shape, curve, rows), shape, borders) for shape, borders in drawn]
    return np.concatenate([row for grid in grids for row in (grid, gap)] or [gap])


def _is_drawn(library: Library, shape: Mapping[str, Any]) -> bool:
    """Flat faces are seen by their edges, vertices by the edges that end there."""
    kind = library.manifest.kinds["shape"][shape["kind"]]
    return bool(kind["periodic"]) and kind["kind"] != "plane"


def _cut(mesh: Array, shape: Mapping[str, Any], borders: list[Any]) -> Array:
    """NaN where a quadric condition of the feature does not hold."""
    placement = np.array(shape["placement"])
    local = ((mesh - placement[:3]) @ placement[3:].reshape(3, 3, order="F")).reshape(-1, 3)
    slack = 1e-9 * max(float(np.abs(mesh).max()), 1e-9)
    for border in borders:
        if border["kind"] == "quadric":
            outside = quadric(border["numbers"], local).reshape(mesh.shape[:-1]) < -slack
            mesh = np.where(outside[..., None], np.nan, mesh)
    return mesh


def _mesh(library: Library, shape: Mapping[str, Any], curve: Array, rows: int) -> Array:
    """Grid of one feature; `shape` says its kind, parameters, domain and placement in the body."""
    kind = library.manifest.kinds["shape"][shape["kind"]]
    placement = np.array(shape["placement"])
    p, R = placement[:3], placement[3:].reshape(3, 3, order="F")
    reach = REACH * max(float(np.nanmax(np.abs((curve - p) @ R), initial=0.0)), _length(library))
    parameters = np.array([] if "folded" in kind else shape["parameters"], dtype=library.dtype)
    role, sizes = (("point", ()), ("curve", (COLUMNS,)), ("surface", (COLUMNS, rows)))[len(kind["periodic"])]
    kernel = library.kernel(f"mg_{kind['name']}_{role}")
    axes = [_range(bounds, reach, n) for bounds, n in zip(shape["domain"], sizes, strict=True)]
    across = np.array([axis.ravel() for axis in np.meshgrid(*axes)])
    grid = np.ascontiguousarray(across.T if axes else np.zeros((1, 0)), dtype=library.dtype)
    points = np.asarray([kernel(each, parameters)[0] for each in grid], dtype=float)
    mesh: Array = points.reshape(*((rows, COLUMNS) if role == "surface" else (1, -1)), 3) @ R.T + p
    return mesh


def _length(library: Library) -> float:
    return float(library.manifest.instance["scales"]["length"])


def _range(bounds: tuple[float | None, float | None], reach: float, n: int) -> Array:
    """Values within the bounds; reach takes the place of a bound that is none."""
    low, high = bounds
    return np.linspace(-reach if low is None else low, reach if high is None else high, n)
