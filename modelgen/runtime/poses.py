"""Poses as a caller gives them: matrices [R | p] of a rotation body -> world and a position."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.rotations import ROUNDING
from modelgen.runtime.arguments import numbers_in

Array = np.ndarray[Any, Any]
LAYOUT = "[R | p] of shape (3, 4) or (n, 3, 4): R @ x + p is the point of the world that x of the body is at"


def pose_rows(where: str, poses: Any) -> Array:
    """The poses (n, 3, 4) or (3, 4) as the core takes them: (n, 12), position, rotation column by column.

    Poses that are not finite go through, as what has no closest points.

    Raises:
        SimulationError: the shape is another, or a rotation is none: its rows are not orthogonal or not of
            length 1 (to 1e-6), or it is a reflection.
    """
    given = numbers_in(where, poses, LAYOUT)
    if given.shape[-2:] != (3, 4) or given.ndim not in (2, 3):
        found, remedy = f"an array of shape {given.shape}", "write np.column_stack([R, p])"
        raise SimulationError(where, found, LAYOUT, remedy)
    matrices = given.reshape(-1, 3, 4)
    R, finite = matrices[:, :, :3].astype(float), np.isfinite(matrices).all(axis=(1, 2))
    off = np.abs(R @ np.swapaxes(R, 1, 2) - np.eye(3)).max(axis=(1, 2))
    faults = ((off > ROUNDING, "R R^T differs from 1 by {:.2g}"), (_is_mirrored(R), "a reflection"))
    for wrong, found in faults:
        if (bad := np.flatnonzero(finite & wrong)).size:
            row = f"{where}: row {bad[0]}" if given.ndim == 3 else where
            allowed = f"a rotation, det R = 1 and R R^T = 1 to {ROUNDING:g}, in {LAYOUT}"
            raise SimulationError(row, found.format(off[bad[0]]), allowed, "check the order of the entries")
    return np.concatenate([matrices[:, :, 3], np.swapaxes(matrices[:, :, :3], 1, 2).reshape(-1, 9)], axis=1)


def pose_matrices(numbers: Array) -> Array:
    """(..., 3, 4) of poses (..., 12) as the core gives them."""
    R = np.swapaxes(numbers[..., 3:].reshape(*numbers.shape[:-1], 3, 3), -1, -2)
    return np.concatenate([R, numbers[..., :3, None]], axis=-1)


def _is_mirrored(R: Array) -> Array:
    return np.asarray(np.linalg.det(np.where(np.isfinite(R), R, 0.0)) < 0)
