"""The references along a line: each piece obeys Newton and Coulomb, and meets the next."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracles.friction.stick_slip import (
    SLIP,
    STICK,
    BeltOscillator,
    Motion,
    PulledToAndFro,
    pulled_harder,
    thrown_up_incline,
)  # fmt: skip


def obeys(motion: Motion, until: float, accel: object, surface: float = 0.0) -> None:
    """Pieces are continuous in place and speed; `accel(t, x, mode, side)` is each slip's acceleration."""
    bounds = [piece.start for piece in motion.pieces] + [until]
    for piece, start, end in zip(motion.pieces, bounds[:-1], bounds[1:], strict=True):
        if end <= start:
            continue
        lasts = end - start
        for share in (0.2, 0.5, 0.8):
            s, h = share * lasts, 1e-4 * lasts
            x, v = piece.at(s)
            before, after = piece.at(s - h), piece.at(s + h)
            assert (after[0] - before[0]) / (2 * h) == pytest.approx(v, abs=1e-6)
            if piece.mode == SLIP:
                side = np.sign(v - surface)
                slope = (after[1] - before[1]) / (2 * h)
                assert slope == pytest.approx(accel(start + s, x, side), abs=1e-5)  # type: ignore[operator]
            else:
                assert v == surface
    for before_piece, piece in zip(motion.pieces, motion.pieces[1:], strict=False):
        assert before_piece.at(piece.start - before_piece.start) == pytest.approx(piece.at(0.0), abs=1e-13)


@pytest.mark.parametrize(("x", "v"), [(0.0, 0.2), (0.0, 0.0), (-0.08, 0.2), (0.05, 1.5), (0.03, -0.4)])
def test_a_block_on_a_belt_sticks_and_slips(x: float, v: float) -> None:
    belt = BeltOscillator()
    motion = belt.motion(x, v, 5.0)
    obeys(motion, 5.0, lambda _t, x, side: -100 * x - side * 0.3 * 9.81, surface=0.2)
    modes = [mode for _, mode in motion.events]
    assert modes.count(STICK) >= 2
    # a stick ends where the spring is as strong as static friction
    for piece, after in zip(motion.pieces, motion.pieces[1:], strict=False):
        if piece.mode == STICK:
            assert 100 * piece.at(after.start - piece.start)[0] == pytest.approx(0.4 * 9.81, abs=1e-12)


def test_the_cycle_on_a_belt_has_its_known_period() -> None:
    belt = BeltOscillator()
    slips = [t for t, mode in belt.motion(0.0, 0.2, 6.0).events if mode == SLIP]
    # Den Hartog's cycle: slip through pi + 2 arctan(v / (w l)), stick over 2 l, l = (mu_s - mu_k) m g / k
    size = 0.1 * 9.81 / 100
    slip = (np.pi + 2 * np.arctan(0.2 / 10 / size)) / 10
    assert np.diff(slips) == pytest.approx(slip + 2 * size / 0.2, abs=1e-13)


@pytest.mark.parametrize(("mu_static", "ends"), [(0.7, STICK), (0.5, SLIP)])
def test_a_block_thrown_up_an_incline_stays_or_returns(mu_static: float, ends: str) -> None:
    motion = thrown_up_incline(0.5, 2.0, mu_static, 0.4)
    assert motion.pieces[-1].mode == ends
    fall, rub = 9.81 * np.sin(0.5), 0.4 * 9.81 * np.cos(0.5)
    obeys(motion, 1.0, lambda _t, _x, side: -fall - side * rub)


def test_a_block_that_is_pulled_harder_lets_go() -> None:
    motion = pulled_harder(2.0, 3.0, 0.5, 0.4)
    assert motion.events == ((pytest.approx(0.5 * 2 * 9.81 / 3), SLIP),)
    obeys(motion, 5.0, lambda t, _x, _side: 3 * t / 2 - 0.4 * 9.81)


@pytest.mark.parametrize(("pull", "sticks"), [(5.0, True), (12.0, False), (2.5, True)])
def test_a_block_that_is_pulled_to_and_fro_stops_in_every_half_period(pull: float, sticks: bool) -> None:
    motion = PulledToAndFro(pull=pull).motion(6.0)
    obeys(motion, 6.0, lambda t, _x, side: pull * np.sin(4 * t) - side * 0.3 * 9.81)
    modes = [mode for t, mode in motion.events if t > 1]
    assert (STICK in [*modes, motion.pieces[-1].mode]) == sticks
    assert (SLIP in modes) == (pull > 0.3 * 9.81)
