"""The noise of what was measured: given by column or quantity, or estimated from deviations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from modelgen.errors import SimulationError
from modelgen.identification.recording_residuals import RecordedRun
from modelgen.identification.recordings import Array
from modelgen.name_suggestions import nearest
from modelgen.runtime.arguments import is_number, values_by_name

FLOOR = float(np.sqrt(np.finfo(float).eps))  # of an estimated noise, in spreads of what was measured
NORMAL_MEDIAN = 0.6744897501960817  # of the absolute value of a standard normal number


@dataclass(frozen=True)
class Noise:
    """Standard deviations of deviations by their name: as given, or by quantity, as estimated."""

    given: Mapping[str, float]  # by name of a deviation or a quantity
    estimated: Mapping[str, float]  # by quantity
    floor: Mapping[str, float]

    def of(self, run: RecordedRun) -> Array:
        """(n,) of the deviations of a run."""
        pairs = zip(run.comparison.names, run.comparison.groups, strict=True)
        return np.array([self._one(name, group) for name, group in pairs])

    @property
    def is_given(self) -> bool:
        """Whether all of it is."""
        return not self.estimated

    def fitted(
        self, runs: Sequence[RecordedRun], deviations: Sequence[Array], lost: float, robust: bool
    ) -> Noise:
        """The noise that deviations [(nt, n) a run] show; `lost`: the share of them that unknowns took."""
        found = {}
        for group in self.estimated:
            each = [
                part[:, [k for k, name in enumerate(run.comparison.groups) if name == group]].ravel()
                for run, part in zip(runs, deviations, strict=True)
            ]
            values = np.abs(np.concatenate(each))
            values = values[np.isfinite(values)]
            size = np.median(values) / NORMAL_MEDIAN if robust else np.sqrt(np.mean(values**2))
            found[group] = max(float(size) / np.sqrt(1 - lost), self.floor[group])
        return Noise(self.given, found, self.floor)

    def _one(self, name: str, group: str) -> float:
        return self.given.get(name) or self.given.get(group) or self.estimated[group]


def noise_of(runs: Sequence[RecordedRun], given: Mapping[str, float] | None) -> Noise:
    """The noise to begin with: as given, else the spread of what was measured.

    Raises SimulationError where a name is no column or quantity, or a value is not positive.
    """
    given = dict(values_by_name("noise", given))
    pairs = [pair for run in runs for pair in zip(run.comparison.names, run.comparison.groups, strict=True)]
    known = dict.fromkeys([name for pair in pairs for name in pair])
    for name, value in given.items():
        if name not in known:
            remedy = nearest(name, known)
            raise SimulationError("noise", repr(name), f"known: {', '.join(known)}", remedy)
        if not is_number(value) or not isfinite(value) or value <= 0:
            raise SimulationError(f"noise of {name!r}", repr(value), "a positive number")
    left = {group for name, group in pairs if name not in given and group not in given}
    spread = {group: _spread(runs, group) for group in sorted(left)}
    return Noise(given, spread, {group: FLOOR * size for group, size in spread.items()})


def _spread(runs: Sequence[RecordedRun], group: str) -> float:
    """Root mean square distance of what was measured from its mean; 1 rad for orientations."""
    columns: list[Array] = []
    for run in runs:
        names = run.recording.columns
        places = [
            names.index(name)
            for name, home in zip(run.comparison.names, run.comparison.groups, strict=True)
            if home == group and name in names
        ]
        if places:
            columns.append(
                run.recording.values[:, places] - np.nanmean(run.recording.values[:, places], axis=0)
            )
    if not columns:
        return 1.0
    return float(np.sqrt(np.nanmean(np.concatenate([part.ravel() for part in columns]) ** 2))) or 1.0
