"""An egg held by two fingers: the least friction that holds it, and how it rolls between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]


def least_mu(first: Array, normal_first: Array, second: Array, normal_second: Array) -> float:
    """The least mu for which two point contacts can squeeze a body in balance: all but spin is then held.

    Each contact pushes along its normal, into the body. Both forces lie on the line through the points, which
    must be in both cones (Nguyen 1988): mu = tan of the larger angle between line and normal.
    """
    line = (second - first) / np.linalg.norm(second - first)
    normals = (np.asarray(normal_first), -np.asarray(normal_second))
    worst = max(np.arctan2(np.linalg.norm(np.cross(line, n)), n @ line) for n in normals)
    return float(np.tan(worst)) if worst < np.pi / 2 else float("inf")


def least_squeeze(weight: float, mu: float) -> float:
    """The least force of each of two opposite level fingers that holds a weight by friction."""
    return weight / (2 * mu)


def chord(axes: Array, point: Array, direction: Array) -> Array:
    """The second point of an ellipsoid on the line through one of its points."""
    scaled, along = point / axes, direction / axes
    return np.asarray(point - 2 * (scaled @ along) / (along @ along) * direction)


@dataclass(frozen=True)
class RolledBetween:
    """A spheroid, its axis upright, between two upright plates that move oppositely along x at the speed v.

    The plates touch its equator of radius b; it turns about its axis at v / b and its centre stays.
    The plates at y = +b (moves along +x) and y = -b (along -x); the spin is -v / b about z.
    """

    radius: float
    mass: float
    inertia: float
    squeeze: float
    g: float = 9.81

    def spin(self, v: float) -> float:
        return -v / self.radius

    def needed_mu(self, accel: float = 0.0) -> float:
        """Friction at each finger carries half the weight and half the torque that turns the egg."""
        turn = self.inertia * accel / self.radius / (2 * self.radius)
        return float(np.hypot(turn, self.mass * self.g / 2) / self.squeeze)
