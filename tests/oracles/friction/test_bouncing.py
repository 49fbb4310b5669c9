"""The reference of the bouncing ellipsoid: what flights and blows conserve, and a second route."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from tests.oracles.friction.bouncing import bounced, bouncing_ellipsoid, height
from tests.oracles.friction.extrapolation import Array
from tests.oracles.friction.impact import inverse_mass, newton
from tests.oracles.friction.on_plane import Body, P, T, V, W, energy, rotation_of

TIMES = np.linspace(0, 1.2, 7)


def angular_momentum(body: Body, x: Array) -> Array:
    """About the centre of mass, world."""
    return rotation_of(x) @ (body.inertia @ x[W])


def test_without_friction_elastic_blows_keep_energy_level_momentum_and_vertical_spin() -> None:
    body, first = bouncing_ellipsoid(0.0)
    states, blows = bounced(body, first, TIMES, 1.0)
    assert len(blows) >= 3
    for x in states:
        assert float(sum(energy(body, x))) == pytest.approx(float(sum(energy(body, first))), rel=1e-14)
        assert (rotation_of(x) @ x[V])[:2].astype(float) == pytest.approx([0.5, 0], abs=1e-15)
        spin = angular_momentum(body, x)[2] / angular_momentum(body, first)[2]
        assert float(spin) == pytest.approx(1, abs=1e-14)
        assert float(height(body, x)) > 0


@pytest.mark.cases(1)
@pytest.mark.parametrize(("mu", "e", "until"), [(0.2, 0.8, 1.2), (0.05, 0.5, 0.45), (1.0, 0.7, 0.85)])
def test_blows_take_the_energy_that_their_impulses_tell(mu: float, e: float, until: float) -> None:
    body, first = bouncing_ellipsoid(mu)
    states, blows = bounced(body, first, np.linspace(0, until, 7), e)
    assert len(blows) >= 2
    assert all(float(height(body, x)) > 0 for x in states)
    for blow in blows:
        work = float(blow.impulse @ (blow.before + blow.after)) / 2
        assert -work == pytest.approx(float(blow.taken), rel=1e-12)
        assert float(blow.after[2]) == pytest.approx(-e * float(blow.before[2]), rel=1e-12)
        assert float(blow.taken) > 0
    taken = sum(blow.taken for blow in blows)
    lost = sum(energy(body, states[-1])) + taken - sum(energy(body, first))
    assert float(lost) == pytest.approx(0, abs=1e-14)


def second_route(mu: float, e: float, until: float) -> tuple[list[float], Array]:
    """Times of blows and the last place, by quaternions in the world with SciPy."""
    axes = np.array([0.10, 0.07, 0.05])
    mass = 4 / 3 * np.pi * axes.prod() * 1000
    inertia = np.diag(mass / 5 * ((axes**2).sum() - axes**2))

    def slope(_: float, s: Array) -> Array:
        R = Rotation.from_quat(s[6:10]).as_matrix()
        w = R @ np.linalg.solve(inertia, R.T @ s[10:])
        quaternion = np.array([*(s[9] * w + np.cross(w, s[6:9])), -w @ s[6:9]]) / 2
        return np.concatenate([s[3:6], [0, 0, -9.81], quaternion, np.zeros(3)])

    def gap(_: float, s: Array) -> float:
        R = Rotation.from_quat(s[6:10]).as_matrix()
        return float(s[2] - np.linalg.norm(axes * R[2]))

    gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
    R = Rotation.from_rotvec([0.3, 0, 0]).as_matrix()
    spin = R @ inertia @ R.T @ [1, 0, 6]
    s = np.array([0, 0, 0.3, 0.5, 0, 0, *Rotation.from_matrix(R).as_quat(), *spin])
    t, blows = 0.0, []
    while True:
        ran = solve_ivp(slope, (t, until), s, "DOP853", events=[gap], rtol=1e-13, atol=1e-14)
        t, s = ran.t[-1], ran.y[:, -1]
        if ran.status == 0:
            return blows, s[:3]
        blows.append(float(t))
        R = Rotation.from_quat(s[6:10]).as_matrix()
        arm = -R @ (axes**2 * R[2]) / np.linalg.norm(axes * R[2])
        w = R @ np.linalg.solve(inertia, R.T @ s[10:])
        u = s[3:6] + np.cross(w, arm)
        impulse = newton(inverse_mass(mass, inertia, R, arm), u, e, mu)[0][0]
        s[3:6] += impulse / mass
        s[10:] += np.cross(arm, impulse)


@pytest.mark.slow
def test_blows_without_end_are_refused() -> None:
    with pytest.raises(AssertionError, match="without end"):
        bounced(*bouncing_ellipsoid(0.05), [0.6], 0.5)


@pytest.mark.slow
@pytest.mark.parametrize(("mu", "e"), [(0.0, 1.0), (0.2, 0.8)])
def test_flights_with_angular_momentum_in_the_world_meet_the_plane_alike(mu: float, e: float) -> None:
    body, first = bouncing_ellipsoid(mu)
    states, blows = bounced(body, first, TIMES, e)
    times, place = second_route(mu, e, TIMES[-1])
    assert times == pytest.approx([float(blow.t) for blow in blows], abs=1e-10)
    assert place == pytest.approx(states[-1][P].astype(float), abs=1e-9)
    assert float(states[-1][T]) == pytest.approx(TIMES[-1])
