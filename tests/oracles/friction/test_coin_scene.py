"""Euler's disk with rolling resistance, against its reference and the law of its last seconds."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Outcome
from tests.oracles.friction.disc import Disc
from tests.oracles.friction.extrapolation import Array, Real
from tests.oracles.pieces import imbalance, rotations
from tests.running import run

DISC = Disc(Real("0.0375"), Real("0.44"), rolling_resistance=Real("2e-4"))
TILT = 0.06


@cache
def settled() -> Array:
    first = DISC.steady(TILT, np.sqrt(4 * 9.81 / (0.0375 * TILT)))
    return DISC.run(first, [0, 1.75, 3.5], 1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(("accuracy", "off"), [("balanced", 1e-8), ("tight", 1e-10)])
def test_a_coin_settles_as_its_reference(accuracy: str, off: float) -> None:
    path = run("coin", Accuracy.named(accuracy), samples=2)
    assert not path.events
    assert np.abs(path.p[:, 1] - [DISC.centre(x) for x in settled()]).max() < off
    assert np.abs(rotations(path, 1)[:, 2] - [DISC.rotation(x)[2] for x in settled()]).max() < 10 * off
    assert imbalance(path) < 0.1 * off


def test_its_tilt_falls_as_the_square_of_the_time_that_is_left() -> None:
    path = run("coin", Accuracy.balanced(), samples=7)
    tilt = np.arccos(rotations(path, 1)[:, 2, 2])
    left = 1 - path.t / float(DISC.settles_after(Real(TILT)))
    assert np.sqrt(tilt / TILT) == pytest.approx(left, abs=0.02)


@pytest.mark.slow
def test_it_lies_flat_in_the_end_by_time_stepping_where_steps_shrink() -> None:
    path = run("coin", Accuracy.balanced(), until=5.0, samples=50)
    tilt = np.arccos(np.minimum(rotations(path, 1)[:, 2, 2], 1))
    assert path.outcome is Outcome.MARGIN
    assert tilt[-1] < 1e-4
    assert path.t_end == pytest.approx(float(DISC.settles_after(Real(TILT))), abs=0.1)
    assert any("the event-driven run could not go on" in warning for warning in path.warnings)
    assert imbalance(path) < 1e-5
