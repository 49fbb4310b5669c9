"""Speed against accuracy, measured for one scene: `measure` finds the front, `tune` picks from it."""

from __future__ import annotations

from modelgen.measure.measure import Measurement, measure
from modelgen.measure.tune import Tuned, tune

__all__ = ["Measurement", "Tuned", "measure", "tune"]
