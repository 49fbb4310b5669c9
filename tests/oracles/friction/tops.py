"""Rattleback, tippe top and spinning egg: their parameters, starts and references."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.oracles.friction.extrapolation import Array, Real, reals, written
from tests.oracles.friction.on_plane import (
    GAMMA,
    PI,
    Body,
    T,
    W,
    ellipsoid_reach,
    rolled,
    slid,
    slid_out,
    solid_ellipsoid,
    start,
)  # fmt: skip


def turned(angle: Any, axis: int) -> Array:
    c, s = np.cos(Real(angle)), np.sin(Real(angle))
    R, i, j = reals(np.eye(3)), (axis + 1) % 3, (axis + 2) % 3
    R[i, i], R[j, j], R[i, j], R[j, i] = c, c, -s, s
    return R


RATTLEBACK_AXES, RATTLEBACK_DROP = (0.2, 0.03, 0.02), 0.01
RATTLEBACK_INERTIA = np.array([[2e-4, -2e-5, 0], [-2e-5, 16e-4, 0], [0, 0, 17e-4]])  # matrix, kg m^2


def rattleback() -> Body:
    """A flat ellipsoid, its centre of mass below its centre, its inertia skewed; 1 kg, 0.2 x 0.03 x 0.02 m.

    The numbers are those of Kane and Levinson, Int. J. Non-Linear Mechanics 17 (1982), 175-186.
    """
    reach = ellipsoid_reach(written(*RATTLEBACK_AXES), offset=written(0, 0, RATTLEBACK_DROP))
    return Body(Real(1), reals(RATTLEBACK_INERTIA), reach)


def rattleback_start(roll: float = 0.02, pitch: float = 0.02, spin: float = -3.0) -> Array:
    """Rocked about both axes, R = Rx(roll) Ry(pitch), spinning about the vertical, its lowest point at rest.

    It turns back before 2 s, after wobbling hard.
    """
    rotation = turned(written(roll)[0], 0) @ turned(written(pitch)[0], 1)
    return start(rattleback(), rotation, [0, 0, spin])


TOP_RADIUS, TOP_MASS, TOP_OFFSET = 0.02, 0.02, 0.006


def tippe_top(mu: float = 0.3) -> Body:
    """A sphere whose centre of mass lies below its centre; z is its axis.

    20 g, 20 mm, 6 mm, C = 2/5 m r^2, A = 131/350 m r^2: Rauch-Wojciechowski, Skoldstam and Glad, Regular and
    Chaotic Dynamics 10 (2005), 333-362.
    """
    scale = written(TOP_MASS)[0] * written(TOP_RADIUS)[0] ** 2
    A, C = Real(131) / 350 * scale, Real(2) / 5 * scale
    reach = ellipsoid_reach(written(*[TOP_RADIUS] * 3), offset=written(0, 0, TOP_OFFSET))
    return Body(written(TOP_MASS)[0], np.diag(reals([A, A, C])), reach, written(mu)[0])


def tippe_top_start(tilt: float = 0.1, spin: float = 155.0, mu: float = 0.3) -> Array:
    """Its axis leans by the tilt about x; it spins about the vertical, its centre of mass at rest."""
    return start(tippe_top(mu), turned(written(tilt)[0], 0), [0, 0, spin], [0, 0, 0])


EGG_AXES, EGG_DENSITY = (0.02, 0.02, 0.03), 1000.0


def spinning_egg(mu: float = 0.1) -> Body:
    """A solid prolate spheroid, 0.02 x 0.02 x 0.03 m, of density 1000."""
    return solid_ellipsoid(written(*EGG_AXES), EGG_DENSITY, mu=written(mu)[0])


def spinning_egg_start(lean: float = 0.1, spin: float = 120.0, mu: float = 0.1) -> Array:
    """Its long axis is level but for the lean; it spins about the vertical, its centre at rest.

    It rises as Moffatt and Shimomura, Nature 416 (2002), 385-386 describe.
    """
    return start(spinning_egg(mu), turned(PI / 2 - written(lean)[0], 0), [0, 0, spin], [0, 0, 0])


def jellett(body: Body, x: Array) -> Any:
    """Angular momentum about the centre of mass times the arm to the contact: constant for a tippe top."""
    return (body.inertia @ x[W]) @ body.reach(x[GAMMA], x[GAMMA])[0]


def slid_then_rolled(body: Body, first: Array, times: Any, tolerance: float = 1e-15) -> tuple[Array, Any]:
    """States at the times of a top that slides and then rolls, and the time when it begins to roll."""
    end = slid_out(body, first, tolerance)
    before = [t for t in reals(times) if t <= end[T]]
    after = [t for t in reals(times) if t > end[T]]
    parts = [slid(body, first, before, tolerance) if before else None, rolled(body, end, after, tolerance)]
    return np.concatenate([part for part in parts if part is not None and len(part)]), end[T]
