"""Measured tosses of a cube (ContactNets): how they are read, started from and compared with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene

Array = np.ndarray[Any, Any]

FOLDER = Path(__file__).parent.parent / "data" / "cube_tosses"
NUMBERS = (0, 61, 120, 183, 247, 312, 374, 435, 497, 564)
HALF_WIDTH, MASS, INERTIA = 0.0524, 0.37, 0.00081
MU, RESTITUTION, RATE, G = 0.18, 0.125, 148.0, 9.81


@dataclass(frozen=True)
class Toss:
    """t (n,), p (n, 3) in m, rotation body -> world of each frame."""

    t: Array
    p: Array
    rotation: Rotation

    @property
    def v(self) -> Array:
        """Velocity at the first frame: the first difference, and what gravity takes in half a frame."""
        return np.asarray((self.p[1] - self.p[0]) * RATE + np.array([0, 0, G / (2 * RATE)]))

    @property
    def w(self) -> Array:
        """Angular velocity at the first frame, world, by the turn to the second."""
        return np.asarray((self.rotation[1] * self.rotation[0].inv()).as_rotvec() * RATE)

    @property
    def quaternion(self) -> Array:
        """(w, x, y, z) of the first frame."""
        return np.roll(self.rotation[0].as_quat(), 1)


def toss(number: int, folder: Path = FOLDER) -> Toss:
    rows = np.loadtxt(folder / f"{number}.csv", delimiter=",")[:, :7]
    rotation = Rotation.from_quat(np.roll(rows[:, 3:], -1, axis=1))
    return Toss(np.arange(len(rows)) / RATE, rows[:, :3] * HALF_WIDTH, rotation)


def scene_of(measured: Toss) -> Scene:
    """A cube thrown as the measured one onto the ground."""
    cube = make.dynamic(
        "cube",
        make.box(*[2 * HALF_WIDTH] * 3),
        mass=MASS,
        inertia=[INERTIA] * 3,
        position=measured.p[0].tolist(),
        quaternion=measured.quaternion.tolist(),
        velocity=measured.v.tolist(),
        angular_velocity=measured.w.tolist(),
    )
    contact = [{"between": ["cube", "ground"], "friction": MU, "restitution": RESTITUTION}]
    return make.scene("measured_toss", [make.fixed("ground", make.plane()), cube], contact=contact)


def corners(p: Array, rotation: Rotation) -> Array:
    """(n, 8, 3) of a cube at places and rotations."""
    signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    return np.asarray(p[:, None] + np.einsum("nij,kj->nki", rotation.as_matrix(), signs * HALF_WIDTH))


def errors(measured: Toss, p: Array, rotation: Rotation) -> tuple[float, float]:
    """Means over the frames of the distance of the centre, m, and of the angle between rotations, rad."""
    turned = (measured.rotation.inv() * rotation).magnitude()
    return float(np.linalg.norm(p - measured.p, axis=1).mean()), float(turned.mean())


def in_flight(start: Toss) -> tuple[Array, Rotation]:
    """Places and rotations at the frames without a ground: a parabola, and spin that stays."""
    p = start.p[0] + np.outer(start.t, start.v) + np.outer(start.t**2, [0, 0, -G / 2])
    return p, Rotation.from_rotvec(np.outer(start.t, start.w)) * start.rotation[0]
