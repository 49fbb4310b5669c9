"""The reference of slip that begins gently in two directions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.oracles.friction.gentle_slip import DEGREE, REACH, GentleSlip

PULLED = GentleSlip()


def test_the_series_solves_the_equation_and_has_converged() -> None:
    assert np.hypot(*PULLED.pull(PULLED.begins)) == pytest.approx(PULLED.limit, abs=1e-14)
    assert np.abs(PULLED.series[-4:]).max() < 1e-12
    assert len(PULLED.series) == DEGREE + 1
    h = 1e-4
    for tau in (0.003, 0.02, 0.04):
        t = PULLED.begins + tau
        (x0, v0), (x1, v1), (_, v) = PULLED.at(t - h), PULLED.at(t + h), PULLED.at(t)
        friction = PULLED.limit * v / np.linalg.norm(v)
        assert (v1 - v0) / (2 * h) == pytest.approx(PULLED.pull(t) - friction, abs=1e-6)
        assert (x1 - x0) / (2 * h) == pytest.approx(v, abs=1e-7)


def test_it_begins_as_half_the_growth_of_the_pull_along_it() -> None:
    tau = 1e-6
    _, v = PULLED.at(PULLED.begins + tau)
    along = PULLED.pull(PULLED.begins) / PULLED.limit
    rate = np.array([PULLED.along, 2 * PULLED.across * PULLED.begins])
    # v = tau^2 (f'.e) / 2 along e at first
    assert v @ along / tau**2 == pytest.approx(rate @ along / 2, rel=1e-4)


@pytest.mark.cases(2)
@pytest.mark.parametrize("pulled", [PULLED, GentleSlip(0.5, 1.0, -2.0), GentleSlip(0.2, 3.0, 0.0)])
def test_other_slips_come_to_this_one(pulled: GentleSlip) -> None:
    begin, early = pulled.begins, 1e-5

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[2:], pulled.pull(t) - pulled.limit * y[2:] / np.linalg.norm(y[2:])])

    way, v = pulled.at(begin + early)
    for end in (begin + REACH / 2, begin + 0.5):
        first = np.concatenate([way, 1.2 * v])
        ran = solve_ivp(slope, (begin + early, end), first, "Radau", rtol=1e-10, atol=1e-16).y[:, -1]
        assert pulled.at(end)[0] == pytest.approx(ran[:2], abs=1e-9)
        assert pulled.at(end)[1] == pytest.approx(ran[2:], abs=2e-9)


def test_a_pull_that_does_not_turn_is_the_straight_one() -> None:
    pulled = GentleSlip(0.2, 3.0, 0.0)
    way, v = pulled.at(pulled.begins + 0.4)
    assert v == pytest.approx([3.0 * 0.16 / 2, 0], abs=1e-13)
    assert way == pytest.approx([3.0 * 0.064 / 6, 0], abs=1e-13)
