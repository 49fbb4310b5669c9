"""A second route to frictionless motion of an ellipsoid against an ellipsoid, a cavity or a plane.

The gap is the stationary value over unit directions n of

    outside:  n.(p_f - p_o) - h_o(n) - h_f(-n)          (maximum)
    cavity:   h_o(n) - h_f(n) - n.(p_f - p_o)           (minimum)

with the support functions h(n) = |diag(a, b, c) R^T n|; n is charted by two angles about a chosen axis.
Body o is fixed at the world frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from tests.oracles.stationary_route import StationaryRoute, rotation


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


class SupportRoute(StationaryRoute):
    """The numbers of the state are the angles of n; `fixed` None is the plane z = 0."""

    def __init__(
        self, moving: Ellipsoid, fixed: Ellipsoid | None, cavity: bool, frame: np.ndarray, g: float = 9.81
    ):
        self.frame = np.asarray(frame, float)

        def gap(p: ca.SX, e: ca.SX, angle: ca.SX) -> ca.SX:
            if fixed is None:
                return p[2] - _reach(moving, e, ca.DM([0, 0, 1]))
            n = ca.DM(self.frame) @ ca.vertcat(
                ca.cos(angle[0]) * ca.cos(angle[1]), ca.sin(angle[0]) * ca.cos(angle[1]), ca.sin(angle[1])
            )
            wall, reach = ca.norm_2(ca.DM(list(fixed.axes)) * n), _reach(moving, e, n)
            return wall - reach - ca.dot(n, p) if cavity else ca.dot(n, p) - wall - reach

        super().__init__(gap, moving.mass, np.diag(moving.inertia), g, closed_form=fixed is None)

    def angles(self, direction: np.ndarray) -> np.ndarray:
        """The angles of a direction."""
        x, y, z = self.frame.T @ np.asarray(direction, float)
        return np.array([np.arctan2(y, x), np.arcsin(z / np.linalg.norm([x, y, z]))])


def _reach(body: Ellipsoid, e: ca.SX, n: ca.SX) -> ca.SX:
    return ca.norm_2(ca.DM(list(body.axes)) * (rotation(e).T @ n))
