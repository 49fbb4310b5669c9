"""Speed against accuracy, measured for one scene.

Takes in a `Scene`; `measure` gives out a `Measurement`: error and cost of each setting, and the settings
that no other beats in both (the front); `tune` picks one of them. `modelgen measure --extremes` tries the
limits of double precision. Nothing imports this package but `cli`.
"""

from __future__ import annotations

from modelgen.benchmark.extremes_survey import Survey, survey
from modelgen.benchmark.measurement import Measurement, measure
from modelgen.benchmark.tuning import Tuned, tune

__all__ = ["Measurement", "Survey", "Tuned", "measure", "survey", "tune"]
