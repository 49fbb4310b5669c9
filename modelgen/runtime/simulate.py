"""A run from t = 0 to its end: set-up, calls of the core, samples, outcome."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Unpack

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.runtime.accuracy import TENTH, Accuracy
from modelgen.runtime.arguments import (
    check_flag,
    check_function,
    check_keywords,
    check_span,
    check_whole,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.error_estimate import ORDERS, estimate_of, nudge, steps_max
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.recording import Recording
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Event, Outcome, Trajectory
from modelgen.runtime.trajectory_of_run import Ending, trajectory_of
from modelgen.runtime.trust import with_trust
from modelgen.runtime.warnings import warnings
from modelgen.runtime.warnings.nonfinite import unbounded

KEYWORDS = (
    "until",
    "accuracy",
    "samples",
    "estimate",
    "parameters",
    "inputs",
    "on_progress",
    *STEPPING,
)  # of `simulate`
THIRD = 4  # times the steps of the companion that a third run may take
CHUNK_S = 0.2  # wall time between two looks at the keyboard, s

Report = Callable[[float], None] | None  # told the share that is done
Schedule = Sequence[tuple[float, Array]]  # times, s, and the settings of the inputs up to each


def simulate(
    library: Library,
    *,
    until: float | None = None,
    accuracy: Accuracy | str | None = None,
    samples: int | None = None,
    estimate: bool | None = None,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    on_progress: Callable[[float], None] | None = None,
    **stepping: Unpack[Stepping],
) -> Trajectory:
    """Run the scene of a library.

    Args:
        library: what `build` returned.
        until: end time, s; the scene's own when None.
        accuracy: every tolerance and choice, or "coarse", "fast", "balanced", "tight"; the scene's own when
            None.
        samples: output intervals, at least 1; the scene's own when None.
        estimate: whether a companion run, of 1.2 to 1.6 times the cost as a rule, follows, from which the
            error is estimated; the scene's own, or True, when None.
        parameters: values of parameters of the scene by name, in SI units; others keep the scene's own.
        inputs: values of inputs of the scene by name, for the whole run; the scene's defaults for the others.
        on_progress: called with the share of the work done, about five times a second.
        stepping: method, step, scheme, solver, fallback, in place of the accuracy's or scene's (`Accuracy`).

    Returns:
        The samples at `samples + 1` equally spaced times up to where the run came, with events and ledger.
        Ctrl-C and failures keep what was computed, with one more sample at the end, and say so.

    Raises:
        ModelgenError: what is given is no library, or the start, a setting, or the value of a parameter, is
            refused (SimulationError).
    """
    expect("simulate", library, Library)
    check_keywords("simulate", stepping, KEYWORDS)
    check_flag("estimate", estimate)
    check_function("on_progress", on_progress)
    library = with_parameters(library, parameters)
    instance = library.manifest.instance
    end, intervals = _extent(instance, until, samples)
    chosen = accuracy_of(instance, accuracy, stepping)
    doubled = instance["run"].get("estimate", True) if estimate is None else estimate
    half = _part(on_progress, 0.0, 0.5 if doubled else 1.0)
    session = Session(library, chosen)
    Inputs(session).update(values_by_name("inputs", inputs))
    schedule = [(end, session.input.copy())]
    times = np.linspace(0.0, end, intervals + 1)
    path = _path(session, schedule, times, half)
    while path.outcome is Outcome.TOO_MANY_NEAR:
        from modelgen.codegen.library_with_slots import with_more_slots  # few runs need it

        library = with_more_slots(library, int(session.run.report.exceeded_pool))
        session = Session(library, chosen)
        path = _path(session, schedule, times, half)
    path = _with_passages(path, chosen, library)
    told = _part(on_progress, 0.5, 1.0)
    stated = _estimate(library, chosen, schedule, path, told) if doubled and len(path.t) else None
    return with_trust(path, stated, chosen, instance)


def _with_passages(path: Trajectory, accuracy: Accuracy, library: Library) -> Trajectory:
    """The run with the pairs that passed through each other because no contact lists them, or at an open
    edge."""
    instance = library.manifest.instance
    if not (instance["unlisted"]["shapes"] or instance["open_edges"]["pairs"]):
        return path
    from modelgen.runtime.passages import (  # many scenes do not need these two
        passages,
        passages_over_edges,
    )
    from modelgen.runtime.warnings.overlap_warnings import edge_warning, passage_warnings

    found = passages(path, library, accuracy.thresholds.overlap_depth)
    told = passage_warnings(found, path.t[0]) if found else ()
    over = passages_over_edges(path, library, accuracy.thresholds.overlap_depth)
    warnings = (*path.warnings, *told, *map(edge_warning, over))
    return replace(path, undeclared=found, over_edges=over, warnings=warnings)


def _part(report: Report, start: float, end: float) -> Report:
    """The progress of a part, converted to progress of the whole."""
    return report and (lambda share: report(start + (end - start) * share))


def repeated(library: Library, accuracy: Accuracy, schedule: Schedule) -> Trajectory:
    """A run that was driven by these inputs, made again, with samples at the ends of the schedule; with its
    estimate, for which its companion has the same inputs, and its doubts.

    Raises SimulationError if it cannot start.
    """
    times = np.unique([0.0, *(until for until, _ in schedule)])
    path = _path(Session(library, accuracy), schedule, times, None)
    instance = library.manifest.instance
    path = _with_passages(path, accuracy, library)
    return with_trust(path, _estimate(library, accuracy, schedule, path, None), accuracy, instance)


def _path(
    session: Session,
    schedule: Schedule,
    times: Array,
    report: Report,
    most: int = 0,
    change: tuple[float, Array] | None = None,
) -> Trajectory:
    """One run, with samples at `times`, of at most `most` steps, if that is not 0. `change`: a time, s, at
    which so much is added to its coordinates q."""
    started = time.perf_counter()
    session.input[:] = schedule[0][1]
    begin(session)
    session.run.steps_max = most
    recording = Recording(session, times)
    ending = Ending(Outcome.DONE, [])
    if change is not None:
        at = bisect_left([end for end, _ in schedule], change[0])
        ending = _run(session, [*schedule[:at], (change[0], schedule[at][1])], recording, report)
        session.x[: len(change[1])] += change[1]
        schedule = schedule[at:]
    if ending.outcome is Outcome.DONE:
        rest = _run(session, schedule, recording, report)
        ending = rest._replace(events=[*ending.events, *rest.events])
    recording.end()
    return trajectory_of(
        session,
        session.run,
        recording.columns(),
        ending,
        doubts=session.doubts(session.run, 0),  # whether it ended early is seen from its outcome
        wall_s=time.perf_counter() - started,
        warnings=warnings(session, session.accuracy, ending.events),
        outcome_function=unbounded(session, ending.outcome),
        inputs=dict(Inputs(session)),
    )


def _estimate(
    library: Library,
    accuracy: Accuracy,
    schedule: Schedule,
    path: Trajectory,
    report: Report,
) -> Estimate:
    """The error estimate of a run, by its companion; None after an interruption."""
    instance = library.manifest.instance
    if path.interrupted:
        return estimate_of(path, None, accuracy, instance, "the run was interrupted: no companion followed")
    try:
        twin = Session(library, accuracy.companion(float(np.finfo(library.dtype).eps)))
        nudge(twin.x, twin.instance)
        followed = _followed(schedule, path, accuracy)
        most = steps_max(accuracy, path.steps, path.rejected)
        found = _path(twin, followed, path.t, report, most)
        finer = partial(_finer, library, accuracy, followed, found)
        other = partial(in_other_order, library, accuracy, schedule, path)
        return estimate_of(path, found, accuracy, instance, finer=finer, other_order=other)
    except SimulationError as refused:
        why = f"the companion run did not start: {refused}"
        return estimate_of(path, None, accuracy, instance, why)
    except KeyboardInterrupt:
        stopped = estimate_of(path, None, accuracy, instance, "the companion run was interrupted")
        return replace(stopped, interrupted=True)


def _finer(
    library: Library, accuracy: Accuracy, followed: Schedule, twin: Trajectory, until: float
) -> Trajectory | None:
    """The companion of a companion, up to the next end of a step that this has from `until` on; None if it
    does not start."""
    epsilon = float(np.finfo(library.dtype).eps)
    schedule = followed[: bisect_left([end for end, _ in followed], until) + 1]
    try:
        session = Session(library, accuracy.companion(epsilon).companion(epsilon))
        return _path(session, schedule, twin.t[twin.t <= schedule[-1][0]], None, THIRD * twin.steps)
    except SimulationError:
        return None


def in_other_order(
    library: Library, accuracy: Accuracy, schedule: Schedule, path: Trajectory, tie: tuple[Event, Event]
) -> Trajectory | None:
    """The run with two of its impacts in the other order, or None where no small change brings that about."""
    from modelgen.runtime.order_of_impacts import LEAD, is_reversed, reversing_change  # few runs need it

    before = tie[0].t - LEAD * (tie[1].t - tie[0].t)
    until = bisect_left([end for end, _ in schedule], before)
    if before <= 0:
        return None
    try:
        session = Session(library, accuracy)
        first = _path(
            session, [*schedule[:until], (before, schedule[until][1])], path.t[:1], None, THIRD * path.steps
        )
        change = reversing_change(session, path, tie) if first.outcome is Outcome.DONE else None
        if first.interrupted:
            raise KeyboardInterrupt
        if change is None:
            return None
        made = _path(Session(library, accuracy), schedule, path.t, None, THIRD * path.steps, change)
    except SimulationError:
        return None
    if made.interrupted:
        raise KeyboardInterrupt
    return made if is_reversed(path, made, tie) else None


def _followed(schedule: Schedule, path: Trajectory, accuracy: Accuracy) -> Schedule:
    """The schedule of the companion of a run: up to where the run came and, if its steps adapt, with the end
    of a step at each sample or, where samples are denser than steps, at some that are evenly spread.

    The error of states between the ends of a step changes its sign there. A sample that has a step to itself
    may lie near such a zero of the run, where an interpolated companion errs as much. At samples denser than
    steps the interpolants err, and those of a companion with steps as long err alike: its steps are at most
    TENTH of the mean step of the run, so that theirs is a tenth.
    """
    ends = {min(until, path.t_end) for until, _ in schedule}
    if accuracy.method not in ORDERS:
        every = max(int(TENTH * (len(path.t) - 1) / max(path.steps, 1)), 1)
        ends |= set(path.t[every::every].tolist())
    untils = [until for until, _ in schedule]
    return [(end, schedule[bisect_left(untils, end)][1]) for end in sorted(ends)]


def _extent(instance: Mapping[str, Any], until: float | None, samples: int | None) -> tuple[float, int]:
    """End time and number of output intervals, by default those of the scene."""
    run, scene = instance["run"], f"{instance['source']}: run."
    end: Any = run["until"] if until is None else until
    intervals: Any = run["samples"] if samples is None else samples
    check_span(f"{scene}until" if until is None else "until", end, "give the end of the run")
    where = f"{scene}samples" if samples is None else "samples"
    return float(end), check_whole(where, intervals, "give the number of output intervals")


def _advance_of(session: Session) -> Callable[[float, int, Any], int]:
    """`session.advance`, of which Ctrl-C ends a call soon also where one step may take long."""
    if not session.may_take_long:
        return session.advance
    from modelgen.runtime.interruptible_advance import interruptible  # not every scene needs it

    return lambda until, chunk, record: interruptible(
        partial(session.advance, until, chunk, record), session.stop
    )


def _run(session: Session, schedule: Schedule, recording: Recording, report: Report) -> Ending:
    if session.start_code:
        return Ending(OUTCOME_OF_CODE[session.start_code], session.drain_events())
    events: list[Event] = []
    chunk, end, code = 1, schedule[-1][0], CONTINUE
    try:
        advance = _advance_of(session)
        for until, settings in schedule:
            session.input[:] = settings
            code = CONTINUE
            while code in (CONTINUE, FULL):
                before = time.perf_counter()
                code = advance(until, chunk, recording.record)
                events += session.drain_events()
                if code == CONTINUE:
                    elapsed = max(time.perf_counter() - before, 1e-6)
                    chunk = int(min(max(chunk * CHUNK_S / elapsed, 1), 10 * chunk))
                if report and code in (CONTINUE, FULL):
                    report(float(session.run.t) / end)
            if code:
                break
        return Ending(OUTCOME_OF_CODE[code], events)
    except KeyboardInterrupt:
        outcome = Outcome.DONE if session.run.t >= end else Outcome.INTERRUPTED
        return Ending(outcome, events + session.drain_events(), interrupted=True)
