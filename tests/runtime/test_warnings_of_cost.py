"""A run whose steps are far shorter than its motion says so."""

from __future__ import annotations

import re

from modelgen import simulate
from tests.benchmarks.cliffs import rocking_can, spinning_box
from tests.running import library_of


def test_a_run_of_very_short_steps_says_how_many_and_what_bounds_them() -> None:
    library = library_of(rocking_can())
    path = simulate(library, until=0.06, samples=2, accuracy="fast", estimate=False)
    (told,) = (warning for warning in path.warnings if "steps were short" in warning)
    tried = path.steps + path.rejected
    assert int(re.findall(r"\d+", told)[0]) == tried > 10_000
    bounded = simulate(library, until=0.06, samples=2, method="time-stepping", step=1e-4, estimate=False)
    assert bounded.outcome.succeeded
    assert bounded.steps + bounded.rejected < tried / 10


def test_a_run_of_usual_steps_does_not() -> None:
    path = simulate(library_of(spinning_box()), until=0.25, samples=2, estimate=False)
    assert not any("steps were short" in warning for warning in path.warnings)
