"""Rotation matrices and quaternions (w, x, y, z) as numbers."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]
Quaternion = tuple[float, float, float, float]
ROUNDING = 1e-6  # of a rotation matrix written in decimals, per entry of R^T R
# 4 q[i] q[j] for i != j is the sum or difference of two entries of a rotation matrix, given by their numbers:
FIRST = np.array([0, 7, 2, 3, 7, 0, 1, 2, 2, 3, 0, 5, 3, 6, 7, 0])
SECOND = np.array([0, 5, 6, 1, 5, 0, 3, 6, 6, 1, 0, 7, 1, 2, 5, 0])
SIGN = np.array([0, -1, -1, -1, -1, 0, 1, 1, -1, 1, 0, 1, -1, 1, 1, 0])


def rotation_of(quaternion: Quaternion) -> Array:
    """The rotation matrix (3,3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_of(R: Array) -> Quaternion:
    """The unit quaternion (w, x, y, z) of a rotation matrix (3,3)."""
    return unit(_unscaled(R.reshape(1, 3, 3))[0])


def quaternions_of(rotations: Array) -> Array:
    """Unit quaternions (..., 4) in (w, x, y, z) order, w >= 0, of rotation matrices (..., 3, 3)."""
    q = _unscaled(rotations.reshape(-1, 3, 3).astype(float))
    q *= np.where(q[:, :1] < 0, -1, 1) / np.linalg.norm(q, axis=1, keepdims=True)
    ordered: Array = q.reshape(*rotations.shape[:-2], 4)
    return ordered


def _unscaled(R: Array) -> Array:
    """(n, 4) quaternions of (n, 3, 3), times four times their largest entry, which may be negative."""
    entries = R.reshape(len(R), 9)
    diagonal = entries[:, ::4]
    trace = diagonal[:, 0] + diagonal[:, 1] + diagonal[:, 2]
    rows = entries[:, FIRST] + SIGN * entries[:, SECOND]  # row k: 4 q[k] q
    rows[:, 0] = 1 + trace
    rows[:, 5::5] = 1 + 2 * diagonal - trace[:, None]
    largest = np.argmax(rows[:, ::5], axis=1)
    found: Array = rows.reshape(-1, 4, 4)[np.arange(len(R)), largest]
    return found


def unit(quaternion: Sequence[float] | Array) -> Quaternion:
    """The quaternion scaled to unit length."""
    length = hypot(*quaternion)
    w, x, y, z = (float(entry) / length for entry in quaternion)
    return w, x, y, z
