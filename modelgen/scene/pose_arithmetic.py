"""Poses as numbers: frames from axes, composition."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from modelgen.rotations import Array, Quaternion, quaternion_of, rotation_of, unit
from modelgen.scene.scene_types import Pose

UPSIDE_DOWN: Quaternion = (0.0, 1.0, 0.0, 0.0)  # half a turn about x


def frame(origin: Sequence[float] | Array, x: Array, z: Array) -> Pose:
    """The pose at `origin` (3) m whose first and third axes are the orthogonal unit vectors x and z."""
    y = np.array([z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]])
    return Pose(_vector(origin), quaternion_of(np.column_stack([x, y, z])))


def compose(outer: Pose, inner: Pose) -> Pose:
    """The pose of `inner`, which is given in the frame `outer`, in the frame that `outer` is given in."""
    a, b = outer.quaternion, inner.quaternion
    w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
    return Pose(_vector(to_outer(outer, inner.position)), unit((w, x, y, z)))


def to_outer(pose: Pose, x: Sequence[float] | Array) -> Array:
    """The point x (3), or points (n, 3), of the frame in the frame that its pose is given in."""
    return np.array(pose.position) + np.asarray(x, dtype=np.float64) @ _rotation(pose.quaternion).T


def to_inner(pose: Pose, x: Sequence[float] | Array) -> Array:
    """The inverse of `to_outer`."""
    arm: Array = np.asarray(x, dtype=np.float64) - np.array(pose.position)
    return arm @ _rotation(pose.quaternion)


@lru_cache(maxsize=4096)
def _rotation(quaternion: Quaternion) -> Array:
    found = rotation_of(quaternion)
    found.setflags(write=False)
    return found


def _vector(x: Sequence[float] | Array) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])
