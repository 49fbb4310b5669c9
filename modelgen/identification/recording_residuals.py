"""The run that belongs to a recording: its deviations, and their derivatives by the unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.identification.compared_columns import Comparison
from modelgen.identification.recording_starts import Start
from modelgen.identification.recordings import Array, Recording
from modelgen.identification.unknowns import Unknown
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import Session
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.sensitivity import Outputs, TangentRun, outputs_of
from modelgen.runtime.sensitivity_directions import DirectionRows, direction_rows

DIFFERENCE = 1e-3  # step of differences, in scales of the unknowns; a second one is twice as long
STEPS = (DIFFERENCE, 2 * DIFFERENCE)
CLEAR = 0.5  # distance of two differences, over that from the derivative, up to which they replace it
AGREEMENT = 0.05  # of an uncertain derivative with a difference, relative, for it to be kept


@dataclass
class Counts:
    """How often derivatives were taken, in rows of recordings."""

    certain: int = 0
    confirmed: int = 0  # not certain, and as differences of runs
    differences: int = 0  # not certain, and replaced by differences
    kept: int = 0  # not certain, and kept where differences of runs say less
    reasons: dict[str, int] = field(default_factory=dict)  # of what is not certain

    def add(self, other: Counts) -> None:
        self.certain += other.certain
        self.confirmed += other.confirmed
        self.differences += other.differences
        self.kept += other.kept
        for reason, count in other.reasons.items():
            self.reasons[reason] = self.reasons.get(reason, 0) + count


@dataclass(frozen=True)
class RecordedRun:
    """A recording, how it is compared, and how its run starts."""

    recording: Recording
    comparison: Comparison
    start: Start
    parts: tuple[int, ...]  # places of its own unknowns among all, after those of all recordings


class RecordedRuns:
    """Runs of a library for any values of the unknowns."""

    def __init__(
        self,
        library: Library,
        accuracy: Accuracy,
        runs: Sequence[RecordedRun],
        unknowns: Sequence[Unknown],
        inputs: Mapping[str, float],
    ) -> None:
        self.library, self.accuracy, self.runs = library, accuracy, tuple(runs)
        self.unknowns, self.inputs = tuple(unknowns), dict(inputs)
        self.common = tuple(k for k, each in enumerate(unknowns) if each.recording < 0)
        self.low = np.array([each.low for each in unknowns])
        self.high = np.array([each.high for each in unknowns])
        self.scales = np.array([each.scale for each in unknowns])
        self.simulated = 0  # runs
        self._known: tuple[tuple[float, ...] | None, DirectionRows | None] = None, None
        self._still = direction_rows(library, ())

    def shown(self, run: RecordedRun, x: Array, rows: int) -> Array:
        """(rows, n_of) values at the first times of a recording; NaN after the run has ended early."""
        library = self._library(x)
        session = self._session(library, run, x)
        return self._tangents(session, run, self._still, rows)[0]

    def deviations(self, run: RecordedRun, x: Array, rows: int) -> Array:
        """(rows, n) deviations of the run from its recording; NaN where nothing was measured.

        Raises SimulationError where the start is refused, or the run ends early.
        """
        return run.comparison.deviations(run.recording, self._whole(run, self.shown(run, x, rows)))

    def derivatives(self, run: RecordedRun, x: Array, rows: int, counts: Counts) -> Array:
        """(rows, n, n_unknowns) derivatives of the deviations.

        Where the verdict is not `differentiable` they are compared with a difference of two runs in a
        direction in which all unknowns change, and differences of runs by each unknown take their place
        where the two do not agree.
        """
        library = self._library(x)
        session = self._session(library, run, x)
        directions = self._directions(library, session, run, x)
        shown, jacobian, verdicts = self._tangents(session, run, directions, rows)
        own = [*self.common, *run.parts]
        found = np.zeros((rows, len(run.comparison.names), len(x)))
        found[:, :, own] = run.comparison.derivatives(run.recording, self._whole(run, shown), jacobian)
        certain = sum(map(bool, verdicts))
        counts.certain += certain
        if certain < rows:
            reason = verdicts[certain].reason
            counts.reasons[reason] = counts.reasons.get(reason, 0) + rows - certain
            self._settle(run, x, found, certain, counts)
        return found

    def starts(self, run: RecordedRun, x: Array) -> dict[str, list[float]]:
        """Where the bodies of a run that move freely start: quantities by name, as `outputs_of` has them."""
        state = self._session(self._library(x), run, x).x
        parts = outputs_of(self.library.manifest.instance).items()
        return {
            name: [float(state[each.state]) for each in found] for name, found in parts if found[0].state >= 0
        }

    def _settle(self, run: RecordedRun, x: Array, found: Array, certain: int, counts: Counts) -> None:
        """Confirm, replace or keep derivatives of the rows from `certain` on."""
        own = np.array([*self.common, *run.parts], dtype=int)
        rows = len(found)
        along = np.zeros(len(x))
        along[own] = self.scales[own] * np.random.default_rng(0).choice([-1.0, 1.0], len(own))
        short, long = (self._difference(run, x, step * along, rows)[certain:] / step for step in STEPS)
        wrong, unclear = _apart(found[certain:] @ along, short), _apart(long, short)
        is_known = bool(np.all(np.isfinite(found[certain:][..., own])))
        if is_known and wrong <= AGREEMENT:
            counts.confirmed += rows - certain
        elif is_known and unclear > CLEAR * wrong:
            counts.kept += rows - certain
        else:
            counts.differences += rows - certain
            for k in own:
                step = np.zeros(len(x))
                step[k] = STEPS[0] * self.scales[k]
                found[certain:, :, k] = self._difference(run, x, step, rows)[certain:] / step[k]

    def _difference(self, run: RecordedRun, x: Array, step: Array, rows: int) -> Array:
        """Change (rows, n) of the deviations with that of the unknowns by a step, from the central difference
        within the ranges of the unknowns; one-sided where an end has no run, 0 where none has."""
        ends: list[tuple[float, Array]] = []
        for sign in (1.0, -1.0):
            moved = np.clip(x + sign * step, self.low, self.high)
            try:
                ends.append((sign, self.deviations(run, moved, rows)))
            except SimulationError:
                ends.append((0.0, self.deviations(run, x, rows)))
        (one, above), (two, below) = ends
        return (above - below) / (one - two) if one != two else np.zeros_like(above)

    def _library(self, x: Array) -> Library:
        values = {
            self.unknowns[k].name: float(x[k])
            for k in self.common
            if self.unknowns[k].direction.kind == "parameter"
        }
        return with_parameters(self.library, values)

    def _session(self, library: Library, run: RecordedRun, x: Array) -> Session:
        """A run before its start."""
        session = Session(library, self.accuracy)
        changed = {
            self.unknowns[k].name: float(x[k])
            for k in self.common
            if self.unknowns[k].direction.kind == "input"
        }
        Inputs(session).update(self.inputs | changed)
        run.start.write(session.x, x[list(run.parts)])
        return session

    def _directions(self, library: Library, session: Session, run: RecordedRun, x: Array) -> DirectionRows:
        """The common unknowns, then those of the start."""
        of_all = self._common(library, x)
        common = of_all.arrays
        n, start = len(run.parts), common["start"].copy()
        start[:, run.start.overwritten] = 0.0
        own = run.start.rows(x[list(run.parts)], len(session.x), session.x)
        arrays = {
            name: np.ascontiguousarray(
                np.concatenate(
                    [start, own.astype(rows.dtype)]
                    if name == "start"
                    else [rows, np.full((n, *rows.shape[1:]), name == "is_permitted", dtype=rows.dtype)]
                )
            )
            for name, rows in common.items()
        }
        return DirectionRows(arrays, (*of_all.kinks, *[None] * n))

    def _common(self, library: Library, x: Array) -> DirectionRows:
        """The common unknowns, which all recordings share."""
        key = tuple(x[list(self.common)])
        if key != self._known[0]:
            directions = [self.unknowns[k].direction for k in self.common]
            changed = [each.owner for each in directions if each.kind == "input"]
            self._known = key, direction_rows(library, directions, [*self.inputs, *changed])
        assert self._known[1] is not None
        return self._known[1]

    def _tangents(
        self, session: Session, run: RecordedRun, directions: DirectionRows, rows: int
    ) -> tuple[Array, Array, list[Any]]:
        """Values (rows, n_of), derivatives (rows, n_of, n_by) and verdicts at the first times."""
        self.simulated += 1
        outputs = Outputs(session, run.comparison.of)
        arrays = directions.arrays
        tangent = TangentRun(session, arrays, len(arrays["start"]), directions.kinks)
        found = [tangent.go_on(float(time)).shown(outputs) for time in run.recording.t[:rows]]
        if tangent.outcome is not None:
            name, outcome = run.recording.name, tangent.outcome
            told = f"its run ended at t = {float(session.run.t):.6g} s: {outcome.name.lower()}"
            raise SimulationError(name, told, "", outcome.value)
        values, slopes = (
            np.array(each) for each in zip(*((row.value, row.jacobian) for row in found), strict=True)
        )
        return values, slopes, [row.verdict for row in found]

    def _whole(self, run: RecordedRun, shown: Array) -> Array:
        """What is shown, if it is finite."""
        missing = np.flatnonzero(~np.isfinite(shown).all(axis=1))
        if len(missing):
            time = run.recording.t[missing[0]]
            raise SimulationError(
                run.recording.name,
                f"a sensor of its run shows nothing at t = {time:.6g} s",
                "",
                "leave its column out",
            )
        return shown


def _apart(one: Array, other: Array) -> float:
    """Root mean square difference, relative to the second."""
    size = np.nansum(other**2)
    return float(np.sqrt(np.nansum((one - other) ** 2) / size)) if size > 0 else float(np.any(one))
