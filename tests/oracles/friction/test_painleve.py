"""The references of Painleve's rod and the brake shoe, against the equations of motion as matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.oracles.friction.painleve import (
    INCONSISTENT,
    INDETERMINATE,
    PARTS,
    SLIDES,
    BrakeShoe,
    Rod,
)

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
