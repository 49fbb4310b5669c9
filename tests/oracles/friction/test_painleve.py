"""The references of Painleve's rod and the brake shoe, against the equations of motion as matrices."""

from __future__ import annotations

from math import atan2, cos, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from modelgen import Accuracy
from tests.oracles.friction.painleve import (
    INCONSISTENT,
    INDETERMINATE,
    PARTS,
    SLIDES,
    BrakeShoe,
    Rod,
)
from tests.running import run

ROD = Rod()


@given(st.floats(0.05, 3.09), st.floats(-15, 15), st.floats(0, 3), st.sampled_from([-1, 1]))
def test_the_gap_of_the_tip_accelerates_as_told(theta: float, rate: float, mu: float, side: int) -> None:
    # q = (x, y, theta), tip = (x - l cos, y - l sin); rows of its velocity and their change
    length, mass = ROD.half_length, np.diag([1.0, 1.0, ROD.inertia])
    normal = np.array([0, 1, -length * np.cos(theta)])
    tangent = np.array([1, 0, length * np.sin(theta)])
    gravity = np.array([0, -9.81, 0])
    bias = length * np.sin(theta) * rate**2
    gain = normal @ np.linalg.solve(mass, normal + side * mu * tangent)
    assert ROD.free(theta, rate) == pytest.approx(normal @ gravity + bias, abs=1e-11)
    assert ROD.gain(theta, mu, side) == pytest.approx(gain, abs=1e-12)


def test_the_paradox_begins_at_four_thirds() -> None:
    mu, theta = Rod.least_mu()
    assert ROD.gain(theta, mu) == pytest.approx(0, abs=1e-15)
    assert min(ROD.gain(t, mu) for t in np.linspace(0, np.pi / 2, 1001)) > -1e-6
    low, high = Rod.paradox(1.4)
    assert low < theta < high
    assert ROD.gain(low, 1.4) == pytest.approx(0, abs=1e-14)
    assert ROD.gain(high, 1.4) == pytest.approx(0, abs=1e-14)
    assert np.diff(Rod.paradox(4 / 3)) < 0


def test_all_four_outcomes_occur() -> None:
    theta = np.arctan(2)
    fast = 1.1 * ROD.lifts_at(theta)
    assert ROD.outcome(theta, 0, 1.0) == SLIDES
    assert ROD.outcome(theta, fast, 1.0) == PARTS
    assert ROD.outcome(theta, fast, 2.0) == INDETERMINATE
    assert ROD.outcome(theta, 0, 2.0) == INCONSISTENT
    assert ROD.outcome(theta, 0, 2.0, side=-1) == SLIDES


def test_the_force_of_the_sliding_rod_keeps_the_tip_on_the_plane() -> None:
    force = ROD.force(1.0, 2.0, 0.5)
    assert ROD.free(1.0, 2.0) + ROD.gain(1.0, 0.5) * force == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize(("mu", "side", "expected"), [
    (0.4, 1, SLIDES), (0.4, -1, SLIDES), (0.6, 1, INCONSISTENT), (5.0, -1, SLIDES),
])  # fmt: skip
def test_a_brake_shoe_jams_on_one_side(mu: float, side: int, expected: str) -> None:
    shoe = BrakeShoe()
    assert shoe.outcome(mu, side) == expected
    assert (mu > shoe.jams_above and side > 0) == (expected == INCONSISTENT)
    if expected == SLIDES:
        # hinge over the origin, shoe along x, friction along -side x
        force = shoe.force(mu, side)
        moment = np.cross([shoe.distance, -shoe.height, 0], [-side * mu * force, force, 0])[2]
        assert moment == pytest.approx(shoe.load)


def test_the_shipped_rod_is_stopped_by_a_blow_and_turns_about_its_tip() -> None:
    """The blow without collision of Genot and Brogliato, then a pendulum, to the order of the fallback."""
    path, rod, theta = run("painleve_rod", Accuracy.balanced()), Rod(), atan2(2, 1)
    assert rod.outcome(theta, 0.0, 2.0) == INCONSISTENT
    assert path.outcome.succeeded
    assert sum("Painleve" in warning for warning in path.warnings) == 1
    about = rod.inertia + rod.mass * rod.half_length**2
    rate = 3.0 * rod.mass * rod.half_length * sin(theta) / about  # the momentum about the tip stays

    def falls(t: float, y: list[float]) -> list[float]:
        return [y[1], -rod.mass * rod.g * rod.half_length * cos(y[0]) / about]

    end = solve_ivp(falls, (0.0, 0.2), [theta, rate], "DOP853", rtol=1e-12).y[:, -1]
    ahead = path.p[-1, 1] - rod.half_length * np.array([cos(end[0]), 0, sin(end[0])])
    assert -path.w[-1, 1, 1] == pytest.approx(end[1], abs=1e-3)
    assert np.hypot(*ahead[[0, 2]]) < 1e-3
