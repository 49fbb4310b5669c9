"""The reference of a wheel on a rail: splines, the straight motion, energy, and an ellipsoid on a plane."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

from tests.oracles.friction.wheel_on_rail import HEAD, TREAD, WheelOnRail, spline

UPRIGHT = np.roll(Rotation.from_euler("x", -np.pi / 2).as_quat(), 1)  # the axle, body z, along world y


def turned(*angles: float) -> np.ndarray:
    """The upright wheel turned about x and then z."""
    both = Rotation.from_euler("xz", angles) * Rotation.from_quat(np.roll(UPRIGHT, -1))
    return np.roll(both.as_quat(), 1)


@pytest.mark.parametrize("points", [TREAD, HEAD])
def test_profiles_are_clamped_uniform_cubic_splines(points: list[tuple[float, float]]) -> None:
    t = ca.SX.sym("t")
    ours = ca.Function("f", [t], [spline(points, t)])
    knots = np.concatenate([np.zeros(3), np.linspace(0, 1, len(points) - 2), np.ones(3)])
    theirs = BSpline(knots, np.array(points), 3)
    for value in np.linspace(0, 1, 23):
        assert np.array(ours(value)).ravel() == pytest.approx(theirs(value), abs=1e-15)


def test_a_wheel_rolls_straight() -> None:
    wheel = WheelOnRail()
    knots = [0, 0, 0, 0, 1 / 3, 2 / 3, 1, 1, 1, 1]
    radius, top = (float(BSpline(knots, np.array(points), 3)(0.5)[1]) for points in (TREAD, HEAD))
    p = wheel.place(np.array([0, 0, 0.46]), UPRIGHT)
    assert p[2] == pytest.approx(radius + top, abs=1e-12)
    states = wheel.run(p, UPRIGHT, [0, 10 / radius, 0], np.array([0, 0.2]))
    assert states[-1, :3] == pytest.approx([2.0, 0, radius + top], abs=1e-10)
    assert states[-1, 7:] == pytest.approx([0, 10 / radius, 0], abs=1e-9)
    _, v, force = wheel.slope(p, UPRIGHT, np.array([0, 10 / radius, 0]))
    assert v == pytest.approx([10, 0, 0])
    assert force == pytest.approx([0, 0, 400 * 9.81], abs=1e-9)


def test_a_wheel_that_leans_and_yaws_keeps_its_energy_and_its_contact() -> None:
    wheel = WheelOnRail()
    e = turned(0.004, 0.002)
    p = wheel.place(np.array([0, 0.001, 0.46]), e)
    axle = np.array(wheel._rotation(e))[:, 2]
    states = wheel.run(p, e, 22 * axle, np.linspace(0, 0.5, 6))
    energies = [wheel.energy(state) for state in states]
    assert np.abs(np.array(energies) / energies[0] - 1).max() < 1e-11
    for state in states:
        assert abs(wheel.contact(state[:3], state[3:7])[2]) < 1e-11
    assert np.ptp(states[:, 1]) > 1e-4


@pytest.mark.slow
def test_a_spheroid_on_a_flat_rail_is_an_ellipsoid_on_a_plane() -> None:
    """A wheel whose profile is fitted to a spheroid's, near enough to its equator to tell."""
    from tests.oracles.friction.extrapolation import reals
    from tests.oracles.friction.on_plane import Body, P, ellipsoid_reach, rolled, start

    # the parabola r = a - h^2 / (2 rho) as one Bezier piece; the ellipsoid has the same curvature
    a, rho, half = 0.1, 0.05, 0.04
    drop = half**2 / (2 * rho)
    tread = [(-half, a - drop), (-half / 3, a + drop / 3), (half / 3, a + drop / 3), (half, a - drop)]
    rail = [(y, 0.0) for y in np.linspace(-0.5, 0.5, 4)]
    wheel = WheelOnRail(tread, rail, 1.0, (0.003, 0.003, 0.005))
    c = float(np.sqrt(a * rho))
    body = Body(1.0, np.diag(reals([0.003, 0.003, 0.005])), ellipsoid_reach([a, a, c]))
    for lean, bound in ((0.02, 3e-5), (0.01, 4e-6)):
        e = turned(lean, 0.0)
        R = np.array(wheel._rotation(e))
        w = R @ [0, 0, 20.0]
        p = wheel.place(np.array([0, 0, a]), e)
        ours = wheel.run(p, e, w, np.array([0, 0.5]))[-1, :3]
        theirs = rolled(body, start(body, R, w, p=p[:2]), [0.5], 1e-14)[-1][P].astype(float)
        # fourth-order terms of the profiles differ: contact off by lean^3
        assert np.abs(ours - theirs).max() < bound
