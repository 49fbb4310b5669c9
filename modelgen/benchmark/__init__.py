"""Speed against accuracy, measured for one scene: `measure` finds the front, `tune` picks from it."""

from __future__ import annotations

from modelgen.benchmark.extremes_survey import Survey, survey
from modelgen.benchmark.measurement import Measurement, measure
from modelgen.benchmark.tuning import Tuned, tune

__all__ = ["Measurement", "Survey", "Tuned", "measure", "survey", "tune"]
