"""Many runs of one library from their starts to their ends, each with its own numbers, in one thread.

A run takes the steps that `simulate` takes with the same numbers, and its trajectory is that of `simulate`
with one output interval: samples at the start and at the end, events, ledger, estimate, doubts. No warnings
are made, and pairs that no contact lists are not looked at.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.error_estimate import estimate_of, nudge, steps_max
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.inputs_by_lane import InputsByLane
from modelgen.runtime.lane_arrays import each_once
from modelgen.runtime.recording import NAMES, Recording
from modelgen.runtime.run_distance import MOTION, motions_compared
from modelgen.runtime.session_group import group_of
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Trajectory
from modelgen.runtime.trajectory_of_run import Ending, trajectory_of
from modelgen.runtime.trust import with_trust

FAILED = 10  # outcomes of the core from here on end a run
Ended = Trajectory | SimulationError  # the error of a run that cannot start


def run_lanes(
    libraries: Sequence[Library],
    *,
    until: float,
    accuracies: Sequence[Accuracy],
    estimate: bool = True,
    inputs: Mapping[str, Array] | None = None,
    starts: Mapping[int, Array] | None = None,
) -> LaneRuns:
    """Run lanes to `until`, s, and their companions to where they ended.

    Args:
        libraries: one library with the numbers of each of the n lanes (`library_with`).
        accuracies: the record of each.
        estimate: whether a companion of each run follows, from which its error is estimated.
        inputs: (n,) values of inputs for the whole run, by name; the scene's defaults for the others.
        starts: (n,) numbers of the start by their place in the state (q, then u), in place of the scene's.

    Raises:
        SimulationError: the value of an input is out of its range.
    """
    runs = LaneRuns(libraries, accuracies, estimate, inputs or {}, starts or {})
    runs.run(until)
    return runs


class LaneRuns:
    """Runs that share nothing but the library, with their companions as further lanes, and room for the first
    and the last sample of each lane."""

    def __init__(
        self,
        libraries: Sequence[Library],
        accuracies: Sequence[Accuracy],
        estimate: bool,
        inputs: Mapping[str, Array],
        starts: Mapping[int, Array],
    ) -> None:
        self._n, times = len(libraries), 2 if estimate else 1
        epsilon = float(np.finfo(libraries[0].dtype).eps)
        finer = each_once(lambda own: own.companion(epsilon), accuracies) if estimate else []
        self._libraries, self._accuracies = [*libraries] * times, [*accuracies, *finer]
        self._instances = [each.manifest.instance for each in self._libraries]
        self._group = group = group_of(libraries[0], self._libraries, self._accuracies)
        for place, values in starts.items():
            group.x[:, place] = np.tile(values, times)
        settings = InputsByLane(group, self._libraries)
        for name, values in inputs.items():
            settings[name][:] = np.tile(values, times)
        settings.restart(np.arange(group.n))
        nudge(group.x[self._n :], self._instances[0])
        self._recording = Recording(group.like, np.zeros(2 * group.n), at_once=True)
        self._taken = np.zeros(group.n, dtype=int)  # samples of each lane
        self._refused: Mapping[int, SimulationError] = {}  # errors of lanes that cannot start

    def run(self, until: float) -> None:
        """Settle the starts, and go on to `until`, s; the companions to where their runs have ended."""
        own, twins = np.arange(self._n), np.arange(self._n, self._group.n)
        self._refused = self._group.begin(label="")
        self._sample(np.flatnonzero(self._group.codes < FAILED))
        ends = np.zeros(self._group.n)
        ends[own] = until
        self._advance(own, ends)
        if len(twins):
            ends[:] = np.tile(self._group.t[own], 2)
            for accuracy, run, twin in zip(self._accuracies, self._group.runs, twins.tolist(), strict=False):
                self._group.runs[twin].steps_max = steps_max(accuracy, run.steps, run.rejected)
            self._advance(twins, ends)

    def results(self) -> list[Ended]:
        """What became of each run. The core has no part in it."""
        found = [self._ended(lane) for lane in range(self._n)]
        stated = self._estimates(found) if self._group.n > self._n else [None] * self._n
        return [
            path if isinstance(path, SimulationError) else with_trust(path, estimated, accuracy, instance)
            for path, estimated, accuracy, instance in zip(
                found, stated, self._accuracies[: self._n], self._instances[: self._n], strict=True
            )
        ]

    def _advance(self, lanes: Array, ends: Array) -> None:
        self._group.advance(ends)
        moved = (self._group.t > 0) & np.isfinite(self._group.x).all(axis=1)
        self._sample(lanes[moved[lanes]])

    def _sample(self, lanes: Array) -> None:
        """Take a sample of lanes at their present times."""
        record, times = self._recording.record, self._recording.arrays["t"]
        for lane in lanes.tolist():
            row = 2 * lane + int(self._taken[lane])
            times[row] = self._group.t[lane]
            record.count, record.capacity = row, row + 1
            self._group.sample(lane, record)
            self._taken[lane] += 1

    @cached_property
    def _columns(self) -> Mapping[str, Any]:
        """The samples of all lanes, two of each, as the fields of a Trajectory."""
        return self._recording.columns(2 * self._group.n, self._group.n)

    def _rows(self, lane: int) -> slice:
        """Those that a lane has taken."""
        return slice(2 * lane, 2 * lane + int(self._taken[lane]))

    def _ended(self, lane: int) -> Ended:
        if lane in self._refused:
            return self._refused[lane]
        rows = self._rows(lane)
        values = self._group.arrays["input"][lane, :-1:SETTING_SIZE].tolist()
        names = (each["name"] for each in self._instances[lane]["inputs"])
        return trajectory_of(
            self._group.like,
            self._group.runs[lane],
            {name: column if name in NAMES else column[rows] for name, column in self._columns.items()},
            Ending(OUTCOME_OF_CODE[int(self._group.codes[lane])], self._group.drain_events(lane)),
            doubts=self._group.doubts(lane),
            inputs=dict(zip(names, values, strict=True)),
            instance=self._instances[lane],
            accuracy=self._accuracies[lane],
        )

    def _estimates(self, found: Sequence[Ended]) -> list[Estimate | None]:
        """The estimates of the errors of runs, by their companions; None where a run has no sample."""
        of_runs, of_twins = (
            {name: self._columns[name][rows] for name in MOTION}
            for rows in (slice(2 * self._n), slice(2 * self._n, None))
        )
        compared = motions_compared(of_runs, of_twins, self._instances[0])

        def stated(path: Trajectory, lane: int) -> Estimate:
            of_run, twin = (self._accuracies[lane], self._instances[lane]), self._ended(self._n + lane)
            if isinstance(twin, SimulationError):
                return estimate_of(path, None, *of_run, f"the companion run did not start: {twin}")
            return estimate_of(path, twin, *of_run, compared=compared[:, self._rows(lane)])

        return [
            stated(path, lane) if isinstance(path, Trajectory) and len(path.t) else None
            for lane, path in enumerate(found)
        ]
