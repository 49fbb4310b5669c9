"""A second formulation of a convex body that rolls or slides on the plane z = 0: Lagrange's equations.

Coordinates are x, y of the centre of mass and three angles, R = Rz(q2) Rx(q3) Ry(q4), or Rz(q4) last; the
height is a function of q3 and q4. All derivatives are CasADi's, the integrator is SciPy's DOP853.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

Array = np.ndarray[Any, Any]
Support = Callable[[ca.SX], ca.SX]  # max of n.x over the body, of degree 1 in n


def turned(angle: ca.SX, axis: int) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    R = ca.SX.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[i, i], R[j, j], R[i, j], R[j, i] = c, c, -s, s
    return R


def ellipsoid_support(axes: Any, frame: Any = None, offset: Any = (0, 0, 0)) -> Support:
    Q = ca.DM(np.asarray(np.eye(3) if frame is None else frame, float))
    return lambda n: ca.norm_2(ca.DM(list(axes)) * (Q.T @ n)) + ca.dot(n, ca.DM(list(offset)))


def circle_support(radius: float, axis: Any) -> Support:
    e = ca.DM(list(axis))
    return lambda n: radius * ca.sqrt(ca.sumsqr(n) - ca.dot(n, e) ** 2)


class LagrangeRoute:
    """mu None: rolls; otherwise slides with Coulomb's friction. Resistances in m. `last`: the axis of q4."""

    def __init__(
        self, support: Support, mass: float, inertia: Any, mu: float | None = None,
        resistance: tuple[float, float] = (0.0, 0.0), g: float = 9.81, last: int = 1,
    ):  # fmt: skip
        q, u = ca.SX.sym("q", 5), ca.SX.sym("u", 5)
        R = turned(q[2], 2) @ turned(q[3], 0) @ turned(q[4], last)
        n = ca.SX.sym("n", 3)
        lowest = ca.Function("lowest", [n], [ca.gradient(support(n), n)])
        height = ca.Function("support", [n], [support(n)])(-R[2, :].T)
        p = ca.vertcat(q[0], q[1], height)
        v = ca.jtimes(p, q, u)
        spin = R.T @ ca.reshape(ca.jtimes(ca.reshape(R, 9, 1), q, u), 3, 3)
        w = ca.vertcat(spin[2, 1], spin[0, 2], spin[1, 0])
        arm = R @ lowest(-R[2, :].T)
        W = R @ w
        slip = (v + ca.cross(W, arm))[:2]
        kinetic = (mass * ca.sumsqr(v) + w.T @ ca.DM(np.asarray(inertia, float)) @ w) / 2
        potential = mass * g * height
        momentum = ca.gradient(kinetic, u)
        M = ca.jacobian(momentum, u)
        bias = ca.jtimes(momentum, q, u) - ca.gradient(kinetic - potential, q)
        lift = ca.jacobian(v[2], u)
        rolling = ca.vertcat(W[0], W[1], 0)
        drag = -resistance[0] * rolling / (ca.norm_2(rolling) + 1e-300) if resistance[0] else ca.SX.zeros(3)
        drag -= ca.vertcat(0, 0, resistance[1] * ca.sign(W[2]))
        per_normal = ca.jacobian(W, u).T @ drag
        A = ca.jacobian(slip, u)
        if mu is not None:
            per_normal -= mu * A.T @ slip / ca.norm_2(slip)
        outputs = [M, bias, lift, ca.jtimes(v[2], q, u), A, ca.jtimes(slip, q, u), per_normal]
        self._parts = ca.Function("parts", [q, u], outputs)
        self._pose = ca.Function("pose", [q, u], [p, R, v, W, slip, kinetic + potential])
        self.rolls, self.mass, self.g, self.last = mu is None, mass, g, last

    def accelerations(self, q: Array, u: Array) -> tuple[Array, float, Array]:
        """q'', normal force, force of the no-slip rows."""
        M, bias, lift, own, A, drift, per_normal = (np.array(part) for part in self._parts(q, u))
        # N = m (g + lift q'' + own); M q'' + bias = per_normal N + A^T f; A q'' + drift = 0
        left = M - self.mass * per_normal @ lift
        right = -bias + per_normal * self.mass * (self.g + own)
        force = np.zeros(2)
        if self.rolls:
            whole = np.block([[left, -A.T], [A, np.zeros((2, 2))]])
            found = np.linalg.solve(whole, np.vstack([right, -drift])).ravel()
            rates, force = found[:5], found[5:]
        else:
            rates = np.linalg.solve(left, right).ravel()
        return rates, float(self.mass * (self.g + lift @ rates + own.ravel())[0]), force

    def start(self, R: Any, w: Any, p: Any = (0, 0), v: Any = None) -> tuple[Array, Array]:
        """q and u from a rotation matrix, world angular velocity and, sliding, x, y velocity."""
        R = np.asarray(R, float)
        if self.last == 1:
            angles = [np.arctan2(-R[0, 1], R[1, 1]), np.arcsin(R[2, 1]), np.arctan2(-R[2, 0], R[2, 2])]
        else:
            angles = [np.arctan2(R[0, 2], -R[1, 2]), np.arccos(R[2, 2]), np.arctan2(R[2, 0], R[2, 1])]
        q = np.array([*p, *angles])
        rates = np.linalg.solve(self._turns(q), np.asarray(w, float))
        u = np.concatenate([np.zeros(2), rates])
        slip = np.array(self._pose(q, u)[4]).ravel()
        u[:2] = -slip if v is None else v
        return q, u

    def _turns(self, q: Array) -> Array:
        columns = [np.array(self._pose(q, unit)[3]).ravel() for unit in np.eye(5)[2:]]
        return np.stack(columns, 1)

    def run(self, q: Array, u: Array, times: Any, rtol: float = 1e-12) -> tuple[Array, Array, Array, Array]:
        """p (n, 3), R (n, 3, 3), world w (n, 3) and energy (n) at the times."""

        def slope(_: float, s: Array) -> Array:
            return np.concatenate([s[5:], self.accelerations(s[:5], s[5:])[0]])

        ran = solve_ivp(slope, (0, times[-1]), np.concatenate([q, u]), "DOP853", times, rtol=rtol, atol=1e-14)
        assert ran.success, ran.message
        poses = [self._pose(s[:5], s[5:]) for s in ran.y.T]
        pick = lambda k: np.array([np.array(pose[k]) for pose in poses])  # noqa: E731
        return pick(0)[..., 0], pick(1), pick(3)[..., 0], pick(5).ravel()
