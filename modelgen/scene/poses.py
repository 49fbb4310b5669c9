"""Poses as numbers: rotation matrices, frames from axes, composition."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Any

import numpy as np

from modelgen.scene.types import Pose

Array = np.ndarray[Any, np.dtype[np.float64]]
Quaternion = tuple[float, float, float, float]

UPSIDE_DOWN: Quaternion = (0.0, 1.0, 0.0, 0.0)  # half a turn about x


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
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    squares = [1 + trace, *(1 + 2 * R[k, k] - trace for k in range(3))]  # four times w^2, x^2, y^2, z^2
    turn = (R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    rows = [(squares[0], *turn)]
    for k in range(3):
        axis = [R[k, j] + R[j, k] for j in range(3)]
        axis[k] = squares[1 + k]
        rows.append((turn[k], *axis))
    largest = max(range(4), key=squares.__getitem__)
    return _unit(rows[largest])


def frame(origin: Sequence[float] | Array, x: Array, z: Array) -> Pose:
    """The pose at `origin` (3) m whose first and third axes are the orthogonal unit vectors x and z."""
    return Pose(_vector(origin), quaternion_of(np.column_stack([x, np.cross(z, x), z])))


def compose(outer: Pose, inner: Pose) -> Pose:
    """The pose of `inner`, which is given in the frame `outer`, in the frame that `outer` is given in."""
    a, b = outer.quaternion, inner.quaternion
    w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
    return Pose(_vector(to_outer(outer, inner.position)), _unit((w, x, y, z)))


def to_outer(pose: Pose, x: Sequence[float] | Array) -> Array:
    """The point x (3) of the frame in the frame that its pose is given in."""
    return np.array(pose.position) + rotation_of(pose.quaternion) @ np.asarray(x, dtype=np.float64)


def to_inner(pose: Pose, x: Sequence[float] | Array) -> Array:
    """The inverse of `to_outer`."""
    arm: Array = np.asarray(x, dtype=np.float64) - np.array(pose.position)
    return rotation_of(pose.quaternion).T @ arm


def _vector(x: Sequence[float] | Array) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])


def _unit(quaternion: Sequence[float]) -> Quaternion:
    length = hypot(*quaternion)
    w, x, y, z = (float(entry) / length for entry in quaternion)
    return w, x, y, z
