"""Balls in closed form: sliding into rolling in any direction, down an incline, and rolling on a turntable.

A homogeneous ball has moment of inertia k m r^2, k = 2/5. Its slip s = v + w x (-r z) obeys
s' = -(1 + 1/k) mu g s/|s|, because friction is along s and acts on v and, with the lever r, on w:
the direction of s never changes, whatever the spin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class SlideToRoll:
    """A ball on a level plane from p, v, w (world) at t = 0; `rolls_at` is the time when slip dies."""

    radius: float
    mu: float
    p: Array
    v: Array
    w: Array
    g: float = 9.81
    k: float = 0.4

    @property
    def slip(self) -> Array:
        return self.v - self.radius * np.cross(self.w, UP)

    @property
    def rolls_at(self) -> float:
        return float(np.linalg.norm(self.slip)) / ((1 + 1 / self.k) * self.mu * self.g)

    def at(self, t: float) -> tuple[Array, Array, Array]:
        """p, v and w at the time t."""
        speed = np.linalg.norm(self.slip)
        along = self.slip / speed if speed else self.slip
        push = -self.mu * self.g * along
        slides = min(t, self.rolls_at)
        v = self.v + push * slides
        p = self.p + self.v * slides + push * slides**2 / 2 + v * (t - slides)
        return p, v, self.w + np.cross(-UP, push) / (self.k * self.radius) * slides

    def path(self, times: Any) -> Array:
        """Positions (n, 3)."""
        return np.array([self.at(float(t))[0] for t in times])


def released_on_incline(
    angle: float, mu: float, radius: float, g: float = 9.81, k: float = 0.4
) -> tuple[bool, float, float]:
    """Of a ball at rest let go on an incline: whether it rolls, its acceleration and angular acceleration."""
    needed = k / (1 + k) * np.tan(angle)
    if needed <= mu:
        a = g * np.sin(angle) / (1 + k)
        return True, float(a), float(a / radius)
    a = g * (np.sin(angle) - mu * np.cos(angle))
    return False, float(a), float(mu * g * np.cos(angle) / (k * radius))


@dataclass(frozen=True)
class Turntable:
    """A ball rolling on a table that turns at `turn` about z: its centre goes round a circle (Earnshaw 1844).

    `p`, `v` of its centre at t = 0; w_z stays. The circle's rate is turn k / (1 + k).
    """

    turn: float
    p: Array
    v: Array
    k: float = 0.4

    @property
    def rate(self) -> float:
        return self.turn * self.k / (1 + self.k)

    @property
    def centre(self) -> Array:
        return self.p - np.array([self.v[1], -self.v[0], 0.0]) / self.rate

    def path(self, times: Any) -> Array:
        """Positions (n, 3)."""
        arm, angle = self.p - self.centre, self.rate * np.asarray(times, float)
        turned = np.array([-arm[1], arm[0], 0.0])
        flat = np.array([arm[0], arm[1], 0.0])
        return np.asarray(
            self.centre * [1, 1, 0]
            + np.outer(np.cos(angle), flat)
            + np.outer(np.sin(angle), turned)
            + UP * self.p[2]
        )

    def spin(self, radius: float, at: Any, v: Any, w_z: float = 0.0) -> Array:
        """Angular velocity that rolls at a place and velocity of the centre: v - r w x z = turn z x p."""
        slip = np.asarray(v) - np.cross([0.0, 0.0, self.turn], np.asarray(at) * [1, 1, 0])
        return np.cross(UP, slip) / radius + w_z * UP


@dataclass(frozen=True)
class PushedBox:
    """P07 c: a box pushed along a level plane by a force, balls that roll on top of it; all start at rest."""

    mass: float = 10.0
    balls: int = 25
    ball_mass: float = 1.0
    mu_ground: float = 0.4
    force: float = 150.0
    g: float = 9.81
    k: float = 0.4

    @property
    def accelerations(self) -> tuple[float, float, float]:
        """Of the box, of a ball, and the friction coefficient that a ball needs."""
        resist = self.mu_ground * (self.mass + self.balls * self.ball_mass) * self.g
        share = self.k / (1 + self.k)
        box = (self.force - resist) / (self.mass + self.balls * self.ball_mass * share)
        return box, share * box, share * box / self.g
