"""A convex body that bounces on the plane: flights in long double, Newton's blows with Coulomb friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.oracles.friction.extrapolation import Array, Real, marched, reals
from tests.oracles.friction.impact import inverse_mass, newton
from tests.oracles.friction.on_plane import (
    AXES,
    GAMMA,
    Body,
    P,
    T,
    V,
    W,
    energy,
    flies,
    motion,
    rotation_of,
    solid_ellipsoid,
)

DENSITY = 1000.0
LONGEST, LEAST, ROUNDING = 0.02, 1e-6, 1e-17  # longest piece of a flight, s; least speed of leaving, m/s; s


@dataclass(frozen=True)
class Blow:
    """When, the impulse (world), the velocity of the lowest point before and after, and the energy taken."""

    t: Any
    impulse: Array
    before: Array
    after: Array
    taken: Any


def height(body: Body, x: Array) -> Any:
    """Of the lowest point over the plane."""
    return x[P][2] + x[GAMMA] @ body.reach(x[GAMMA], x[GAMMA])[0]


def lowest(body: Body, x: Array) -> Array:
    """Velocity of the lowest point, world."""
    r = body.reach(x[GAMMA], x[GAMMA])[0]
    spun = reals(np.cross(x[W].astype(float), r.astype(float)))
    return rotation_of(x) @ (x[V] + spun)


def start(p: Any, R: Any, v: Any, w: Any) -> Array:
    """A state in flight: place, rotation, velocity and angular velocity in the world."""
    x, turned = np.zeros(20, dtype=Real), reals(R)
    x[P], x[AXES] = reals(p), turned.ravel()
    x[V], x[W] = turned.T @ reals(v), turned.T @ reals(w)
    return x


def struck(body: Body, x: Array, e: float) -> tuple[Array, Blow]:
    """The state after a blow; the law must have one answer."""
    R = rotation_of(x)
    arm = R @ body.reach(x[GAMMA], x[GAMMA])[0]
    G = inverse_mass(float(body.mass), body.inertia.astype(float), R.astype(float), arm.astype(float))
    before = lowest(body, x)
    ((impulse, _),) = newton(G, before.astype(float), e, float(body.mu))
    after = x.copy()
    after[V] += R.T @ reals(impulse) / body.mass
    torque = R.T @ reals(np.cross(arm.astype(float), impulse))
    after[W] += torque / np.diag(body.inertia)
    taken = sum(energy(body, x)) - sum(energy(body, after))
    return after, Blow(x[T], impulse, before, lowest(body, after), taken)


def bounced(body: Body, x: Array, times: Any, e: float, tolerance: float = 1e-16) -> tuple[Array, list[Blow]]:
    """States at the times, and the blows up to the last; before blows follow each other without end.

    The principal axes of inertia are the body's.
    """
    slope, states, blows = motion(body, flies), [], []
    for t in reals(times):
        while t - x[T] > ROUNDING:
            began = (x[T], lowest(body, x)[2]) if blows and blows[-1].t == x[T] else None
            gap = lambda y, began=began: _mean_rate(body, y, began)  # noqa: E731
            x, _, which = marched(slope, x, min(t - x[T], LONGEST), (gap,), tolerance)
            if which == 0:
                x, blow = struck(body, x, e)
                assert blow.after[2] > LEAST, "blows without end"
                blows.append(blow)
        states.append(x)
    return np.array(states), blows


def _mean_rate(body: Body, x: Array, began: Any) -> Any:
    """The height, over the time since a blow at (time, rate): not zero when the flight begins."""
    if began is None:
        return height(body, x)
    return began[1] if x[T] == began[0] else height(body, x) / (x[T] - began[0])


def bouncing_ellipsoid(mu: float) -> tuple[Body, Array]:
    """Let go 0.3 m high, leaning, with a sideways speed and spin."""
    body = solid_ellipsoid(reals(["0.10", "0.07", "0.05"]), DENSITY, mu=mu)
    c, s = np.cos(Real("0.3")), np.sin(Real("0.3"))
    tilt = [[1, 0, 0], [0, c, -s], [0, s, c]]
    return body, start(reals(["0", "0", "0.3"]), tilt, reals(["0.5", "0", "0"]), [1, 0, 6])
