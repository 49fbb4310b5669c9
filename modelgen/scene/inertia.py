"""The inertia of a body: three principal moments or a symmetric matrix, of a body that can exist."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modelgen.scene.pose_input import VECTOR
from modelgen.scene.scalar_types import Schema
from modelgen.scene.scene_types import Matrix
from modelgen.scene.source_location import Place, describe
from modelgen.scene.table_types import Sequence

ROUNDING = 1e-9  # relative, of moments written in decimals
SINGULAR = 1e-12  # smallest moment against the largest

_MATRIX = Sequence(VECTOR, 3)


@dataclass(frozen=True, slots=True)
class Inertia:
    """Reads [Ixx, Iyy, Izz] or a list of three rows to a symmetric matrix, kg m^2."""

    def read(self, value: object, place: Place) -> Matrix:
        if not isinstance(value, list | tuple) or len(value) != 3:
            allowed = "a list of 3 moments or of 3 rows of 3 is allowed"
            raise place.error(describe(value), allowed, "write inertia = [Ixx, Iyy, Izz]")
        if isinstance(value[0], list | tuple):
            matrix: Matrix = _MATRIX.read(value, place)
        else:
            x, y, z = VECTOR.read(value, place)
            matrix = ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))
        _check(np.array(matrix), place)
        return matrix

    def schema(self) -> Schema:
        return {"anyOf": [VECTOR.schema(), _MATRIX.schema()]}


def _check(matrix: np.ndarray[tuple[int, ...], np.dtype[np.float64]], place: Place) -> None:
    """Symmetric, positive definite, and no moment larger than the sum of the other two."""
    size = float(np.abs(matrix).max())
    if float(np.abs(matrix - matrix.T).max()) > ROUNDING * size:
        raise place.error(
            "a matrix that is not symmetric", "Iij = Iji is required", "write each product of inertia twice"
        )
    smallest, middle, largest = (float(moment) for moment in np.linalg.eigvalsh(matrix))
    found = f"principal moments {smallest:.6g}, {middle:.6g}, {largest:.6g}"
    if not smallest > SINGULAR * size:
        raise place.error(found, "all must be positive", "give every axis a moment above zero")
    if largest > (smallest + middle) * (1 + ROUNDING):
        allowed = "none may exceed the sum of the other two"
        raise place.error(found, allowed, "no body has such moments: check the units and the order")
