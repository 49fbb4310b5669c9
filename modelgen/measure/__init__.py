"""Speed against accuracy, measured for one scene: `measure` finds the front, `tune` picks from it."""

from __future__ import annotations

from modelgen.measure.measurement import Measurement, measure
from modelgen.measure.survey import Survey, survey
from modelgen.measure.tuning import Tuned, tune

__all__ = ["Measurement", "Survey", "Tuned", "measure", "survey", "tune"]
