"""The references of rolling discs: published numbers, steady motions, a second formulation."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracles.friction.disc import Disc, rolls_straight_above, spins_upright_above
from tests.oracles.friction.extrapolation import Array, Real, reals
from tests.oracles.friction.lagrange_route import LagrangeRoute, circle_support
from tests.oracles.friction.on_plane import HEAT, Body, P, circle_reach, energy, rolled, rotation_of, start

COIN = Disc(Real("0.01"))


def coin_of_the_paper() -> Array:
    tilt, spin = np.pi * Real(1) / 180, 10 * np.pi * Real(1)
    turning = spin * reals([np.cos(tilt), -np.sin(tilt)])
    return reals([COIN.radius * np.sin(tilt), 0, np.pi / 2, np.pi / 2 + tilt, 0, 0, *turning])


def test_a_coin_rolls_as_published() -> None:
    state = COIN.run(coin_of_the_paper(), [0.5])[0]
    centre, contact = COIN.centre(state).astype(float), COIN.contact(state).astype(float)
    assert centre == pytest.approx([8.27529183556e-05, 0.00158178190055, 0.00976087384263], abs=1e-11)
    assert contact[:2] == pytest.approx([0.00200494702065, 0.00259692310364], abs=1e-11)
    force = COIN.rates(state)[1].astype(float)
    assert force == pytest.approx([-0.807813489485, -0.634913784517, 9.83551980688], abs=1e-8)


def test_the_critical_speeds_are_the_published_ones() -> None:
    assert rolls_straight_above(0.1) == pytest.approx(5.718391382, abs=1e-9)
    assert rolls_straight_above(0.1, inertia=1.0) == pytest.approx(np.sqrt(9.81 / 0.4), rel=1e-15)
    assert spins_upright_above(0.1) == pytest.approx(8.858893836, abs=1e-9)
    assert spins_upright_above(0.1, friction=False) == pytest.approx(19.80908882, abs=1e-8)


@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_upright_motions_change_stability_there(factor: float) -> None:
    disc = Disc(Real("0.1"))
    straight = reals([0, 0, 0, np.pi / 2, 0, 0, 0, factor * rolls_straight_above(0.1)])
    upright = reals([0, 0, 0, np.pi / 2, 0, 0, factor * spins_upright_above(0.1), 0])
    assert (disc.nutation(straight) > 0) == (disc.nutation(upright) > 0) == (factor > 1)


@pytest.mark.parametrize(("alpha", "precession"), [(1.1, 6.0), (0.5, 20.0), (0.3, -15.0)])
def test_a_steady_motion_stays_and_nutates_at_its_rate(alpha: float, precession: float) -> None:
    disc = Disc(Real("0.1"))
    steady = disc.steady(alpha, precession)
    assert np.abs(disc.rates(steady)[0][5:]).max() < 1e-15
    rate = np.sqrt(disc.nutation(steady))
    nudged = steady + 1e-6 * reals([0, 0, 0, 0, 0, 1, 0, 0])
    # w1 is 0 again after half a nutation, and turned after a whole one
    half, whole = disc.run(nudged, [np.pi / 2 / rate, 2 * np.pi / rate])
    assert abs(half[5]) < 1e-10
    assert whole[5] == pytest.approx(1e-6, rel=1e-5)


def resisting(disc: Disc) -> Body:
    inertia = np.diag(disc.diameter * reals([1, 1, 2]))
    resistances = {
        "rolling_resistance": disc.rolling_resistance,
        "spinning_resistance": disc.spinning_resistance,
    }
    return Body(disc.mass, inertia, circle_reach(disc.radius, [0, 0, 1]), **resistances)


@pytest.mark.slow
@pytest.mark.parametrize("resistance", [(0.0, 0.0), (2e-3, 0.0), (1e-3, 5e-4)])
def test_three_formulations_roll_a_disc_alike(resistance: tuple[float, float]) -> None:
    disc = Disc(Real("0.1"), Real("0.4"), *reals(resistance))
    first, times = reals([0, 0, 0.4, 1.0, 0.2, 0.5, 7.0, -4.0]), np.linspace(0, 1, 5)
    ours = disc.run(first, times)
    R, w = disc.rotation(first), disc.frame(first) @ first[5:]
    body = resisting(disc)
    theirs = rolled(body, start(body, R, w), times, 1e-16)
    route = LagrangeRoute(
        circle_support(0.1, [0, 0, 1]), 0.4, 0.001 * np.diag([1.0, 1.0, 2.0]), resistance=resistance
    )
    p, turned, _, _ = route.run(*route.start(R, w.astype(float)), times)
    for k, state in enumerate(ours):
        assert np.abs(disc.centre(state) - theirs[k, P]).max() < 1e-14
        assert np.abs(disc.rotation(state) - rotation_of(theirs[k])).max() < 1e-13
        assert np.abs(disc.centre(state) - p[k]).max() < 1e-10
        assert np.abs(disc.rotation(state) - turned[k]).max() < 1e-9
    spent = sum(energy(body, theirs[0])) - sum(energy(body, theirs[-1]))
    assert float(spent) == pytest.approx(float(theirs[-1, HEAT]), abs=1e-15)
    assert float(disc.energy(ours[0]) - disc.energy(ours[-1])) == pytest.approx(float(spent), abs=1e-15)


@pytest.mark.slow
def test_eulers_disk_comes_to_lie_flat_in_about_the_time_of_its_energy() -> None:
    disc = Disc(Real("0.0375"), Real("0.44"), rolling_resistance=Real("2e-4"))
    first = disc.steady(0.06, np.sqrt(4 * 9.81 / (0.0375 * 0.06)))
    end = disc.settles_after(Real("0.06"))
    tilts = disc.run(first, [0, end / 4, end / 2], 1e-14)[:, 3]
    # alpha falls as the square of the time that is left
    assert (np.sqrt(tilts / tilts[0])).astype(float) == pytest.approx([1, 0.75, 0.5], abs=0.02)
