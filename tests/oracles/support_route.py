"""A second route to frictionless motion of an ellipsoid against an ellipsoid, a cavity or a plane.

The gap is the stationary value over unit directions n of

    outside:  n.(p_f - p_o) - h_o(n) - h_f(-n)          (maximum)
    cavity:   h_o(n) - h_f(n) - n.(p_f - p_o)           (minimum)

with the support functions h(n) = |diag(a, b, c) R^T n|. It has no contact points, no surface normals, no
curvatures and no contact parameters of the program; n is charted by two angles about a chosen axis. Body o is
fixed at the world frame. Derivatives are CasADi's; the integrator is SciPy's.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Ellipsoid:
    axes: tuple[float, float, float]
    mass: float = 1.0
    inertia: tuple[float, float, float] = (1.0, 1.0, 1.0)


def solid(axes: tuple[float, float, float], mass: float) -> Ellipsoid:
    """A homogeneous solid ellipsoid."""
    a, b, c = axes
    return Ellipsoid(
        axes, mass, (mass / 5 * (b * b + c * c), mass / 5 * (a * a + c * c), mass / 5 * (a * a + b * b))
    )


def rotation(e: ca.SX) -> ca.SX:
    w, x, y, z = ca.vertsplit(e)
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


class SupportRoute:
    """State s = [p, quaternion (w x y z), v, w (body), angles (2)]; `fixed` None is the plane z = 0."""

    def __init__(
        self, moving: Ellipsoid, fixed: Ellipsoid | None, cavity: bool, frame: np.ndarray, g: float = 9.81
    ):
        self.frame = np.asarray(frame, float)
        p, e, v, w, angle = (ca.SX.sym(k, n) for k, n in (("p", 3), ("e", 4), ("v", 3), ("w", 3), ("a", 2)))
        n = ca.DM(self.frame) @ ca.vertcat(
            ca.cos(angle[0]) * ca.cos(angle[1]), ca.sin(angle[0]) * ca.cos(angle[1]), ca.sin(angle[1])
        )
        if fixed is None:
            n = ca.DM([0, 0, 1])
        gap = self._gap(moving, fixed, cavity, p, e, n)
        q = ca.vertcat(p, e)
        half = ca.vertcat(
            -e[1] * w[0] - e[2] * w[1] - e[3] * w[2],
            e[0] * w[0] + e[2] * w[2] - e[3] * w[1],
            e[0] * w[1] + e[3] * w[0] - e[1] * w[2],
            e[0] * w[2] + e[1] * w[1] - e[2] * w[0],
        )
        qdot = ca.vertcat(v, half / 2)
        u = ca.vertcat(v, w)
        stationary = ca.gradient(gap, angle)
        if fixed is None:
            angle_dot = ca.SX.zeros(2)
        else:
            angle_dot = -ca.solve(ca.hessian(gap, angle)[0], ca.jtimes(stationary, q, qdot))
        gap_dot = ca.jtimes(gap, q, qdot)
        row = ca.jacobian(gap_dot, u)
        bias = ca.jtimes(gap_dot, q, qdot) + ca.jtimes(gap_dot, angle, angle_dot)
        inertia = ca.DM(list(moving.inertia))
        free = ca.vertcat(ca.DM([0, 0, -g]), -ca.cross(w, inertia * w) / inertia)
        weigh = ca.vertcat(row[0, :3].T / moving.mass, row[0, 3:].T / inertia)

        force = -(row @ free + bias) / (row @ weigh)
        slope = ca.vertcat(qdot, free + weigh * force, angle_dot)
        state = ca.vertcat(p, e, v, w, angle)
        self.slope = ca.Function("slope", [state], [slope])
        self.gap = ca.Function("gap", [p, e, angle], [gap])
        self.gap_rate = ca.Function("gap_rate", [p, e, v, w, angle], [gap_dot])
        self.force = ca.Function("force", [state], [force])
        self._newton = ca.Function("newton", [p, e, angle], [stationary, ca.hessian(gap, angle)[0]])
        self.plane = fixed is None

    @staticmethod
    def _gap(moving: Ellipsoid, fixed: Ellipsoid | None, cavity: bool, p: ca.SX, e: ca.SX, n: ca.SX) -> ca.SX:
        reach = ca.norm_2(ca.DM(list(moving.axes)) * (rotation(e).T @ n))
        if fixed is None:
            return p[2] - reach
        wall = ca.norm_2(ca.DM(list(fixed.axes)) * n)
        return wall - reach - ca.dot(n, p) if cavity else ca.dot(n, p) - wall - reach

    def settle(self, p: np.ndarray, e: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Newton on stationarity of the gap over the direction."""
        angle = np.array(angle, float)
        for _ in range(30 if not self.plane else 0):
            slope, curvature = self._newton(p, e, angle)
            angle -= np.linalg.solve(np.array(curvature), np.array(slope).ravel())
        return angle

    def angles(self, direction: np.ndarray) -> np.ndarray:
        x, y, z = self.frame.T @ np.asarray(direction, float)
        return np.array([np.arctan2(y, x), np.arcsin(z / np.linalg.norm([x, y, z]))])

    def run(self, p, e, v, w_body, direction, times, until_lift_off: bool = False):
        """SciPy's DOP853 at 1e-13 from the given start; the solution object."""
        angle = self.settle(p, e, self.angles(direction))
        state = np.concatenate([p, e, v, w_body, angle])
        lift = lambda t, s: float(self.force(s))  # noqa: E731
        lift.terminal, lift.direction = True, -1
        return solve_ivp(
            lambda t, s: np.array(self.slope(s)).ravel(),
            (0.0, times[-1]),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
            t_eval=times,
            events=lift if until_lift_off else None,
        )
