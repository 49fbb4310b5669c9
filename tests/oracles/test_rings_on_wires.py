"""Corrections of position: no body leaps, no energy is made, and what may not be removed is judged."""

from __future__ import annotations

import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Outcome
from tests.benchmarks.rings_on_wires import falls_back, lanes_of, leap_of, ring_on_wire, run
from tests.oracles.pieces import TABLE, G, ball, ran

FALLING_BACK = (6, 17, 30, 40, 53, 60, 76, 89, 93, 108, 128, 130)  # by which Newton's method leapt, once


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", FALLING_BACK)
def test_a_ring_whose_contact_points_merge_does_not_leap(seed: int) -> None:
    ring = ring_on_wire(seed)
    path = run(ring, "balanced")
    assert path is not None
    assert path.outcome is Outcome.DONE
    assert falls_back(path)
    assert leap_of(ring, path) <= 1.0 + 1e-6
    assert max(path.correction_energy, path.energy_drift) <= 1e-6


def test_rings_of_a_group_do_not_leap() -> None:
    assert max(lanes_of(ring_on_wire(40), 40)) <= 1.0 + 1e-6


LANDING = [TABLE, ball("b", [0, 0, 0.2])]  # a ball of 0.1 m falls on a plane, and stays
WITHOUT_BOUNCE = [{"between": ["b", "table"]}]
SINKING = Accuracy.balanced().time_stepping(1e-2, "anitescu-potra")  # penetrates by the way of a step


def test_a_penetration_that_may_not_be_corrected_ends_the_run() -> None:
    """One contact alone moves no body farther than it penetrates: a ratio of 1 is enough, and less is not."""
    for ratio, outcome in ((1.0 + 1e-9, Outcome.DONE), (0.99, Outcome.PENETRATED)):
        path = ran(LANDING, 1.0, WITHOUT_BOUNCE, accuracy=SINKING.with_thresholds(correction_ratio=ratio))
        assert path.outcome is outcome
        assert (path.correction_energy > 0) == (outcome is Outcome.DONE)


def test_what_a_correction_lifts_is_no_work_and_is_judged() -> None:
    """The ball ends at its rest 0.1 m above the plane; work is what it lost in the blow: the drop to where it
    struck, below the plane."""
    path = ran(LANDING, 1.0, WITHOUT_BOUNCE, accuracy=SINKING)
    weight, drop, step = path.energy[0] / 0.2, 0.1, 1e-2
    lifted = path.energy[-1] - path.energy[0] - path.work[-1]
    assert path.energy[-1] == pytest.approx(weight * 0.1, rel=1e-9)
    assert 0 < lifted < weight * 2 * step * (2 * G * drop) ** 0.5  # the ways of two steps
    relative = lifted / (weight * drop + lifted)  # of the kinetic energy below the plane
    assert 0 < path.correction_energy == pytest.approx(relative, abs=path.energy_drift)
    assert any("by corrections of positions" in doubt for doubt in path.doubts)
