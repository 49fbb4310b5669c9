"""Derivatives of runs by differences of runs, extrapolated: slower, and without a verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.sensitivity import Outputs, TangentRun, times_of
from modelgen.runtime.sensitivity_directions import Direction, direction_arrays, directions_of, extrapolated
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array

STEP, LEVELS = 2e-4, 3  # of a direction, relative to the size of its number; of the extrapolation
STEPS = 1_000_000  # in one call of the core


def run_differences(
    library: Library,
    t: Sequence[float] | float,
    *,
    of: Sequence[str] | None = None,
    by: Sequence[str],
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    accuracy: Accuracy | str | None = None,
    step: float = STEP,
) -> Array:
    """Derivatives (nt, n_of, n_by) as `sensitivity` has them, from central differences of runs whose steps
    are halved LEVELS - 1 times and extrapolated (Richardson). NaN where a run has ended early.

    Args:
        library: one with derivatives; they only project changes of starts onto constraints.
        step: the largest change, relative to the size of a parameter or input, absolute of a start.
        others: as those of `sensitivity`.
    """
    runs = _Runs(library, times_of(t), of, parameters or {}, inputs or {}, accuracy)
    columns = [
        extrapolated(runs.along(direction), step * runs.size(direction), LEVELS)
        for direction in directions_of(library.manifest.instance, by)
    ]
    return np.stack(columns, axis=-1)


class _Runs:
    """Runs that differ from one by a change along one direction."""

    def __init__(
        self,
        library: Library,
        times: Array,
        of: Sequence[str] | None,
        parameters: Mapping[str, float],
        inputs: Mapping[str, float],
        accuracy: Accuracy | str | None,
    ) -> None:
        self._library, self._times, self._of = library, times, of
        self._parameters, self._accuracy = dict(parameters), accuracy
        self._inputs = dict(inputs)  # the others have their defaults, which may follow from parameters

    def _session(self, library: Library) -> Session:
        return Session(library, accuracy_of(library.manifest.instance, self._accuracy, {}))

    def _value(self, direction: Direction) -> float:
        """The number that a parameter or input has in the run."""
        if direction.kind == "input" and direction.owner in self._inputs:
            return self._inputs[direction.owner]
        key, of = ("inputs", "default") if direction.kind == "input" else ("parameters", "value")
        entries = with_parameters(self._library, self._parameters).manifest.instance[key]
        return next(float(each[of]) for each in entries if each["name"] == direction.owner)

    def size(self, direction: Direction) -> float:
        """The size of the number of a direction."""
        return 1.0 if direction.kind == "start" else abs(self._value(direction)) or 1.0

    def along(self, direction: Direction) -> _Along:
        return _Along(self, direction)

    def shown(self, direction: Direction, change: float) -> Array:
        """The values (nt, n_of) of a run with a change along a direction."""
        parameters, inputs = dict(self._parameters), dict(self._inputs)
        if direction.kind == "parameter":
            parameters[direction.owner] = self._value(direction) + change
        if direction.kind == "input":
            inputs[direction.owner] = self._value(direction) + change
        library = with_parameters(self._library, parameters)
        session = self._session(library)
        Inputs(session).update(inputs)
        if direction.kind == "start":
            self._change_start(session, direction, change)
        begin(session)
        outputs, record = Outputs(session, self._of), session.tables.Record()
        rows, code = [], CONTINUE
        for time in self._times:
            while (code := session.advance(float(time), STEPS, record)) in (CONTINUE, FULL):
                session.drain_events()
            values = outputs.values(session)
            rows.append(np.full_like(values, np.nan) if code else values)
        return np.array(rows)

    def _change_start(self, session: Session, direction: Direction, change: float) -> None:
        """Change the start, as joints and blows correct it, as far as its constraints permit."""
        arrays = direction_arrays(session.library, [direction], self._parameters, self._inputs)
        run = TangentRun(self._session(session.library), arrays, 1)
        session.x[:] = run.session.x + change * run.state_derivatives()[0]
        for body in session.instance["bodies"]:
            if body["motion"] == "free":
                session.x[body["q"] + 3 : body["q"] + 7] /= np.linalg.norm(
                    session.x[body["q"] + 3 : body["q"] + 7]
                )


class _Along:
    """The values of runs as a function of the change along one direction."""

    def __init__(self, runs: _Runs, direction: Direction) -> None:
        self._runs, self._direction = runs, direction

    def __call__(self, change: float) -> Array:
        return self._runs.shown(self._direction, change)
