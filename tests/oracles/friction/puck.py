"""Flat bodies that slide and spin on a table, in coordinates of their own: x, y, and the angle.

The normal force is the weight; the pressure under the face is affine, with its centre where the moments about
the centre of mass, h above the face, balance. Friction is summed by direct quadrature: over a disc on polar
coordinates about the centre of rotation, which is inside; over a rectangle on triangles with that as their
apex. Of uniform discs and rings it has closed forms in elliptic integrals (Farkas and others, Phys. Rev.
Lett. 90 (2003), 248302).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipe, ellipk

Array = np.ndarray[Any, Any]
G = 9.81
FORCES = Callable[
    [Array], Array
]  # velocity and spin (3,) to friction (3,) by weight, torque about the face's centre


def uniform_disc(radius: float, v: float, w: float) -> tuple[float, float]:
    """Force against v and torque against w by mu times pressure, of a disc whose pressure is 1."""
    e = v / (w * radius)
    m = min(e, 1 / e) ** 2
    E, K = ellipe(m), ellipk(m)
    if e <= 1:
        force = ((e * e + 1) * E + (e * e - 1) * K) / e
        torque = (4 - 2 * e * e) * E + (e * e - 1) * K
    else:
        force = (e * e + 1) * E - (e * e - 1) * K
        torque = e * ((4 - 2 * e * e) * E + (2 * e * e - 5 + 3 / (e * e)) * K)
    return 4 / 3 * radius**2 * force, 4 / 9 * radius**3 * torque


def uniform_ring(outer: float, bore: float, mu: float) -> FORCES:
    """With the centre of mass in the face."""
    area = pi * (outer**2 - bore**2)

    def forces(u: Array) -> Array:
        speed, spin = float(np.hypot(u[0], u[1])), abs(float(u[2]))
        parts = [np.array(uniform_disc(r, speed, spin)) for r in (outer, bore) if r]
        force, torque = (parts[0] - (parts[1] if bore else 0)) / area
        return -mu * np.array([*(force * u[:2] / speed), torque * np.sign(u[2])])

    return forces


def _balanced(columns: Array, moments: Array, mu: float, height: float) -> Array:
    """Friction by weight, of an affine pressure whose centre balances it.

    `columns`: means over the face of (u, x cross u) times 1, x and y; `moments` (2, 2): means of x x'.
    """
    tilt = height * columns[:, 1:] @ np.linalg.inv(moments)
    force = np.linalg.solve(np.eye(2) - mu * tilt[:2], -mu * columns[:2, 0])
    return np.asarray(-mu * (columns[:, 0] - tilt @ force))


def disc_with_height(radius: float, mu: float, height: float, nodes: int = 160) -> FORCES:
    """A disc whose centre of mass is above its middle; the centre of rotation must stay inside."""
    angles = 2 * pi * np.arange(nodes) / nodes
    way = np.stack([np.cos(angles), np.sin(angles)])

    def forces(u: Array) -> Array:
        centre, sign = np.array([-u[1], u[0]]) / u[2], np.sign(u[2])
        inward = centre @ way
        r = -inward + np.sqrt(inward**2 + radius**2 - centre @ centre)
        across = sign * np.stack([-way[1], way[0]])
        columns = np.zeros((3, 3))
        for k in range(3):
            start, slope = (1.0, 0.0 * r) if k == 0 else (centre[k - 1], way[k - 1])
            force, arm = start * r**2 / 2 + slope * r**3 / 3, start * r**3 / 3 + slope * r**4 / 4
            torque = sign * arm + (centre[0] * across[1] - centre[1] * across[0]) * force
            columns[:, k] = np.vstack([across * force, torque]).mean(axis=1) * 2 / radius**2
        return _balanced(columns, np.eye(2) * radius**2 / 4, mu, height)

    return forces


def rectangle_with_height(a: float, b: float, mu: float, height: float, nodes: int = 80) -> FORCES:
    """Of half sides a, b; for motions that spin."""
    corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b]])
    s, s_weight = ((x + (i == 0)) / 2 for i, x in enumerate(np.polynomial.legendre.leggauss(4)))
    t, t_weight = ((x + (i == 0)) / 2 for i, x in enumerate(np.polynomial.legendre.leggauss(nodes)))

    def forces(u: Array) -> Array:
        centre, sign = np.array([-u[1], u[0]]) / u[2], np.sign(u[2])
        columns = np.zeros((3, 3))
        for p, q in zip(corners - centre, np.roll(corners, -1, axis=0) - centre, strict=True):
            whole = (p[0] * q[1] - p[1] * q[0]) / (4 * a * b)
            base = np.outer(1 - t, p) + np.outer(t, q)
            across = (
                sign * np.stack([-base[:, 1], base[:, 0]], axis=1) / np.linalg.norm(base, axis=1)[:, None]
            )
            for part, weight in zip(s, s_weight, strict=True):
                x = centre + part * base
                field = np.column_stack([across, x[:, 0] * across[:, 1] - x[:, 1] * across[:, 0]])
                by = np.column_stack([np.ones(nodes), x]) * (whole * part * weight * t_weight)[:, None]
                columns += field.T @ by
        return _balanced(columns, np.diag([a * a, b * b]) / 3, mu, height)

    return forces


@dataclass(frozen=True)
class Puck:
    """m, kg; inertia about the vertical, kg m^2; friction by weight."""

    mass: float
    inertia: float
    forces: FORCES

    def slope(self, t: float, x: Array) -> Array:
        angle = x[2]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        found = self.forces(np.array([*(turn.T @ x[3:5]), x[5]]))
        return np.array([*x[3:], *(G * turn @ found[:2]), self.mass * G * found[2] / self.inertia])

    def motion(self, velocity: Array, times: Array) -> Array:
        """(n, 6) x, y, angle and their rates, from the origin."""
        start = np.array([0.0, 0.0, 0.0, *velocity])
        found = solve_ivp(self.slope, (0, times[-1]), start, "DOP853", times, rtol=1e-13, atol=1e-15)
        return np.asarray(found.y.T)

    def ends(self, velocity: Array) -> tuple[float, Array]:
        """When slip and spin die, and (3,) the place there: followed until little is left."""

        def little(t: float, x: Array) -> float:
            return float(np.linalg.norm(x[3:5])) - 1e-7 * float(np.linalg.norm(velocity[:2]))

        little.terminal = True  # type: ignore[attr-defined]
        start = np.array([0.0, 0.0, 0.0, *velocity])
        found = solve_ivp(self.slope, (0, 100), start, "DOP853", events=little, rtol=1e-13, atol=1e-16)
        x, t = found.y[:, -1], float(found.t[-1])
        rate = self.slope(t, x)
        left = float(np.linalg.norm(x[3:5]) / np.linalg.norm(rate[3:5]))
        return t + left, x[:3] + x[3:] * left / 2
