"""Linkages in minimal coordinates: Lagrange's equations of their own geometry, integrated by SciPy."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

G = 9.81


def spun(y: ca.SX, x: ca.SX, z: ca.SX) -> ca.SX:
    """A point (x, z) of a body turned by y about the axis y, in x-z."""
    return ca.vertcat(x * ca.cos(y) + z * ca.sin(y), z * ca.cos(y) - x * ca.sin(y))


def slope_of(
    q: ca.SX, bodies: list[tuple[float, float, ca.SX, ca.SX]], stored: ca.SX
) -> Callable[[float, np.ndarray], np.ndarray]:
    """(q, q_dot)' of bodies (mass, inertia about y, centre (2,) in x-z, angle about y) with `stored` energy
    beside gravity's: d/dt (dL/dq_dot) = dL/dq.
    """
    rate = ca.SX.sym("rate", q.numel())
    kinetic, potential = ca.SX(0), stored
    for mass, inertia, centre, angle in bodies:
        v, w = ca.jtimes(centre, q, rate), ca.jtimes(angle, q, rate)
        kinetic += (mass * ca.dot(v, v) + inertia * w * w) / 2
        potential += mass * G * centre[1]
    momentum = ca.gradient(kinetic, rate)
    force = ca.gradient(kinetic - potential, q) - ca.jtimes(momentum, q, rate)
    accel = ca.solve(ca.jacobian(momentum, rate), force)
    f = ca.Function("slope", [ca.vertcat(q, rate)], [ca.vertcat(rate, accel)])
    return lambda t, state: f(state).full().ravel()


def solved(slope, start, times, **options):
    """The states (n, 2 k) at the times."""
    end = float(times[-1])
    return solve_ivp(
        slope,
        (float(times[0]), end),
        start,
        "DOP853",
        times,
        rtol=3e-14,
        atol=1e-14,
        max_step=0.01,
        **options,
    )


def four_bar() -> tuple[Callable, Callable]:
    """Slope in the turn of the crank, and centres (2,) with angles of crank, coupler and rocker."""
    q = ca.SX.sym("q")
    B, D = spun(q, 0.0, 0.3), ca.DM([1.0, 0.0])
    coupler, rocker = np.sqrt(0.73), np.sqrt(0.4)
    line = D - B
    span = ca.sqrt(ca.dot(line, line))
    along = (span**2 + coupler**2 - rocker**2) / (2 * span)
    up = ca.sqrt(coupler**2 - along**2)
    C = B + (along * line + up * ca.vertcat(-line[1], line[0])) / span
    bent = [-ca.atan2(end[1], end[0]) for end in (C - B, C - D)]
    start = [-np.arctan2(0.3, 0.8), -np.arctan2(0.6, -0.2)]
    angles = [b - s for b, s in zip(bent, start, strict=True)]
    centres = [B / 2, (B + C) / 2, (C + D) / 2]
    bodies = [
        (1.0, 0.0081, centres[0], q), (0.8, 0.049, centres[1], angles[0]), (1.2, 0.041, centres[2], angles[1])
    ]  # fmt: skip
    where = ca.Function("where", [q], [ca.horzcat(*centres).T, ca.vertcat(*angles)])
    return slope_of(q, bodies, ca.SX(0)), where


def slider_crank() -> tuple[Callable, Callable]:
    """Slope in the turn of the crank, and centres of crank, rod, slider and follower."""
    q = ca.SX.sym("q")
    pin = spun(q, 0.1, 0.0)
    reach = pin[0] + ca.sqrt(0.3**2 - pin[1] ** 2)
    cam = spun(q, 0.0, -0.03)
    lift = cam[1] + ca.sqrt(0.15**2 - cam[0] ** 2)
    rod = ca.asin(-pin[1] / 0.3)
    slider, follower = ca.vertcat(reach, 0), ca.vertcat(0, lift)
    middle = (pin + slider) / 2
    bodies = [
        (2.0, 0.02, ca.SX.zeros(2), q), (0.5, 0.004, middle, -rod), (0.7, 0.001, slider, ca.SX(0)),
        (0.4, 0.001, follower, ca.SX(0)),
    ]  # fmt: skip
    spring = 25.0 * (lift - 0.12 + 0.1) ** 2
    where = ca.Function("where", [q], [ca.horzcat(ca.SX.zeros(2), middle, slider, follower).T])
    return slope_of(q, bodies, spring), where


def double_pendulum() -> tuple[Callable, Callable, Callable]:
    """Slope in the angles about y of both rods, their centres, and the mass matrix at the angles."""
    q = ca.SX.sym("q", 2)
    elbow = spun(q[0], 1.0, 0.0)
    centres = [elbow / 2, elbow + spun(q[1], 0.4, 0.0)]
    masses, inertias = (1.0, 0.6), (0.0838, 0.0324)
    bodies = [(m, i, c, q[k]) for k, (m, i, c) in enumerate(zip(masses, inertias, centres, strict=True))]
    J = [ca.jacobian(c, q) for c in centres]
    M = ca.diag(ca.DM(inertias)) + sum(
        (m * j.T @ j for m, j in zip(masses, J, strict=True)), ca.SX.zeros(2, 2)
    )
    return (
        slope_of(q, bodies, ca.SX(0)),
        ca.Function("where", [q], [ca.horzcat(*centres).T]),
        ca.Function("mass", [q], [M]),
    )
