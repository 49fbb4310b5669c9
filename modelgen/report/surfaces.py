"""The surfaces and curves of the contacts as grids of points, for drawing."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from modelgen.codegen.library import Library

Array = np.ndarray[Any, Any]
CONTACTS = 4  # the first so many get grids
ROWS, COLUMNS = 17, 33
REACH = 1.3  # of an unbounded surface, against the farthest contact point


def contact_meshes(library: Library, curve: Callable[[int, str], Array]) -> dict[str, Array]:
    """Grids (ROWS, COLUMNS, 3) m of both surfaces of the first contacts, keyed "0_o", "0_f", "1_o", ...; a
    curve is one row.

    In the axes of the body's centre of mass. `curve(contact, side)` gives the contact points there, (n, 3) m;
    an unbounded surface is cut where it has gone past them.
    """
    contacts = library.manifest.sentence["contacts"][:CONTACTS]
    return {
        f"{k}_{side}": _mesh(library, entry[f"shape_{side}"], curve(k, side))
        for k, entry in enumerate(contacts)
        for side in "of"
    }


def _mesh(library: Library, shape: dict[str, Any], curve: Array) -> Array:
    """Grid of one side; `shape` says its kind, parameters and placement in the body."""
    kind = library.manifest.kinds["shape"][shape["kind"]]
    placement = np.array(shape["placement"])
    p, R = placement[:3], placement[3:].reshape(3, 3, order="F")
    reach = REACH * max(float(np.abs((curve - p) @ R).max(initial=0.0)), _length(library))
    parameters = np.array([] if kind["folded"] is not None else shape["parameters"], dtype=library.dtype)
    is_curve = len(kind["domain"]) == 1
    kernel = library.kernel(f"mg_{kind['name']}_{'curve' if is_curve else 'surface'}")
    sizes = (ROWS * COLUMNS,) if is_curve else (COLUMNS, ROWS)
    axes = [_range(bounds, reach, n) for bounds, n in zip(kind["domain"], sizes, strict=True)]
    grid = np.stack(np.meshgrid(*axes), -1).reshape(-1, len(sizes)).astype(library.dtype)
    points = np.asarray([kernel(each, parameters)[0] for each in grid], dtype=float)
    mesh: Array = points.reshape(*((1, -1) if is_curve else (ROWS, COLUMNS)), 3) @ R.T + p
    return mesh


def _length(library: Library) -> float:
    return float(library.manifest.sentence["scales"]["length"])


def _range(bounds: tuple[float | None, float | None], reach: float, n: int) -> Array:
    """Values within the bounds; reach takes the place of a bound that is none."""
    low, high = bounds
    return np.linspace(-reach if low is None else low, reach if high is None else high, n)
