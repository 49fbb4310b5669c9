"""Scenes of tops, against their references."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from tests.oracles.friction.extrapolation import Array
from tests.oracles.friction.on_plane import P, rolled, rotation_of, slid
from tests.oracles.friction.tops import (
    rattleback,
    rattleback_start,
    slid_then_rolled,
    spinning_egg,
    spinning_egg_start,
    tippe_top,
    tippe_top_start,
)  # fmt: skip
from tests.oracles.pieces import imbalance, rotations, times
from tests.running import run

SAMPLES = 3
BOTH = pytest.mark.parametrize(
    ("accuracy", "off"), [("balanced", 1e-10), pytest.param("tight", 1e-12, marks=pytest.mark.slow)]
)


def at(until: float) -> Array:
    return np.linspace(0, until, SAMPLES + 1)


@cache
def rattled() -> Array:
    return rolled(rattleback(), rattleback_start(), at(2.1), 1e-13)


@cache
def turned_over() -> tuple[Array, float]:
    states, rolls_at = slid_then_rolled(tippe_top(), tippe_top_start(), at(1.5), 1e-14)
    return states, float(rolls_at)


@cache
def risen() -> Array:
    return slid(spinning_egg(), spinning_egg_start(), at(1.0), 1e-13)


def follows(path: Trajectory, states: Array, off: float) -> bool:
    place = np.abs(path.p[:, 1] - states[:, P]).max()
    turn = np.abs(rotations(path, 1) - [rotation_of(x) for x in states]).max()
    return bool(place < off and turn < 100 * off)


@BOTH
@pytest.mark.slow
def test_a_rattleback_turns_back_as_its_reference(accuracy: str, off: float) -> None:
    path = run("rattleback", Accuracy.named(accuracy), samples=SAMPLES)
    assert not path.events
    assert follows(path, rattled(), off)
    assert path.w[0, 1, 2] == -3
    assert path.w[-1, 1, 2] > 0.2
    assert np.ptp(path.energy) < off
    assert (np.linalg.norm(path.friction[:, 0], axis=1) < path.force[:, 0]).all()


@pytest.mark.slow
@BOTH
def test_a_tippe_top_turns_over_as_its_reference(accuracy: str, off: float) -> None:
    path = run("tippe_top", Accuracy.named(accuracy), samples=SAMPLES)
    states, rolls_at = turned_over()
    assert times(path, "slip-stop") == [pytest.approx(rolls_at, abs=off)]
    assert follows(path, states, off)
    assert rotations(path, 1)[-1, 2, 2] < -0.9
    assert imbalance(path) < 1e-3 * off


@pytest.mark.slow
@BOTH
def test_a_spinning_egg_rises_as_its_reference(accuracy: str, off: float) -> None:
    path = run("spinning_egg", Accuracy.named(accuracy), samples=SAMPLES)
    assert not path.events
    assert follows(path, risen(), off)
    assert rotations(path, 1)[-1, 2, 2] > 0.7
    assert imbalance(path) < 1e-1 * off
