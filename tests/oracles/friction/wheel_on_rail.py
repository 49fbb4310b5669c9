"""A wheel that rolls without slip along a rail; both profiles are splines.

The wheel's body axis z is its axle: (r cos, r sin, h) of the profile (h, r). The rail runs along x with the
profile (y, z). The contact is three numbers (along the wheel's profile, azimuth, along the rail's), the root
of: the wheel's normal has no part along x and none along the rail's tangent, and the points are level in that
tangent. Their rates follow by implicit differentiation. With rho from the centre to the contact c,

    v = -w x rho,   (I + m (rho^2 - rho rho^T)) w' = -w x I w - m rho x (w x (c' - v) + g).

The straight motion x = v t, w = v / r about the level axle is exact for profiles that touch below the centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from tests.oracles.stationary_route import rotation

Array = np.ndarray[Any, Any]


def spline(points: Sequence[Sequence[float]], t: ca.SX, degree: int = 3) -> ca.SX:
    """A clamped uniform B-spline with control points, t from 0 to 1, by the recursion of Cox and de Boor."""
    n = len(points)
    inner = np.linspace(0, 1, n - degree + 1)
    knots = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    basis = [
        ca.if_else(ca.logic_and(t >= a, t < b if b < 1 else t <= b), 1.0, 0.0) if b > a else ca.SX(0)
        for a, b in pairwise(knots)
    ]
    for k in range(1, degree + 1):
        basis = [
            _rising(knots[i], knots[i + k], t) * basis[i]
            + _rising(knots[i + k + 1], knots[i + 1], t) * basis[i + 1]
            for i in range(len(basis) - 1)
        ]
    return ca.DM(np.array(points, float)).T @ ca.vertcat(*basis)


def _rising(a: float, b: float, t: ca.SX) -> ca.SX:
    """0 at a, 1 at b; 0 where they meet."""
    return (t - a) / (b - a) if a != b else ca.SX(0)


# control points in m: a tread coned 1 in 20 with a rounded edge on either side, and a crowned rail head
TREAD = [(-0.06, 0.445), (-0.035, 0.4575), (-0.015, 0.4600), (0.015, 0.4600), (0.035, 0.4575), (0.06, 0.445)]
HEAD = [(-0.035, -0.008), (-0.02, -0.001), (-0.008, 0.0), (0.008, 0.0), (0.02, -0.001), (0.035, -0.008)]


class WheelOnRail:
    """Profiles as control points (h, r) of the wheel and (y, z) of the rail; inertia about the body axes."""

    def __init__(
        self, wheel: Any = TREAD, rail: Any = HEAD, mass: float = 400.0,
        inertia: tuple[float, float, float] = (25.0, 25.0, 45.0), g: float = 9.81,
    ):  # fmt: skip
        p, e, at = ca.SX.sym("p", 3), ca.SX.sym("e", 4), ca.SX.sym("at", 3)
        R, q = rotation(e), ca.vertcat(p, e)
        profile, head = spline(wheel, at[0]), spline(rail, at[2])
        X = ca.vertcat(profile[1] * ca.cos(at[1]), profile[1] * ca.sin(at[1]), profile[0])
        along, around = ca.jacobian(X, at[0]), ca.jacobian(X, at[1])
        normal = R @ ca.cross(along, around)
        normal /= ca.norm_2(normal)
        point = p + R @ X
        tangent = ca.jacobian(head, at[2])
        away = ca.vertcat(point[1] - head[0], point[2] - head[1])
        residual = ca.vertcat(
            normal[0], normal[1] * tangent[0] + normal[2] * tangent[1], ca.dot(away, tangent)
        )
        gap = (away[1] * tangent[0] - away[0] * tangent[1]) / ca.norm_2(tangent)
        qdot = ca.SX.sym("qdot", 7)
        rates = -ca.solve(ca.jacobian(residual, at), ca.jtimes(residual, q, qdot))
        moves = ca.jtimes(point, q, qdot) + ca.jacobian(point, at) @ rates
        self._contact = ca.Function("contact", [p, e, at], [residual, ca.jacobian(residual, at), point, gap])
        self._moves = ca.Function("moves", [p, e, at, qdot], [moves])
        self._rotation = ca.Function("rotation", [e], [R])
        self.mass, self.inertia, self.g = mass, np.array(inertia), g

    def contact(self, p: Array, e: Array) -> tuple[Array, Array, float]:
        """The three numbers, the contact point (world) and the gap; Newton from the lowest rim."""
        below = -np.array(self._rotation(e))[2]
        at = np.array([0.5, np.arctan2(below[1], below[0]), 0.5])
        for _ in range(50):
            residual, slope, _, _ = self._contact(p, e, at)
            step = np.linalg.solve(np.array(slope), np.array(residual).ravel())
            at = at - step
            if np.abs(step).max() < 1e-14:
                break
        _, _, point, gap = self._contact(p, e, at)
        return at, np.array(point).ravel(), float(gap)

    def place(self, p: Array, e: Array) -> Array:
        """p moved up or down until the wheel touches."""
        for _ in range(50):
            p = p - np.array([0, 0, self.contact(p, e)[2]])
        return p

    def slope(self, p: Array, e: Array, w: Array) -> tuple[Array, Array, Array]:
        """Of place, quaternion and angular velocity (world): their rates, velocity, and the rail's force."""
        at, point, _ = self.contact(p, e)
        rho, R = point - p, np.array(self._rotation(e))
        v = -np.cross(w, rho)
        turn = np.concatenate([[-e[1:] @ w], e[0] * w + np.cross(w, e[1:])]) / 2
        moves = np.array(self._moves(p, e, at, np.concatenate([v, turn]))).ravel()
        inertia, fall = R @ np.diag(self.inertia) @ R.T, np.array([0, 0, -self.g])
        drift = np.cross(w, moves - v)
        left = inertia + self.mass * (rho @ rho * np.eye(3) - np.outer(rho, rho))
        right = -np.cross(w, inertia @ w) - self.mass * np.cross(rho, drift + fall)
        turning = np.linalg.solve(left, right)
        force = self.mass * (-np.cross(turning, rho) - drift - fall)
        return np.concatenate([v, turn, turning]), v, force

    def run(self, p: Any, e: Any, w: Any, times: Array) -> Array:
        """States [p, e, w] (n, 10) at the times."""
        first = np.concatenate([p, e, w])
        field = lambda _, s: self.slope(s[:3], s[3:7] / np.linalg.norm(s[3:7]), s[7:])[0]  # noqa: E731
        ran = solve_ivp(field, (0, times[-1]), first, "DOP853", times, rtol=1e-12, atol=1e-13)
        assert ran.success, ran.message
        return np.asarray(ran.y.T)

    def energy(self, state: Array) -> float:
        p, e, w = state[:3], state[3:7] / np.linalg.norm(state[3:7]), state[7:]
        _, v, _ = self.slope(p, e, w)
        spin = np.array(self._rotation(e)).T @ w
        return float(self.mass * (v @ v) / 2 + spin @ (self.inertia * spin) / 2 + self.mass * self.g * p[2])
