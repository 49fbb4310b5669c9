"""Motions of the rolling ellipsoid from any simulator, and how they are judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.oracles.friction.on_plane import P, V, W, rotation_of
from tests.oracles.friction.rolling_ellipsoid import DENSITY, SEMI_AXES, begun, body

Array = np.ndarray[Any, Any]

TIMES = np.linspace(0, 5, 51)
JUDGED = 2.0  # s: errors of place up to here
AXES = np.array(SEMI_AXES)
MASS = 4 / 3 * np.pi * AXES.prod() * DENSITY
INERTIA = MASS / 5 * ((AXES**2).sum() - AXES**2)


@dataclass(frozen=True)
class Track:
    """p (n, 3), R (n, 3, 3) body -> world, v and w (n, 3) world at TIMES; CPU us per simulated s."""

    p: Array
    R: Array
    v: Array
    w: Array
    cost: float

    @classmethod
    def of_quaternions(cls, p: Any, quaternion: Any, v: Any, w: Any, cost: float) -> Track:
        turned = Rotation.from_quat(np.roll(np.asarray(quaternion, float), -1, axis=-1)).as_matrix()
        places, speeds, spins = (np.asarray(values, float) for values in (p, v, w))
        return cls(places, np.asarray(turned, float), speeds, spins, cost)

    @property
    def energy(self) -> Array:
        spin = np.einsum("nji,nj->ni", self.R, self.w)
        kinetic = (MASS * (self.v**2).sum(1) + (INERTIA * spin**2).sum(1)) / 2
        return np.asarray(kinetic + MASS * 9.81 * self.p[:, 2])

    @property
    def kinetic(self) -> float:
        """At the start."""
        return float(self.energy[0] - MASS * 9.81 * self.p[0, 2])


@dataclass(frozen=True)
class Row:
    name: str
    centre: float
    tips: float
    energy: float
    cost: float


def judged(name: str, track: Track, exact: Track) -> Row:
    last = int(np.argmin(np.abs(TIMES - JUDGED)))
    tips = track.p[:, :, None] + track.R * AXES - exact.p[:, :, None] - exact.R * AXES
    away = (tips[: last + 1] ** 2).sum(1)
    change = (track.energy[-1] - track.energy[0]) / exact.kinetic
    centre = np.linalg.norm(track.p[last] - exact.p[last])
    return Row(name, float(centre), float(np.sqrt(away.mean())), float(change), track.cost)


@dataclass(frozen=True)
class Start:
    """The scene's start in doubles: p, quaternion (w x y z), v and w in the world, w in body axes."""

    p: Array
    quaternion: Array
    v: Array
    w: Array
    w_body: Array


def start() -> Start:
    x = begun(body())
    R = rotation_of(x)
    quaternion = np.roll(Rotation.from_matrix(R.astype(float)).as_quat(), 1)
    v, w = ((R @ x[part]).astype(float) for part in (V, W))
    return Start(x[P].astype(float), quaternion, v, w, x[W].astype(float))
