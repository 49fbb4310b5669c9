"""The measured tosses: the reading of their files, by the flight before the ground and the rest after it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracles.friction.cube_toss import HALF_WIDTH, NUMBERS, RATE, corners, errors, in_flight, toss


@pytest.mark.parametrize("number", NUMBERS)
def test_a_toss_flies_as_a_free_body_and_comes_to_rest_on_a_face(number: int) -> None:
    measured = toss(number)
    low = corners(measured.p, measured.rotation)[:, :, 2].min(axis=1)
    flies = int(np.argmax(low < 0.004))
    assert flies > 5
    p, rotation = in_flight(measured)
    away = np.linalg.norm(p - measured.p, axis=1)[:flies]
    turned = (measured.rotation.inv() * rotation).magnitude()[:flies]
    assert away.max() < 0.005
    assert turned.max() < 0.07
    assert low.min() > -0.006
    assert measured.p[-1, 2] == pytest.approx(HALF_WIDTH, abs=0.01)


def test_errors_are_means_over_frames() -> None:
    measured = toss(0)
    assert errors(measured, measured.p, measured.rotation) == pytest.approx((0, 0), abs=1e-7)
    shifted = errors(measured, measured.p + np.array([0.003, 0.004, 0]), measured.rotation)
    assert shifted == pytest.approx((0.005, 0), abs=1e-7)
    assert measured.t[1] == pytest.approx(1 / RATE)
