"""Frictionless motion of one free body whose gap is a stationary value over two numbers: a second route.

It has no contact points, no surface normals, no curvatures and no contact parameters of the program.
Derivatives are CasADi's; the integrator is SciPy's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

Array = np.ndarray[Any, Any]
Gap = Callable[[ca.SX, ca.SX, ca.SX], ca.SX]  # of position, quaternion (w x y z) and the two numbers


def rotation(e: ca.SX) -> ca.SX:
    w, x, y, z = ca.vertsplit(e)
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


class StationaryRoute:
    """State s = [p, quaternion (w x y z), v, w (body), numbers (2)]; `closed_form`: without the numbers."""

    def __init__(self, gap: Gap, mass: float, inertia: Array, g: float = 9.81, closed_form: bool = False):
        self.closed_form = closed_form
        p, e, v, w, free = (ca.SX.sym(k, n) for k, n in (("p", 3), ("e", 4), ("v", 3), ("w", 3), ("a", 2)))
        d = gap(p, e, free)
        half = ca.vertcat(
            -e[1] * w[0] - e[2] * w[1] - e[3] * w[2],
            e[0] * w[0] + e[2] * w[2] - e[3] * w[1],
            e[0] * w[1] + e[3] * w[0] - e[1] * w[2],
            e[0] * w[2] + e[1] * w[1] - e[2] * w[0],
        )
        q, qdot, u = ca.vertcat(p, e), ca.vertcat(v, half / 2), ca.vertcat(v, w)
        stationary, curvature = ca.gradient(d, free), ca.hessian(d, free)[0]
        rates = ca.SX.zeros(2) if closed_form else -ca.solve(curvature, ca.jtimes(stationary, q, qdot))
        d_dot = ca.jtimes(d, q, qdot)
        row = ca.jacobian(d_dot, u)
        bias = ca.jtimes(d_dot, q, qdot) + ca.jtimes(d_dot, free, rates)
        spin, inverse = ca.DM(inertia), ca.DM(np.linalg.inv(inertia))
        falling = ca.vertcat(ca.DM([0, 0, -g]), -inverse @ ca.cross(w, spin @ w))
        weigh = ca.vertcat(row[0, :3].T / mass, inverse @ row[0, 3:].T)
        force = -(row @ falling + bias) / (row @ weigh)
        state = ca.vertcat(p, e, v, w, free)
        self.slope = ca.Function("slope", [state], [ca.vertcat(qdot, falling + weigh * force, rates)])
        self.gap = ca.Function("gap", [p, e, free], [d])
        self.force = ca.Function("force", [state], [force])
        self._newton = ca.Function("newton", [p, e, free], [stationary, curvature])

    def settle(self, p: Array, e: Array, free: Array) -> Array:
        """Newton on stationarity of the gap."""
        free = np.array(free, float)
        for _ in range(0 if self.closed_form else 30):
            slope, curvature = self._newton(p, e, free)
            free -= np.linalg.solve(np.array(curvature), np.array(slope).ravel())
        return free

    def run(self, p: Array, e: Array, v: Array, w_body: Array, free: Array, times: Array) -> Any:
        """SciPy's DOP853 at 1e-13 from the given start, with a guess of the numbers; the solution object."""
        state = np.concatenate([p, e, v, w_body, self.settle(p, e, free)])
        return solve_ivp(
            lambda t, s: np.array(self.slope(s)).ravel(),
            (0.0, times[-1]),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
            t_eval=times,
        )
