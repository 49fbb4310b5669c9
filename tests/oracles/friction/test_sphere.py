"""The references of balls: published numbers, the equations of motion in body axes, and what is conserved."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.oracles.friction.extrapolation import reals
from tests.oracles.friction.on_plane import (
    HEAT,
    Body,
    P,
    T,
    V,
    W,
    ellipsoid_reach,
    energy,
    rotation_of,
    slid,
    slid_out,
    start,
)  # fmt: skip
from tests.oracles.friction.sphere import PushedBox, SlideToRoll, Turntable, released_on_incline

RADIUS, MASS = 0.1, 2.0


def ball(mu: float, gravity: object = (0, 0, -9.81)) -> Body:
    inertia = np.diag(reals([0.4 * MASS * RADIUS**2] * 3))
    return Body(MASS, inertia, ellipsoid_reach([RADIUS] * 3), mu, gravity=reals(gravity))


def test_a_thrown_ball_comes_to_roll_as_published() -> None:
    thrown = SlideToRoll(0.1, 0.2, np.array([0, 0, 0.1]), np.array([3.0, 0, 0]), np.zeros(3))
    p, v, w = thrown.at(thrown.rolls_at)
    assert thrown.rolls_at == pytest.approx(0.436871996505, abs=1e-12)
    assert v[0] == pytest.approx(2.14285714286, abs=1e-11)
    assert p[0] == pytest.approx(1.12338513387, abs=1e-11)
    assert w == pytest.approx([0, v[0] / 0.1, 0], abs=1e-13)


@pytest.mark.cases(1)
@pytest.mark.parametrize(
    ("v", "w", "mu"),
    [
        ((3.0, -1.0), (5.0, 20.0, 30.0), 0.3),
        ((-0.2, 0.5), (-9.0, 0.0, 0.0), 1.0),
        ((0.0, 0.0), (0.0, 1.0, -4.0), 0.05),
    ],
)
def test_a_ball_with_any_spin_slides_straight_into_rolling(
    v: tuple[float, float], w: tuple[float, float, float], mu: float
) -> None:
    thrown = SlideToRoll(RADIUS, mu, np.array([0, 0, RADIUS]), np.array([*v, 0.0]), np.array(w))
    body = ball(mu)
    begin = start(body, np.eye(3), w, thrown.v)
    half = slid(body, begin, [thrown.rolls_at / 2], 1e-15)[0]
    assert half[P].astype(float) == pytest.approx(thrown.at(thrown.rolls_at / 2)[0], abs=1e-13)
    end = slid_out(body, begin, 1e-15)
    p, velocity, spin = thrown.at(thrown.rolls_at)
    R = rotation_of(end)
    assert float(end[T]) == pytest.approx(thrown.rolls_at, abs=1e-12)
    assert (R @ end[V]).astype(float) == pytest.approx(velocity, abs=1e-12)
    assert (R @ end[W]).astype(float) == pytest.approx(spin, abs=1e-11)
    assert end[P].astype(float) == pytest.approx(p, abs=1e-12)
    assert float(sum(energy(body, end)) + end[HEAT] - sum(energy(body, begin))) == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize(("angle", "mu"), [(0.3, 0.2), (0.9, 0.2), (0.6, 0.19545), (0.6, 0.19547)])
def test_a_ball_let_go_on_an_incline_satisfies_newton_and_coulomb(angle: float, mu: float) -> None:
    rolls, a, turn = released_on_incline(angle, mu, RADIUS)
    friction = 9.81 * np.sin(angle) - a
    assert 0.4 * RADIUS * turn == pytest.approx(friction, rel=1e-14)
    assert friction <= mu * 9.81 * np.cos(angle) * (1 + 1e-14)
    assert (a - RADIUS * turn == pytest.approx(0, abs=1e-14)) == rolls
    assert rolls == (np.tan(angle) <= 3.5 * mu)


def test_the_turntable_is_the_published_circle_and_solves_the_equations_of_motion() -> None:
    table = Turntable(3.0, np.array([0.2, 0, 0.05]), np.array([0, 0.4, 0]))
    assert table.centre[:2] == pytest.approx([-0.266666666667, 0.0], abs=1e-12)
    assert np.linalg.norm((table.p - table.centre)[:2]) == pytest.approx(0.466666666667, abs=1e-12)
    assert 2 * np.pi / table.rate == pytest.approx(7.33038285838, abs=1e-11)

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        # d/dt of v - r w x z = turn z x p with m v' = f and 2/5 m r^2 w' = -r z x f: f = 2/7 m turn z x v
        pushed = 2 / 7 * np.cross([0, 0, 3.0], y[3:6])
        return np.concatenate([y[3:6], pushed, np.cross([0, 0, -0.05], pushed) / (0.4 * 0.05**2)])

    first = np.concatenate([table.p, table.v, table.spin(0.05, table.p, table.v)])
    times = np.linspace(0, 10, 21)
    ran = solve_ivp(slope, (0, 10), first, "DOP853", times, rtol=1e-13, atol=1e-14).y
    assert np.abs(table.path(times) - ran[:3].T).max() < 1e-12
    for p, v, w in zip(ran[:3].T, ran[3:6].T, ran[6:].T, strict=True):
        assert w == pytest.approx(table.spin(0.05, p, v), abs=1e-10)


def test_the_pushed_box_is_the_published_one() -> None:
    assert PushedBox().accelerations == pytest.approx((0.7385, 0.211, 0.0215086646279), abs=1e-12)
