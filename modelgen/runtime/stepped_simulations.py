"""Many runs of one library that their caller drives together, each with its own numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import (
    check_keywords,
    check_span,
    check_whole,
    checked_starts,
    lane_in,
    lanes_in,
    one_or_each,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.by_name import ByName
from modelgen.runtime.inputs_by_lane import InputsByLane
from modelgen.runtime.sensors import parts_of
from modelgen.runtime.session_group import SessionGroup, group_of
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import Event, Outcome, doubt_kinds

KEYWORDS = ("parameters", "inputs", "q", "u", "accuracy", "threads", *STEPPING)  # of `start_many`
Values = Mapping[str, Any]  # by name: one number, or one for each lane


def start_many(
    library: Library,
    n: int,
    *,
    parameters: Values | None = None,
    inputs: Values | None = None,
    q: Array | None = None,
    u: Array | None = None,
    accuracy: Accuracy | str | None = None,
    threads: int = 1,
    **stepping: Unpack[Stepping],
) -> Simulations:
    """Start n runs, the lanes, that the caller drives together.

    Args:
        library: what `build` returned.
        n: number of lanes.
        parameters: values of parameters of the scene by name, one number or (n,); the scene's for others.
        inputs: values of inputs at t = 0, one number or (n,); the scene's defaults for the others.
        q, u: (n, n_q) and (n, n_u) starts, laid out as in the manifest; the scene's own when None.
        accuracy: every tolerance and choice, or "coarse", "fast", "balanced", "tight"; the scene's own when
            None.
        threads: in which the core works; no Python runs in them.
        stepping: method, step, scheme, solver, fallback, in place of the accuracy's or scene's (`Accuracy`).

    A lane does bit for bit what `start` with the same numbers does. One that cannot start, or fails, stays
    where it is (`outcomes`), and the others go on.

    Raises:
        ModelgenError: an argument is not what it says, or every lane is refused; the message names the first.
    """
    expect("start_many", library, Library)
    check_keywords("start_many", stepping, KEYWORDS)
    n = check_whole("n", n, "give the number of runs")
    libraries = _libraries(library, n, values_by_name("parameters", parameters))
    accuracies = [accuracy_of(each.manifest.instance, accuracy, stepping) for each in libraries]
    group = group_of(library, libraries, accuracies)
    _write(group, group.x, q, u)
    many = Simulations(group, libraries, threads)
    for name, values in values_by_name("inputs", inputs).items():
        many.inputs[name] = values
    many.inputs.restart(np.arange(n))
    refused = group.begin(threads)
    if len(refused) == n:
        raise refused[0]
    many.refused = refused
    return many


class Simulations:
    """Runs between two steps; arrays are by lane. `start_many` makes them.

    Attributes:
        n: number of lanes.
        inputs: by name, (n,) present values that are written to: `many.inputs["push"][:] = values`.
        refused: the errors of lanes that could not start, by lane.
    """

    def __init__(self, group: SessionGroup, libraries: list[Library], threads: int) -> None:
        self._group = group
        self._libraries = libraries  # whose tables the lanes use
        self._threads = threads
        self._starts = group.x.copy()
        self._parts = parts_of(group.library.manifest.instance["sensors"]["names"])
        self.n = group.n
        self.inputs = InputsByLane(group, libraries)
        self.refused: dict[int, SimulationError] = {}

    @property
    def t(self) -> Array:
        """(n,) time of each lane, s."""
        return self._group.t.copy()

    @property
    def state(self) -> Array:
        """(n, n_x) q and u of all bodies, eta of all contacts, work: the core's own array, to be read."""
        return self._group.x

    @property
    def outcomes(self) -> tuple[Outcome | None, ...]:
        """DONE where a lane can go on, else why it ended; None where it could not start."""
        return self._group.outcomes

    @property
    def doubts(self) -> tuple[tuple[str, ...], ...]:
        """What the figures of each lane speak against so far, of DOUBT_KINDS; empty: nothing. Errors are
        not estimated."""
        return tuple(doubt_kinds(self._group.doubts(lane)) for lane in range(self.n))

    @property
    def ended(self) -> Array:
        """(n,) whether a lane has failed or could not start."""
        return self._group.codes >= 10

    @property
    def sensors(self) -> Mapping[str, Array]:
        """What the sensors show by name: (n,), or (n, 3) and (n, 4)."""
        shown = self._group.sense(self._threads)
        return ByName({name: shown[:, part].copy() for name, part in self._parts.items()}, "sensor")

    def step(self, duration: float, lanes: Array | None = None) -> None:
        """Let each lane go on by a duration, s, or those of `lanes`, (n,) of bool or indices. Lanes that
        have ended stay where they are.

        Raises SimulationError where the duration or lanes are none, or an input is beyond its range.
        """
        check_span("step", duration, "give the duration in s")
        self.inputs.check()
        going = np.zeros(self.n, dtype=bool)
        going[slice(None) if lanes is None else lanes_in("step: lanes", lanes, self.n)] = True
        self._group.advance(self._group.t + np.where(going, duration, 0.0), self._threads)
        self.inputs.refresh()

    def events(self, lane: int) -> list[Event]:
        """The events of a lane since the last call; raises SimulationError for what is no lane."""
        return self._group.drain_events(lane_in("events", lane, self.n))

    def reset(self, lanes: Any, q: Array | None = None, u: Array | None = None) -> None:
        """Put lanes back to their start at t = 0; their inputs stay as they are.

        Args:
            lanes: (n,) of bool, or indices.
            q, u: other starts, (n, n_q) and (n, n_u), by lane.

        Values of inputs with hold = "linear" may be written to before, from which the lanes start.

        Raises SimulationError where lanes are none, or such a start is refused.
        """
        chosen = lanes_in("reset: lanes", lanes, self.n)
        starts = self._starts.copy()
        _write(self._group, starts, q, u)
        self.inputs.restart(chosen)
        for lane in chosen.tolist():
            self.refused.pop(lane, None)
            try:
                self._group.begin_again(lane, starts[lane])
            except SimulationError as refusal:
                self.refused[lane] = refusal
                raise

    def save(self) -> bytes:
        """The states of all lanes, their inputs and outcomes included. Loaded into as many runs of the same
        library, parameters and settings, also in another process and in other numbers of threads, they go on
        bit for bit. Events that were not asked for are not part of it, nor is the start to which `reset` puts
        lanes back."""
        return self._group.save_all()

    def load(self, mark: bytes) -> None:
        """Put all lanes into saved states. Raises SimulationError, with the lanes as they were, where `mark`
        is not what `save` returned for as many runs with the same library, parameters and settings; it says
        what differs."""
        self._group.load_all(mark)
        self.inputs.refresh()
        self.refused = self._group.refusals()


def _libraries(library: Library, n: int, parameters: Values) -> list[Library]:
    """The library with the numbers of each lane."""
    by_lane = {name: one_or_each(f"parameter {name!r}", values, n) for name, values in parameters.items()}
    if not by_lane:
        return [library] * n
    return [
        with_parameters(library, {name: float(values[lane]) for name, values in by_lane.items()})
        for lane in range(n)
    ]


def _write(group: SessionGroup, x: Array, q: Array | None, u: Array | None) -> None:
    """Write starts into states (n, n_x); raises SimulationError where they do not fit."""
    n_q, n_u = (group.library.manifest.instance[key] for key in ("n_q", "n_u"))
    for name, values, first, size in (("q", q, 0, n_q), ("u", u, n_q, n_u)):
        if values is not None:
            x[:, first : first + size] = checked_starts(name, values, size, group.n)
