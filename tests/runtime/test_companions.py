"""A companion comes as far as its run, or stops because of its cost and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.simulate_lanes import run_lanes
from tests.benchmarks.companions import KINDS, toss
from tests.running import scene_of

CHEAP = replace(Accuracy.balanced(), companion_cost=0.5)


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", KINDS)
def test_the_companion_of_a_tossed_solid_does_not_end_before_its_run(kind: str, seed: int) -> None:
    each = toss(kind, seed)
    assert each.path.outcome.succeeded
    assert not each.stopped


def test_a_companion_that_costs_too_much_stops_and_the_run_is_not_trusted() -> None:
    path, full = (
        simulate(scene_of("rattleback"), until=5.0, samples=20, accuracy=accuracy)
        for accuracy in (CHEAP, Accuracy.balanced())
    )
    assert path.estimate is not None
    assert full.estimate is not None
    assert path.estimate.rhs_evals < 0.7 * full.estimate.rhs_evals
    assert any("the companion run was stopped at" in doubt for doubt in path.doubts)
    assert not any("was stopped" in doubt for doubt in full.doubts)
    known = np.isfinite(path.position_error)
    assert known.any()
    assert not known.all()


def test_the_companion_of_a_lane_stops_where_that_of_a_run_does() -> None:
    library = scene_of("rattleback")
    alone = simulate(library, until=5.0, samples=1, accuracy=CHEAP)
    (lane,) = run_lanes([library], until=5.0, accuracies=[CHEAP]).results()
    assert lane.doubts == alone.doubts
