"""A convex rigid body that rolls or slides on the plane z = 0, in body axes, in long double.

The state is x = [t, p (centre of mass, world), alpha, beta, gamma (the world's axes seen from the body), V
(its velocity, body axes), w (angular velocity, body axes), heat]. With r(gamma) from the centre of mass to
the lowest point (Borisov and Mamaev, Regular and Chaotic Dynamics 7 (2002), 177-200):

    m (V' + w x V) = F + m R^T g,   I w' + w x I w = r x F + torque,   gamma' = gamma x w.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tests.oracles.friction.extrapolation import Array, Field, Real, cross, marched, reals, solved

T, P, AXES, V, W, HEAT = 0, slice(1, 4), slice(4, 13), slice(13, 16), slice(16, 19), 19
GAMMA = slice(10, 13)
GRAVITY, PI = Real("9.81"), Real("3.14159265358979323846264338")

Reach = Callable[[Array, Array], tuple[Array, Array]]  # (gamma, gamma') -> (r, r')


def ellipsoid_reach(axes: Any, frame: Any = None, offset: Any = (0, 0, 0)) -> Reach:
    """Of an ellipsoid whose axes are the columns of `frame` and whose centre lies at `offset`, body axes."""
    Q = reals(np.eye(3) if frame is None else frame)
    B, c = Q @ np.diag(reals(axes) ** 2) @ Q.T, reals(offset)

    def reach(gamma: Array, rate: Array) -> tuple[Array, Array]:
        size = np.sqrt(gamma @ B @ gamma)
        point = B @ gamma / size
        return c - point, (point * (point @ rate) - B @ rate) / size

    return reach


def circle_reach(radius: Any, axis: Any) -> Reach:
    """Of a circle about an axis through the centre of mass: a disc without thickness."""
    e, R = reals(axis), Real(radius)

    def reach(gamma: Array, rate: Array) -> tuple[Array, Array]:
        across = gamma - (gamma @ e) * e
        turn = rate - (rate @ e) * e
        size = np.sqrt(across @ across)
        return -R * across / size, -R * (turn - across * (across @ turn) / size**2) / size

    return reach


@dataclass(frozen=True)
class Body:
    """Coulomb friction with `mu` when sliding; resistances in m against rolling and spinning."""

    mass: Any
    inertia: Array
    reach: Reach
    mu: Any = 0.0
    rolling_resistance: Any = 0.0
    spinning_resistance: Any = 0.0
    gravity: Array = field(default_factory=lambda: reals([0, 0, -GRAVITY]))  # world axes


@dataclass(frozen=True)
class Contact:
    """What the ground does: force (body axes), slip velocity, accelerations."""

    force: Array
    normal: Any
    slip: Array
    V_rate: Array
    w_rate: Array
    power: Any


def start(body: Body, rotation: Any, w: Any, v: Any = None, p: Any = (0, 0, 0)) -> Array:
    """On the plane, lowest point under or over p: rotation body -> world, w and v in the world.

    Without v the lowest point is at rest. p gives x and y of the centre of mass.
    """
    R = reals(rotation)
    x = np.zeros(20, dtype=Real)
    x[AXES] = R.ravel()
    x[W] = R.T @ reals(w)
    r = body.reach(R[2], R[2])[0]
    x[P] = reals([p[0], p[1], -(R[2] @ r)])
    x[V] = cross(r, x[W]) if v is None else R.T @ reals(v)
    return x


def rotation_of(x: Array) -> Array:
    return x[AXES].reshape(3, 3)


def resistance(body: Body, gamma: Array, w: Array) -> Array:
    """The torque per normal force of rolling and spinning resistance."""
    spin = w @ gamma
    rolling = w - spin * gamma
    speed = np.sqrt(rolling @ rolling)
    torque = np.zeros(3, dtype=Real)
    if body.rolling_resistance and speed > 0:
        torque -= body.rolling_resistance * rolling / speed
    return torque - body.spinning_resistance * np.sign(spin) * gamma


def rolls(body: Body, x: Array) -> Contact:
    """The lowest point stays at rest: V = r x w."""
    gamma, w, m = x[GAMMA], x[W], body.mass
    r, turn = body.reach(gamma, cross(gamma, w))
    drag = resistance(body, gamma, w)
    carried = m * (cross(turn, w) + cross(w, cross(r, w)) - body.gravity @ rotation_of(x))
    cross_r = reals([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    A = body.inertia - m * cross_r @ cross_r - m * np.outer(drag, gamma @ cross_r)
    w_rate = solved(A, -cross(w, body.inertia @ w) + cross(r, carried) + drag * (gamma @ carried))
    force = carried + m * cross(r, w_rate)
    normal = gamma @ force
    V_rate = cross(turn, w) + cross(r, w_rate)
    return Contact(force, normal, x[V] + cross(w, r), V_rate, w_rate, -normal * (drag @ w))


def slides(body: Body, x: Array) -> Contact:
    """Coulomb's law against the slip; the normal force keeps the lowest point on the plane."""
    gamma, w, m = x[GAMMA], x[W], body.mass
    falling = cross(gamma, w)
    r, turn = body.reach(gamma, falling)
    slip = x[V] + cross(w, r)
    tangent = slip - (slip @ gamma) * gamma
    speed = np.sqrt(tangent @ tangent)
    push = gamma - body.mu * tangent / speed if body.mu else gamma
    torque = cross(r, push) + resistance(body, gamma, w)
    free_V = body.gravity @ rotation_of(x) - cross(w, x[V])
    free_w = solved(body.inertia, -cross(w, body.inertia @ w))
    per_w = solved(body.inertia, torque)
    own = gamma @ (free_V + cross(free_w, r) + cross(w, turn)) + falling @ slip
    normal = -own / (gamma @ (push / m + cross(per_w, r)))
    power = -normal * (slip @ (push - gamma) + w @ resistance(body, gamma, w))
    return Contact(normal * push, normal, tangent, free_V + normal * push / m, free_w + normal * per_w, power)


def flies(body: Body, x: Array) -> Contact:
    """Nothing touches."""
    zero, w = np.zeros(3, dtype=Real), x[W]
    w_rate = solved(body.inertia, -cross(w, body.inertia @ w))
    return Contact(zero, Real(0), zero, body.gravity @ rotation_of(x) - cross(w, x[V]), w_rate, Real(0))


Mode = Callable[[Body, Array], Contact]


def motion(body: Body, mode: Mode, slow: Any = 0) -> Field:
    """The right-hand side; with `slow` time runs as |s| / (|s| + slow), so that dying slip never dies."""

    def slope(x: Array) -> Array:
        contact = mode(body, x)
        R, w = rotation_of(x), x[W]
        pace = Real(1)
        if slow:
            speed = np.sqrt(contact.slip @ contact.slip)
            pace = speed / (speed + slow)
        turns = [cross(row, w) for row in R]
        rates = [[1], R @ x[V], *turns, contact.V_rate, contact.w_rate, [contact.power]]
        return pace * np.concatenate(rates).astype(Real)

    return slope


def energy(body: Body, x: Array) -> tuple[Any, Any]:
    """Kinetic and potential energy."""
    kinetic = (body.mass * (x[V] @ x[V]) + x[W] @ body.inertia @ x[W]) / 2
    return kinetic, -body.mass * (body.gravity @ x[P])


def slid_out(body: Body, x: Array, tolerance: float = 1e-17) -> Array:
    """The state in which slip has died, at the time it dies; friction must not let it revive before."""
    scale = np.sqrt(slides(body, x).slip @ slides(body, x).slip)
    stop = lambda y: speed_of(body, y) - Real(1e-15) * scale  # noqa: E731
    y, _, which = marched(motion(body, slides, slow=scale), x, 1000, (stop,), tolerance)
    assert which == 0, "the slip does not die"
    r = body.reach(y[GAMMA], y[GAMMA])[0]
    y[V] = cross(r, y[W])
    return y


def speed_of(body: Body, x: Array) -> Any:
    """|s|."""
    slip = slides(body, x).slip
    return np.sqrt(slip @ slip)


def slid(body: Body, x: Array, times: Any, tolerance: float = 1e-17) -> Array:
    """States at the times, sliding throughout."""
    scale, states = speed_of(body, x), []
    pace = motion(body, slides, slow=scale)
    for t in reals(times):
        if t > x[T]:
            x, _, which = marched(pace, x, 1000, (lambda y, t=t: t - y[T],), tolerance)
            assert which == 0, "the slip dies before"
        states.append(x)
    return np.array(states)


def rolled(body: Body, x: Array, times: Any, tolerance: float = 1e-17) -> Array:
    """States at the times, rolling throughout."""
    slope, states = motion(body, rolls), []
    for t in reals(times):
        x = marched(slope, x, t - x[T], tolerance=tolerance)[0] if t > x[T] else x
        states.append(x)
    return np.array(states)


def solid_ellipsoid(axes: Any, density: Any, **options: Any) -> Body:
    """A homogeneous solid ellipsoid."""
    a = reals(axes)
    m = 4 * PI / 3 * np.prod(a) * Real(density)
    square = a**2
    inertia = np.diag(m / 5 * (square.sum() - square))
    return replace(Body(m, inertia, ellipsoid_reach(a)), **options)
