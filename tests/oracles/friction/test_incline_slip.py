"""The closed form of slip that dies in two directions, against the equations of motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.oracles.friction.extrapolation import reals
from tests.oracles.friction.incline_slip import InclineSlip
from tests.oracles.friction.on_plane import Body, P, T, V, W, ellipsoid_reach, rotation_of, slid_out, start

RADIUS, MASS = 0.1, 2.0


@pytest.mark.parametrize("share", [3.5, 1.0])
@pytest.mark.parametrize("mu", [0.35, 0.6])
def test_it_solves_the_equation_of_slip(share: float, mu: float) -> None:
    thrown = InclineSlip(0.2, mu, np.array([0.3, 0.8]), np.array([0.3, 0.8]), share)
    assert thrown.kappa > 1

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        s = y[4:]
        pull, rub = 9.81 * np.array([np.sin(0.2), 0]), mu * 9.81 * np.cos(0.2) * s / np.linalg.norm(s)
        return np.concatenate([y[2:4], pull - rub, pull - share * rub])

    for part in (0.3, 0.9):
        t = part * thrown.end
        first = np.concatenate([[0, 0], thrown.v, thrown.s])
        ran = solve_ivp(slope, (0, t), first, "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
        way, v, slip = thrown.at(t)
        assert way == pytest.approx(ran[:2], abs=1e-12)
        assert v == pytest.approx(ran[2:4], abs=1e-12)
        assert slip == pytest.approx(ran[4:], abs=1e-12)
    way, v, slip = thrown.at(thrown.end)
    assert not slip.any()
    assert thrown.at(thrown.end * (1 - 1e-12))[0] == pytest.approx(way, abs=1e-11)
    assert share == 3.5 or v == pytest.approx([0, 0], abs=1e-13)


def test_a_ball_in_body_axes_comes_to_roll_there() -> None:
    angle, mu = 0.3, 0.3
    gravity = 9.81 * np.array([np.sin(angle), 0, -np.cos(angle)])
    w, v = np.array([4.0, -3.0, 9.0]), np.array([0.2, 0.5, 0.0])
    slip = v + np.cross(w, [0, 0, -RADIUS])
    assert slip[1] > 0
    thrown = InclineSlip(angle, mu, v[:2], slip[:2])
    inertia = np.diag(reals([0.4 * MASS * RADIUS**2] * 3))
    body = Body(MASS, inertia, ellipsoid_reach([RADIUS] * 3), mu, gravity=reals(gravity))
    end = slid_out(body, start(body, np.eye(3), w, v), 1e-15)
    R = rotation_of(end)
    way, velocity, _ = thrown.at(thrown.end)
    assert float(end[T]) == pytest.approx(thrown.end, abs=1e-13)
    assert end[P][:2].astype(float) == pytest.approx(way, abs=1e-13)
    assert (R @ end[V])[:2].astype(float) == pytest.approx(velocity, abs=1e-13)
    assert (R @ end[W])[2] == pytest.approx(9.0, abs=1e-13)


def test_a_block_stops_where_its_work_of_friction_has_taken_its_energy() -> None:
    thrown = InclineSlip(0.2, 0.5, np.array([-0.4, 0.6]), np.array([-0.4, 0.6]), share=1.0)
    times = thrown.end * (1 - np.linspace(1, 0, 2001) ** 2)
    way = np.array([thrown.at(t)[0] for t in times])
    length = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
    spent = 0.52 / 2 + thrown.downhill * way[-1, 0]
    assert spent == pytest.approx(0.5 * 9.81 * np.cos(0.2) * length, rel=1e-6)
