"""The material of shapes as solids of the core, by their terms, or by samples where no terms describe it.

Heights of points over a solid are negative inside, positive outside, with a slope of 1 at most. Their sign is
exact, but for shapes known by samples only, of which points within the spacing of the samples count as
outside.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.tables.ctypes_structures import INTEGER, address, packed, tables_of
from modelgen.runtime.tables.number_pool import NumberPool
from modelgen.runtime.tables.shapes import solid_arrays

Array = np.ndarray[Any, np.dtype[np.float64]]

LIPSCHITZ = 1  # MG_LIPSCHITZ


class Common(NamedTuple):
    """Whether two solids have a point in common that is deep enough, or by how much they can move, in all,
    before they have one."""

    is_deep: bool
    slack: float  # m


class Materials:
    """The solids of all shapes of a scene that have some material, with the cavities of their bodies."""

    def __init__(self, table: Mapping[str, Any], library: Library) -> None:
        """`table`: `unlisted` or `open_edges` of the library's manifest."""
        samples = {
            entry["solid"]: _samples(entry)
            for entry in table["shapes"]
            if entry["kind"] == "sampled" and not entry["thin"] and entry["normals"]
        }
        solids = library.manifest.instance["solids"]
        terms = [each["terms"] or samples.get(k) for k, each in enumerate(solids)]
        known = [k for k in range(len(solids)) if terms[k]]
        self._number = {k: number for number, k in enumerate(known)}
        numbers = NumberPool(shares=False)
        integers = solid_arrays([{**solids[k], "terms": terms[k]} for k in known], numbers)
        self._core, self._tables = library.cdll, tables_of(library.dtype)
        arrays, places = packed(integers, INTEGER)
        reals, real_places = packed({"numbers": numbers.values}, self._tables.dtype)
        self._arrays = arrays | reals  # to which the system points
        self._system = self._tables.System(
            n_solid=len(known), n_numbers=len(numbers.values), **places, **real_places
        )

    def number(self, entry: Mapping[str, Any]) -> int | None:
        """The solid of a shape of the table; None of one without material."""
        return None if entry["thin"] else self._number.get(entry["solid"])

    def heights(self, solid: int, x: Array) -> Array:
        """(n,) m: of points (n, 3) m over a solid, in the axes of its body's centre of mass."""
        found = np.empty(len(x), dtype=self._tables.dtype)
        pose, points = self._reals(_pose(np.eye(3), np.zeros(3))), self._reals(x)
        self._core.mg_solid_heights(
            ctypes.byref(self._system), solid, _at(pose), LIPSCHITZ, len(x), _at(points), _at(found)
        )
        return found.astype(float)

    def common(self, a: int, b: int, R: Array, p: Array, centre: Array, radius: float, deep: float) -> Common:
        """Whether a ball about a point of b's body has a point deeper than `deep` (m) in both solids; R and p
        lead from b's axes to a's."""
        poses = self._reals(np.concatenate([_pose(np.eye(3), np.zeros(3)), _pose(R, p)]))
        ball, slack = self._reals([*(p + R @ centre), radius]), self._reals([0.0])
        solids = np.array([a, b], dtype=INTEGER)
        found = self._core.mg_solids_overlap(
            ctypes.byref(self._system),
            _at(solids),
            _at(poses),
            _at(ball),
            self._tables.real(deep),
            _at(slack),
        )
        return Common(bool(found), float(slack[0]))

    def _reals(self, values: Any) -> Array:
        return np.ascontiguousarray(values, dtype=self._tables.dtype)


def points_of(entry: Mapping[str, Any]) -> Array:
    """(n, 3) m: the samples of a shape known by them, in the axes of its body's centre of mass."""
    placement = np.array(entry["placement"])
    points = np.array(entry["points"]).reshape(-1, 3)
    placed: Array = points @ placement[3:].reshape(3, 3, order="F").T + placement[:3]
    return placed


def _samples(entry: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    points, normals = (np.array(entry[key]).reshape(-1, 3) for key in ("points", "normals"))
    numbers = [float(entry["parameters"][0]), *np.hstack([points, normals]).ravel().tolist()]
    return [{"kind": "samples", "numbers": numbers}]


def _pose(R: Array, p: Array) -> Array:
    return np.concatenate([p, R.ravel(order="F")])


def _at(array: np.ndarray[Any, Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(address(array))
