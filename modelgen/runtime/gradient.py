"""The gradient of a number that depends on a run, by going through the run backwards (discrete adjoint)."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Unpack

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import check_keywords, shown, values_by_name, with_parameters
from modelgen.runtime.core_session import Session
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.sensitivity import AT_EVENT, VERDICTS, Outputs, TangentRun, Verdict, times_of
from modelgen.runtime.sensitivity_directions import direction_rows, directions_of
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.tables.ctypes_structures import COTANGENT_ARRAYS, INTEGER, Array, address

KEYWORDS = ("loss", "of", "by", "t", "inputs", "parameters", "accuracy", *STEPPING)
CROSSING = 25  # numbers of the events of a step on the tape (MG_TAPE_CROSSING)
FIRST_CAPACITY = 256  # steps
SLOPES = 12  # of the stages of a step, on the tape
MARKS = ("moves_borders", "is_permitted")  # fields of mg_directions that are no derivatives


@dataclass(frozen=True)
class Gradient:
    """A number and its derivatives."""

    value: float
    by: tuple[str, ...]
    gradient: Array  # (n_by,)
    verdict: (
        Verdict  # along a combination of all directions; "undecided" on kinks, of which no sides are told
    )
    forward_difference: float
    """Difference between the derivative along that combination, forward, and the same from the gradient,
    relative to the sizes of its terms."""


def gradient(
    library: Library,
    t: Sequence[float] | float,
    loss: Any,
    *,
    of: Sequence[str] | None = None,
    by: Sequence[str],
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    accuracy: Accuracy | str | None = None,
    **stepping: Unpack[Stepping],
) -> Gradient:
    """Differentiate a number that depends on a run by any number of parameters, at the cost of a few runs.

    The run keeps a copy of its state before each step; cotangents are then taken backwards over steps and
    events. One forward derivative, along a combination of all directions, gives the verdict and a check.

    Args:
        library: what `build(emit(derivation, derivatives=True))` returned.
        t: ascending times, s.
        loss: a CasADi function of the values (nt, n_of) with one scalar result.
        of, by, inputs, parameters, accuracy, stepping: as those of `sensitivity`.

    Raises:
        ModelgenError: as `sensitivity` does, or `loss` is no such function, or the run ends early.
    """
    expect("gradient", library, Library)
    check_keywords("gradient", stepping, KEYWORDS)
    library = with_parameters(library, parameters)
    times = times_of(t)
    session = Session(library, accuracy_of(library.manifest.instance, accuracy, stepping))
    Inputs(session).update(values_by_name("inputs", inputs))
    outputs = Outputs(session, of)
    shape = len(times), len(outputs.names)
    check_loss(loss, shape)
    directions = directions_of(library.manifest.instance, by)
    known = direction_rows(library, directions, inputs or {})
    rows = known.arrays
    weights = np.random.default_rng(0).uniform(0.5, 1.0, len(directions))
    combined = {
        name: np.ascontiguousarray((weights @ array)[None, :])
        for name, array in rows.items()
        if name not in MARKS
    }
    combined["moves_borders"] = np.array([np.any(rows["moves_borders"])], dtype=INTEGER)
    combined["is_permitted"] = np.ones(1, dtype=INTEGER)
    starts = Session(library, session.accuracy)
    Inputs(starts).update(values_by_name("inputs", inputs))
    at_start = TangentRun(starts, rows, len(directions), known.kinks).verdict()
    run = TapedRun(session, combined)
    marks, shown = [], []
    for time in times:
        run.go_on(float(time))
        marks.append(run.steps)
        shown.append(run.shown(outputs))
    if run.outcome is not None:
        found = f"the run ended at t = {float(session.run.t):.6g} s: {run.outcome.name.lower()}"
        raise SimulationError("gradient", found, "", run.outcome.value)
    values = np.array([each.value for each in shown])
    along = np.array([each.jacobian[:, 0] for each in shown])
    number = loss(values)
    seeds = np.array(loss.reverse(1)(values, number, 1.0)).reshape(shape)
    bars = run.cotangents(outputs, marks, seeds)
    terms = [(rows["start"] @ bars["x"]), *(rows[name] @ bars[name] for name in COTANGENT_ARRAYS[1:])]
    found_gradient = np.sum(terms, axis=0)
    verdict = max((at_start, *(each.verdict for each in shown)), key=lambda each: VERDICTS.index(each.kind))
    if verdict.kind == VERDICTS[1] and verdict.reason != AT_EVENT:
        verdict = replace(verdict, kind=VERDICTS[2])  # the combination tells no side of each number
    forward, size = float(np.sum(seeds * along)), float(np.sum(np.abs(seeds * along)))
    return Gradient(
        value=float(number),
        by=tuple(direction.name for direction in directions),
        gradient=found_gradient,
        verdict=verdict,
        forward_difference=abs(forward - float(weights @ found_gradient)) / size if size else 0.0,
    )


def check_loss(loss: Any, shape: tuple[int, int]) -> None:
    """Raises SimulationError unless it is a CasADi function from that shape to a scalar."""
    if not hasattr(loss, "n_in") or not hasattr(loss, "reverse") or (loss.n_in(), loss.n_out()) != (1, 1):
        raise SimulationError("loss", shown(loss), f"a CasADi function of one matrix of shape {shape}")
    if loss.size_in(0) != shape or loss.size_out(0) != (1, 1):
        found = f"a function from {loss.size_in(0)} to {loss.size_out(0)}"
        raise SimulationError("loss", found, f"a function from {shape} to (1, 1)")


class TapedRun(TangentRun):
    """A run along one direction that keeps what is needed to go back."""

    def __init__(self, session: Session, arrays: Mapping[str, Array]) -> None:
        self._capacity = 0
        self._bytes, self._crossing = np.zeros(0, dtype=np.uint8), np.zeros(0, dtype=INTEGER)
        self._slopes = np.zeros(0, dtype=session.tables.dtype)
        super().__init__(session, arrays, 1)
        self._size = session.shared.checkpoint_size
        self._tape = session.tables.Tape(0, 0, None, None, None, 0)
        self._grow()
        self._tangent.tape = ctypes.addressof(self._tape)

    def _grow(self) -> None:
        capacity = max(2 * self._capacity, FIRST_CAPACITY)
        bytes_ = np.zeros((capacity + 1) * self._size, dtype=np.uint8)
        crossing = np.zeros(CROSSING * capacity, dtype=INTEGER)
        slopes = np.zeros(SLOPES * self.session.n_x * capacity, dtype=self.session.tables.dtype)
        bytes_[: len(self._bytes)], crossing[: len(self._crossing)] = self._bytes, self._crossing
        slopes[: len(self._slopes)] = self._slopes
        self._bytes, self._slopes, self._crossing, self._capacity = bytes_, slopes, crossing, capacity
        self._tape.capacity, self._tape.bytes = capacity, address(bytes_)
        self._tape.slopes, self._tape.crossing = address(slopes), address(crossing)

    @property
    def steps(self) -> int:
        """Steps on the tape."""
        return int(self._tape.count)

    def on_full(self) -> None:
        if self._tape.count >= self._tape.capacity:
            self._grow()

    def cotangents(self, outputs: Outputs, marks: Sequence[int], seeds: Array) -> dict[str, Array]:
        """Derivatives of a number by start and tables, from those by the values at the times of the marks."""
        session, tables, cdll = self.session, self.session.tables, self._cdll
        bars = {
            name: np.zeros(self._arrays["start" if name == "x" else name].shape[1], dtype=tables.dtype)
            for name in COTANGENT_ARRAYS
        }
        memory = self._memory
        adjoint = tables.Adjoint(
            *(address(bars[name]) for name in COTANGENT_ARRAYS), *map(address, (*memory, self._given_state))
        )
        given, tape = ctypes.byref(adjoint), ctypes.byref(self._tape)
        end = marks[-1]

        def go_back(first: int, last: int) -> None:
            cdll.mg_go_back(
                *self._head, tape, ctypes.c_long(first), ctypes.c_long(last), given, *self._scratch
            )

        for mark, seed in zip(reversed(marks), reversed(seeds), strict=True):
            interruptible(partial(go_back, end, mark), session.stop)
            end = mark
            sensed = np.zeros(max(session.shared.n_sensor, 1), dtype=tables.dtype)
            for weight, sensor, state in zip(seed, outputs.sensors, outputs.states, strict=True):
                if sensor >= 0:
                    sensed[sensor] += weight
                else:
                    bars["x"][state] += weight
            if np.any(sensed):
                cdll.mg_sense_adjoint(*self._head, ctypes.c_void_p(address(sensed)), given, *self._scratch)
        interruptible(partial(go_back, end, 0), session.stop)
        cdll.mg_go_back_to_start(*self._head, given, *self._scratch)
        return bars
