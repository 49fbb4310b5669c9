"""The surfaces and curves of the contacts as grids of points, for drawing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from modelgen.codegen.library import Library

Array = np.ndarray[Any, Any]
CONTACTS = 4  # the first so many get grids
ROWS, COLUMNS = 17, 33
_GRIDS = (("point", ()), ("curve", (ROWS * COLUMNS,)), ("surface", (COLUMNS, ROWS)))  # by dimension
REACH = 1.3  # of an unbounded surface, against the farthest contact point


def contact_meshes(library: Library, curve: Callable[[int, str], Array]) -> dict[str, Array]:
    """Grids (ROWS, COLUMNS, 3) m of both surfaces of the first contacts, keyed "0_o", "0_f", "1_o", ...; a
    curve or a point is one row.

    In the axes of the body's centre of mass. `curve(contact, side)` gives the contact points there, (n, 3) m;
    an unbounded surface is cut where it has gone past them.
    """
    sentence = library.manifest.sentence
    return {
        f"{k}_{side}": _mesh(library, link_of(sentence, k)[f"shape_{side}"], curve(k, side))
        for k in range(min(CONTACTS, len(sentence["contacts"])))
        for side in "of"
    }


def link_of(sentence: Mapping[str, Any], contact: int) -> Mapping[str, Any]:
    """The link that a contact has for its own, or the first of its pair."""
    entry = sentence["contacts"][contact]
    own = int(entry["link"])
    found: Mapping[str, Any] = sentence["links"][own if own >= 0 else sentence["pairs"][entry["pair"]]["links"][0]]
    return found


def _mesh(library: Library, shape: Mapping[str, Any], curve: Array) -> Array:
    """Grid of one side; `shape` says its kind, parameters and placement in the body."""
    kind = library.manifest.kinds["shape"][shape["kind"]]
    placement = np.array(shape["placement"])
    p, R = placement[:3], placement[3:].reshape(3, 3, order="F")
    reach = REACH * max(float(np.nanmax(np.abs((curve - p) @ R), initial=0.0)), _length(library))
    parameters = np.array([] if kind["folded"] is not None else shape["parameters"], dtype=library.dtype)
    role, sizes = _GRIDS[len(kind["domain"])]
    kernel = library.kernel(f"mg_{kind['name']}_{role}")
    axes = [_range(bounds, reach, n) for bounds, n in zip(kind["domain"], sizes, strict=True)]
    across = np.array([axis.ravel() for axis in np.meshgrid(*axes)])
    grid = np.ascontiguousarray(across.T if axes else np.zeros((1, 0)), dtype=library.dtype)
    points = np.asarray([kernel(each, parameters)[0] for each in grid], dtype=float)
    mesh: Array = points.reshape(*((ROWS, COLUMNS) if role == "surface" else (1, -1)), 3) @ R.T + p
    return mesh


def _length(library: Library) -> float:
    return float(library.manifest.sentence["scales"]["length"])


def _range(bounds: tuple[float | None, float | None], reach: float, n: int) -> Array:
    """Values within the bounds; reach takes the place of a bound that is none."""
    low, high = bounds
    return np.linspace(-reach if low is None else low, reach if high is None else high, n)
