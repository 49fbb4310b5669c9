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
from modelgen.runtime.error_estimate import estimate_of, nudge
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.inputs_by_lane import InputsByLane
from modelgen.runtime.lane_arrays import each_once
from modelgen.runtime.recording import Recording
from modelgen.runtime.run_distance import motions_compared
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
    lanes = _Lanes(libraries, accuracies, inputs or {}, starts or {})
    lanes.run(until)
    twins = lanes.companions() if estimate else None
    if twins is not None:
        twins.run(lanes.group.t)
    return LaneRuns(lanes, twins)


class LaneRuns:
    """Runs at their ends, in the core's memory."""

    def __init__(self, lanes: _Lanes, twins: _Lanes | None) -> None:
        self._lanes, self._twins = lanes, twins

    def results(self) -> list[Ended]:
        """What became of each run. The core has no part in it."""
        lanes, twins = self._lanes, self._twins
        found = [lanes.ended(lane) for lane in range(lanes.n)]
        stated = [None] * lanes.n if twins is None else _estimates(found, lanes, twins)
        return [
            path if isinstance(path, SimulationError) else with_trust(path, estimated, accuracy, instance)
            for path, estimated, accuracy, instance in zip(
                found, stated, lanes.accuracies, lanes.instances, strict=True
            )
        ]


class _Lanes:
    """Runs that share nothing but the library, with room for the first and the last sample of each."""

    def __init__(
        self,
        libraries: Sequence[Library],
        accuracies: Sequence[Accuracy],
        inputs: Mapping[str, Array],
        starts: Mapping[int, Array],
    ) -> None:
        self._given = libraries, inputs, starts
        self.n, self.accuracies = len(libraries), accuracies
        self.instances = [each.manifest.instance for each in libraries]
        self.group = group = group_of(libraries[0], libraries, accuracies)
        for place, values in starts.items():
            group.x[:, place] = values
        settings = InputsByLane(group, libraries)
        for name, values in inputs.items():
            settings[name][:] = values
        settings.restart(np.arange(self.n))
        self._recording = Recording(group.like, np.zeros(2 * self.n))
        self._taken = np.zeros(self.n, dtype=int)  # samples of each lane
        self._refused: Mapping[int, SimulationError] = {}  # errors of lanes that cannot start

    def companions(self) -> _Lanes:
        """The companions of these runs, before their start."""
        libraries, inputs, starts = self._given
        epsilon = float(np.finfo(libraries[0].dtype).eps)
        finer = each_once(lambda own: own.companion(epsilon), self.accuracies)
        twins = _Lanes(libraries, finer, inputs, starts)
        nudge(twins.group.x, self.instances[0])
        return twins

    def run(self, until: float | Array) -> None:
        """Settle the starts, and go on to `until`, s, one time or one for each lane."""
        self._refused = self.group.begin(label="")
        for lane in np.flatnonzero(self.group.codes < FAILED).tolist():
            self._sample(lane)
        self.group.advance(until)
        moved = (self.group.t > 0) & np.isfinite(self.group.x).all(axis=1)
        for lane in np.flatnonzero(moved).tolist():
            self._sample(lane)

    @cached_property
    def columns(self) -> Mapping[str, Any]:
        """The samples of all lanes, two of each, as the fields of a Trajectory; for lanes that have come to
        their ends."""
        return self._recording.columns(2 * self.n, self.n)

    def rows(self, lane: int) -> slice:
        """Those that a lane has taken."""
        return slice(2 * lane, 2 * lane + int(self._taken[lane]))

    def ended(self, lane: int) -> Ended:
        return self._refused[lane] if lane in self._refused else self._trajectory(lane)

    def _trajectory(self, lane: int) -> Trajectory:
        rows = self.rows(lane)
        values = self.group.arrays["input"][lane, :-1:SETTING_SIZE].tolist()
        names = (each["name"] for each in self.instances[lane]["inputs"])
        return trajectory_of(
            self.group.like,
            self.group.runs[lane],
            {name: column[rows] for name, column in self.columns.items()},
            Ending(OUTCOME_OF_CODE[int(self.group.codes[lane])], self.group.drain_events(lane)),
            inputs=dict(zip(names, values, strict=True)),
            instance=self.instances[lane],
            accuracy=self.accuracies[lane],
        )

    def _sample(self, lane: int) -> None:
        """Take a sample of a lane at its present time."""
        row, record = 2 * lane + int(self._taken[lane]), self._recording.record
        self._recording.arrays["t"][row] = self.group.t[lane]
        record.count, record.capacity = row, row + 1
        self.group.sample(lane, record)
        self._taken[lane] += 1


def _estimates(found: Sequence[Ended], lanes: _Lanes, twins: _Lanes) -> list[Estimate | None]:
    """The estimates of the errors of runs, by their companions; None where a run has no sample."""
    compared = motions_compared(lanes.columns, twins.columns, lanes.instances[0])

    def stated(path: Trajectory, lane: int) -> Estimate:
        of_run, twin = (lanes.accuracies[lane], lanes.instances[lane]), twins.ended(lane)
        if isinstance(twin, SimulationError):
            return estimate_of(path, None, *of_run, f"the companion run did not start: {twin}")
        return estimate_of(path, twin, *of_run, compared=compared[:, lanes.rows(lane)])

    return [
        stated(path, lane) if isinstance(path, Trajectory) and len(path.t) else None
        for lane, path in enumerate(found)
    ]
