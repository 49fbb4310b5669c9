"""A run is trusted if nothing speaks against it, and each thing that does is named."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from modelgen import simulate
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.runtime.trust import doubts
from modelgen.scene import python_scenes as make
from tests.running import library_of

BALL = make.dynamic("ball", make.sphere(0.1), density=1000.0, position=[0, 0, 0.3])
SCENE = make.scene(
    "ball", [make.fixed("table", make.plane()), BALL], contact=[{"between": ["ball", "table"]}]
)


@cache
def path() -> Trajectory:
    return simulate(library_of(SCENE), until=0.3, accuracy="balanced")


@cache
def instance() -> Any:
    return library_of(SCENE).manifest.instance


def doubted(run: Trajectory, accuracy: Accuracy | None = None) -> tuple[str, ...]:
    return doubts(run, run.estimate, accuracy or Accuracy.balanced(), instance())


def test_a_certified_run_is_trusted_with_and_without_its_estimate() -> None:
    assert path().is_trusted
    assert not doubted(path())
    assert not doubted(replace(path(), estimate=None))


@pytest.mark.parametrize("estimated", [True, False])
@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"outcome": Outcome.STEP_TOO_SMALL}, "it ended early: step_too_small"),
        ({"gap_max": 1.01e-9}, "gap"),
        ({"gap_max": float("nan")}, "gap"),
        ({"joint_error_max": 1.01e-6}, "a joint was apart"),
        ({"joint_error_max": float("nan")}, "a joint was apart"),
        ({"energy_drift": 1.01e-6}, "energy drift"),
        ({"energy_drift": float("nan")}, "energy drift"),
    ],
)
def test_each_figure_beyond_its_threshold_is_named(
    changes: dict[str, Any], word: str, estimated: bool
) -> None:
    if "energy_drift" not in changes and "outcome" not in changes:
        changes = {key: value * instance()["scales"]["length"] for key, value in changes.items()}
    run = replace(path(), **changes)
    (reason,) = doubted(run if estimated else replace(run, estimate=None))
    assert word in reason


def test_figures_at_their_thresholds_are_trusted() -> None:
    length = instance()["scales"]["length"]
    ledger = {"gap_max": 0.99e-9 * length, "joint_error_max": 0.99e-6 * length, "energy_drift": 1e-6}
    assert not doubted(replace(path(), **ledger))
    assert not doubted(replace(path(), gap_max=0.99e-6 * length, energy_drift=1e-3), Accuracy.fast())


def test_an_uncertified_run_is_doubted_by_the_estimate_or_by_its_own_reasons() -> None:
    told = doubted(replace(path(), estimate=None, unfollowed_minima=1))
    assert told == ("uncertified: closest points were found that no contact was free to follow",)
    estimate = path().estimate
    assert estimate is not None
    horizon = replace(path(), estimate=replace(estimate, horizon=0.2))
    assert doubted(horizon) == ("nothing is predicted beyond 0.2 s",)
    shared = replace(path(), estimate=replace(estimate, uncertified=("something",)))
    assert doubted(shared) == ("uncertified: something",)


@pytest.mark.parametrize("height", [0.0, 1.0, 100.0])
def test_energy_within_rounding_is_trusted(height: float) -> None:
    """A belt drags a box with a friction of 1e-6: its motion is lost in the rounding of its height."""
    belt = make.driven("belt", make.plane(), path={"position": ["0.5*t", "0.0", str(height)]})
    box = make.dynamic("box", make.box(0.1, 0.1, 0.1), density=1000.0, position=[0, 0, height + 0.05])
    contact = [{"between": ["box", "belt"], "friction": 1e-6}]
    run = simulate(library_of(make.scene("belt", [belt, box], contact=contact)), until=1.0, samples=3)
    assert run.is_trusted, run.doubts
    assert run.energy_drift > 1e-7
    assert path().energy_rounding < 1e-12
