"""A thousand seconds of rocking, some 10^5 steps, keep energy and contact, whatever the form."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Outcome
from tests.registry import REGISTRY, forced
from tests.running import run

SCENES = ("ellipsoid_on_plane", "ellipsoid_in_cavity")


@pytest.mark.cases(1)
@pytest.mark.parametrize(("accuracy", "drift"), [("balanced", 1e-7), ("tight", 1e-9)])
@pytest.mark.parametrize(("name", "form"), [(name, form) for name in SCENES for form in REGISTRY[name].forms])
def test_a_thousand_seconds(name: str, form: str, accuracy: str, drift: float) -> None:
    library = forced(name, form)
    path = simulate(library, until=1000.0, accuracy=Accuracy.named(accuracy), samples=1, estimate=False)
    assert path.outcome is Outcome.DONE
    assert path.events == ()
    assert path.energy_drift < drift
    assert path.gap_max < 1e-10 * library.manifest.instance["scales"]["length"]


@pytest.mark.slow
def test_many_short_steps_lose_no_time() -> None:
    """The first blow of a cradle, 3 500 to 26 000 steps after the start."""
    steps = [Accuracy.balanced().fixed_step(h) for h in (8.2e-5, 3.1e-5, 1.1e-5)]
    runs = [run("newton_cradle", accuracy, until=0.3) for accuracy in steps]
    assert np.ptp([path.events[0].t for path in runs]) < 2e-15
