"""Runs at their ends: many steps, and single precision."""

from __future__ import annotations

from dataclasses import replace

from modelgen.benchmark.extreme_scales_and_spins import rocking_egg
from modelgen.benchmark.extreme_trials import EPS, RUN, Extreme, Trial, against, decades, tried_run
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene

LONG_STEP = 1e-4  # s: Runge and Kutta's error is below rounding


def _try_steps(n: float, libraries: LibrariesByKinds) -> Trial:
    """The egg for n steps: drift of energy, gap."""
    what = replace(rocking_egg(), run=replace(rocking_egg().run, until=n * LONG_STEP))

    def error(path: Trajectory) -> float:
        return max(path.energy_drift, path.gap_max / 0.05)

    return tried_run(lambda: what, libraries, error, accuracy=Accuracy.tight().fixed_step(LONG_STEP))


def _try_float(until: float, libraries: LibrariesByKinds) -> Trial:
    """The egg in single precision."""

    def make() -> Scene:
        return replace(rocking_egg(), run=replace(rocking_egg().run, until=until))

    return tried_run(make, libraries, against(libraries, make), accuracy=Accuracy.balanced(), real="float")


RUNS = (
    Extreme(
        "long runs", "steps of RK4", decades(3, 7), (1e3, 1e5),
        "rounding + 10 eps n", lambda x: 1e-12 + 10 * EPS * x, "drift of energy, gap", _try_steps,
    ),
    Extreme(
        "single precision", "s of rocking in a float build", decades(-2, 1), (1e-1,),
        "1e-6 + 1e-4 t", lambda x: 1e-6 + 1e-4 * x, RUN, _try_float, warned=5.0,
    ),
)  # fmt: skip
