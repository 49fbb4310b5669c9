"""Derivatives of runs by differences of runs, extrapolated: slower, and without a verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import RUN_DIFFERENCE, Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.sensitivity import (
    APART,
    LARGER,
    SIDES,
    SMALLER,
    VERDICTS,
    Outputs,
    Sensitivity,
    TangentRun,
    Verdict,
    times_of,
)
from modelgen.runtime.sensitivity_directions import (
    Direction,
    direction_arrays,
    directions_of,
    extrapolated_from_one_side,
    extrapolated_with_error,
)
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array

STEP, LEVELS = 2e-4, 3  # of a direction, relative to the size of its number; of the extrapolation
STEPS = 1_000_000  # in one call of the core
SAFE = 10.0  # times the estimated error of a difference
ROUGH = 100.0  # times the tolerance of a run: errors of what it shows, of the size of that


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
    runs = Runs(library, times_of(t), of, parameters, inputs, accuracy)
    return differences_with_errors(runs, directions_of(library.manifest.instance, by), step)[0]


def differences_with_errors(
    runs: Runs, directions: Sequence[Direction], step: float = STEP
) -> tuple[Array, Array]:
    """Those differences and their errors, both (nt, n_of, n_by): by how much the last extrapolation changes
    them, and what the runs resolve."""
    columns, errors = [], []
    for direction in directions:
        longest = step * runs.size(direction)
        value, error = extrapolated_with_error(runs.along(direction), longest, LEVELS)
        columns.append(value)
        errors.append(error + runs.roughness * 2 ** (LEVELS - 1) / longest)
    return np.stack(columns, axis=-1), np.stack(errors, axis=-1)


def checked(
    found: Sensitivity, library: Library, t: Sequence[float] | float, *, by: Sequence[str], **settings: Any
) -> tuple[Sensitivity, Array]:
    """Derivatives with the verdicts that remain beside differences of runs, and these differences; arguments
    are those of `run_differences`. Where a derivative holds for one side, they are of runs to that side."""
    runs, directions = Runs(library, times_of(t), **settings), directions_of(library.manifest.instance, by)
    differences, errors = differences_with_errors(runs, directions)
    for k, direction in enumerate(directions):
        for side, sign in ((SIDES[LARGER], 1.0), (SIDES[SMALLER], -1.0)):
            of_side = found.sides[..., k] == side
            if np.any(of_side):
                value, error = _of_one_side(runs, direction, sign)
                differences[..., k] = np.where(of_side, value, differences[..., k])
                errors[..., k] = np.where(of_side, error, errors[..., k])
    return compared(found, differences, errors), differences


def _of_one_side(runs: Runs, direction: Direction, sign: float) -> tuple[Array, Array]:
    """Differences of runs to one side of a direction, and their errors, both (nt, n_of)."""
    longest = sign * STEP * runs.size(direction)
    value, error = extrapolated_from_one_side(runs.along(direction), longest, LEVELS + 1)
    return value, error + runs.roughness * 2 ** (LEVELS + 1) / abs(longest)


def compared(found: Sensitivity, differences: Array, errors: Array) -> Sensitivity:
    """Derivatives with the verdicts that remain beside differences of runs.

    A derivative agrees if |derivative - difference| <= SAFE error + RUN_DIFFERENCE |difference|.
    Where one that is said to hold, for both sides or for one, does not agree, it is "unknown" for which
    changes it does, and the verdict is "undecided" from that time on.
    """
    apart = np.abs(found.jacobian - differences) > SAFE * errors + RUN_DIFFERENCE * np.abs(differences)
    apart &= np.isin(found.sides, SIDES[:3])
    verdicts, from_here = [], False
    for verdict, t, at in zip(found.verdicts, found.t, apart, strict=True):
        from_here |= bool(np.any(at))
        stays = not from_here or verdict.kind == VERDICTS[2]
        verdicts.append(verdict if stays else Verdict(VERDICTS[2], APART, float(t)))
    sides = np.where(np.logical_or.accumulate(apart), SIDES[4], found.sides)
    return replace(found, verdicts=tuple(verdicts), sides=sides)


class Runs:
    """Runs that differ from one by a change along one direction."""

    def __init__(
        self,
        library: Library,
        times: Array,
        of: Sequence[str] | None = None,
        parameters: Mapping[str, float] | None = None,
        inputs: Mapping[str, float] | None = None,
        accuracy: Accuracy | str | None = None,
    ) -> None:
        """The library, the times, what of, parameters, inputs and accuracy of `run_differences`."""
        self._library, self._times, self._of = library, times, of
        self._parameters, self._accuracy = dict(parameters or {}), accuracy
        self._inputs = dict(inputs or {})  # the others have their defaults, which may follow from parameters

    @cached_property
    def roughness(self) -> Array:
        """By how much the values (nt, n_of) of a run are rough."""
        values = self.shown(None, 0.0)
        tolerance = accuracy_of(self._library.manifest.instance, self._accuracy, {}).tolerance
        return np.asarray(ROUGH * tolerance * np.max(np.abs(values), axis=1, keepdims=True) + 0 * values)

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

    def along(self, direction: Direction) -> Callable[[float], Array]:
        """The values of runs as a function of the change along a direction."""
        return partial(self.shown, direction)

    def shown(self, direction: Direction | None, change: float) -> Array:
        """The values (nt, n_of) of a run with a change along a direction."""
        parameters, inputs = dict(self._parameters), dict(self._inputs)
        if direction is not None and direction.kind == "parameter":
            parameters[direction.owner] = self._value(direction) + change
        if direction is not None and direction.kind == "input":
            inputs[direction.owner] = self._value(direction) + change
        library = with_parameters(self._library, parameters)
        session = self._session(library)
        Inputs(session).update(inputs)
        if direction is not None and direction.kind == "start":
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
        arrays = direction_arrays(session.library, [direction], self._inputs)
        run = TangentRun(self._session(session.library), arrays, 1)
        session.x[:] = run.session.x + change * run.state_derivatives()[0]
        for body in session.instance["bodies"]:
            if body["motion"] == "free":
                session.x[body["q"] + 3 : body["q"] + 7] /= np.linalg.norm(
                    session.x[body["q"] + 3 : body["q"] + 7]
                )
