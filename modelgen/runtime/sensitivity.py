"""Derivatives of a run by its start, its inputs and the parameters of its scene."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Unpack

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.name_suggestions import listed, nearest
from modelgen.notation import component_names
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import (
    check_flag,
    check_keywords,
    names_in,
    numbers_in,
    shown,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.error_estimate import ROUNDED, SAFE, nudge
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.sensitivity_directions import NumberOnKink, direction_rows, directions_of
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.solver_choice import raise_failure
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import DIRECTION_ARRAYS, INTEGER, Array, address
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Event, Outcome

STEPS = 1_000_000  # in one call of the core
EVENTS = 4096  # of which the derivatives of the time are kept
KEYWORDS = ("of", "by", "t", "inputs", "parameters", "accuracy", "estimate", *STEPPING)
VERDICTS = ("differentiable", "one-sided", "undecided")  # MG_VERDICT_DIFFERENTIABLE ..
REASONS = (  # MG_NO_REASON ..
    "",
    "a part of the run is time-stepping",
    "a face tilts onto its rim",
    "slip begins in a direction that depends on the change",
    "slow slip is turned fast by friction",
    "several events happen at one time",
    "the impulses of a blow are not unique",
    "faces come to rest on each other, or rub",
    "a singular contact is passed by an impulse",
    "an event function only touches zero",
    "bounces that grow ever shorter are cut off",
    "slip dies in three dimensions",
    "the law of an impact is not differentiated",
    "state or accelerations jump",
    "the start is corrected by an impact",
    "friction differs from direction to direction",
    "the border of a feature moves",
    "a load jumps where the motion takes it",
    "a closed contact carries no load, and a change makes it press or open",
    "contact forces stay at their bound, and a change leads to either side of it",
    "a load stays on a kink, or starts at a jump",
    "a parameter moves the start of a contact that touches, which opens on one side alone",
    "a sensor is on a kink or at a jump",
    "a sensor shows forces that are not unique",
)
AT_EVENT = "an event happens at this very time"
NOT_FINITE = "a derivative is not finite"
APART = "differences of runs do not agree"
OF_NUMBERS = "numbers that follow from a parameter are on a kink"
DOUBTS = (*REASONS, AT_EVENT, NOT_FINITE, APART, OF_NUMBERS)  # every reason of a verdict
LARGER, SMALLER, BOTH, UNKNOWN = 1, 2, 3, 4  # MG_SIDE_LARGER ..
SIDES = ("both", "larger", "smaller", "neither", "unknown")
NAME_OF_SIDES = {BOTH: SIDES[0], LARGER: SIDES[1], SMALLER: SIDES[2], 0: SIDES[3]}


@dataclass(frozen=True)
class Verdict:
    """Whether derivatives hold: "differentiable"; "one-sided", some for changes to one side alone, which
    `Sensitivity.sides` tells; or "undecided"; with the first cause of that, its time, and its contact, or the
    number of the scene that is on a kink."""

    kind: str
    reason: str = ""
    t: float = 0.0  # s
    contact: str = ""

    def __bool__(self) -> bool:
        return self.kind == VERDICTS[0]


@dataclass(frozen=True)
class EventSensitivity:
    """An event and the derivatives of its time, s per unit of each direction."""

    t: float
    contact: str
    by: Array  # (n_by,)


@dataclass(frozen=True)
class Sensitivity:
    """Values and derivatives at the times `t` (nt,)."""

    t: Array
    of: tuple[str, ...]  # names of the components
    by: tuple[str, ...]
    value: Array  # (nt, n_of)
    jacobian: Array  # (nt, n_of, n_by); NaN after a run has ended early
    sides: Array
    """(nt, n_of, n_by) of text: whether each derivative holds for changes to "both" sides, to "larger" or to
    "smaller" values alone, to "neither", as on two kinks of which each change leaves one (the derivative
    is then that of a branch that none keeps); "unknown" where the verdict is undecided for another reason."""
    verdicts: tuple[Verdict, ...]  # up to each time
    events: tuple[EventSensitivity, ...]
    outcome: Outcome | None  # how the run ended early
    error: Array | None = None
    """(nt, n_of, n_by), the estimated error of `jacobian`, from a companion run; infinite where that did not
    come, None where none was asked for."""

    @property
    def verdict(self) -> Verdict:
        """The verdict at the last time."""
        return self.verdicts[-1]


def sensitivity(
    library: Library,
    t: Sequence[float] | float,
    *,
    of: Sequence[str] | None = None,
    by: Sequence[str],
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    accuracy: Accuracy | str | None = None,
    estimate: bool = True,
    **stepping: Unpack[Stepping],
) -> Sensitivity:
    """Run a scene and differentiate what it shows, through contacts that begin, end, stick and slip.

    The equations of motion are differentiated along the accepted steps of the run; at events, the time of the
    event and the change of velocities are differentiated with them (saltation). A verdict says up to where
    the derivatives hold.

    Args:
        library: what `build(emit(derivation, derivatives=True))` returned.
        t: ascending times, s.
        of: sensors, or quantities of bodies: "ball.position" and ".velocity" of the centre of mass, world
            axes, ".angular_velocity", body axes, ".orientation", a unit quaternion (w, x, y, z). All sensors
            when None.
        by: parameters and inputs of the scene by name, and starts: "ball.position" and ".velocity" of the
            centre of mass, world axes, ".orientation" and ".angular_velocity", body axes. A start on closed
            contacts or joints changes as far as these permit.
        inputs: values of inputs, by name; the scene's defaults for the others.
        parameters: values of parameters of the scene by name.
        accuracy, stepping: as those of `start`.
        estimate: whether a finer companion run, which costs more than the run itself, shows the error of the
            derivatives.

    Raises:
        ModelgenError: the library has no derivatives, a name is unknown, or the start is refused.
    """
    expect("sensitivity", library, Library)
    check_keywords("sensitivity", stepping, KEYWORDS)
    check_flag("estimate", estimate)
    library = with_parameters(library, parameters)
    times = times_of(t)
    record = accuracy_of(library.manifest.instance, accuracy, stepping)
    session = Session(library, record)
    Inputs(session).update(values_by_name("inputs", inputs))
    directions = directions_of(library.manifest.instance, by)
    outputs = Outputs(session, of)
    known = direction_rows(library, directions, inputs or {})
    run = TangentRun(session, known.arrays, len(directions), known.kinks)
    rows = [run.go_on(float(time)).shown(outputs) for time in times]
    jacobian = np.array([row.jacobian for row in rows])
    error = None
    if estimate:
        epsilon = float(np.finfo(session.tables.dtype).eps)
        twin = Session(library, record.companion(epsilon))
        Inputs(twin).update(values_by_name("inputs", inputs))
        nudge(twin.x, twin.instance)
        error = _error(jacobian, TangentRun(twin, known.arrays, len(directions)), outputs, times, epsilon)
    return Sensitivity(
        t=times,
        of=outputs.names,
        by=tuple(direction.name for direction in directions),
        value=np.array([row.value for row in rows]),
        jacobian=jacobian,
        sides=np.array([row.sides for row in rows]),
        error=error,
        verdicts=tuple(row.verdict for row in rows),
        events=run.events(),
        outcome=run.outcome,
    )


def _error(jacobian: Array, twin: TangentRun, outputs: Outputs, times: Array, epsilon: float) -> Array:
    """The error of derivatives from those of a companion run."""
    other = np.array([twin.go_on(float(time)).shown(outputs).jacobian for time in times])
    apart = SAFE * np.abs(jacobian - other) + ROUNDED * epsilon * np.abs(jacobian)
    return np.where(np.isfinite(apart), apart, np.inf)


def times_of(t: Sequence[float] | float) -> Array:
    """(nt,) ascending times; raises SimulationError for others."""
    allowed = "finite, ascending times from 0 s on"
    times = np.atleast_1d(numbers_in("t", t, allowed))
    ascending = times.ndim == 1 and times.size and times[0] >= 0 and np.all(np.diff(times) >= 0)
    if not ascending or not np.isfinite(times[-1]):
        raise SimulationError("t", shown(t), allowed)
    return times


@dataclass(frozen=True)
class Component:
    """A number that a run shows: its name, and its place in the row of sensors or in the state, else -1."""

    name: str
    sensor: int
    state: int


def outputs_of(instance: Mapping[str, Any]) -> dict[str, tuple[Component, ...]]:
    """What can be differentiated, by name: sensors, and quantities of bodies, with their components."""
    found: dict[str, tuple[Component, ...]] = {}
    at = 0
    for name, size in instance["sensors"]["names"]:
        names = component_names([(name, size)])
        found[name] = tuple(Component(each, at + k, -1) for k, each in enumerate(names))
        at += size
    for body in instance["bodies"]:
        for quantity, place, size in _states_of(body, instance["n_q"]):
            name = f"{body['name']}.{quantity}"
            names = component_names([(name, size)])
            found[name] = tuple(Component(each, -1, place + k) for k, each in enumerate(names))
    return found


def _components(instance: Mapping[str, Any], of: Sequence[str] | None) -> list[Component]:
    """Those of the outputs with these names, of all sensors for None."""
    known = outputs_of(instance)
    sensors = [name for name, _ in instance["sensors"]["names"]]
    chosen = sensors if of is None else names_in("of", of)
    if not chosen:
        raise SimulationError("of", "nothing", f"known: {listed(known)}", "name what")
    for name in chosen:
        if name not in known:
            raise SimulationError("of", repr(name), f"known: {listed(known)}", nearest(name, known))
    return [component for name in chosen for component in known[name]]


def check_names(instance: Mapping[str, Any], by: Sequence[str], of: Sequence[str] | None) -> None:
    """Raise SimulationError for names that `sensitivity` refuses, before a scene is compiled.

    Args:
        instance: of the manifest of the scene's package.
        by, of: as those of `sensitivity`.
    """
    directions_of(instance, by)
    _components(instance, of)


class Outputs:
    """What is differentiated: components of sensors, and entries of the state."""

    def __init__(self, session: Session, of: Sequence[str] | None) -> None:
        components = _components(session.instance, of)
        self.sensors = [component.sensor for component in components]
        self.states = [component.state for component in components]
        self.names = tuple(component.name for component in components)

    def values(self, session: Session) -> Array:
        """(n_of,) at the state of a session."""
        session.sense()
        pairs = zip(self.sensors, self.states, strict=True)
        return np.array([session.sensed[i] if i >= 0 else session.x[j] for i, j in pairs], dtype=float)


def _states_of(body: Mapping[str, Any], n_q: int) -> list[tuple[str, int, int]]:
    """Quantities of a body in the state: name, place, size."""
    if body["motion"] not in ("point", "free"):
        return []
    q, u = body["q"], n_q + body["u"]
    found = [("position", q, 3), ("velocity", u, 3)]
    turning = [("orientation", q + 3, 4), ("angular_velocity", u + 3, 3)]
    return found + (turning if body["motion"] == "free" else [])


def _common_sides(one: Array, other: Array) -> Array:
    """The sides for which both hold."""
    return np.asarray((one & other & BOTH) | ((one | other) & UNKNOWN))


class Shown(NamedTuple):
    """What a run shows at one time."""

    value: Array  # (n_of,)
    jacobian: Array  # (n_of, n_by) derivatives of the branch on which the run is
    sides: Array  # (n_of, n_by) names of sides, as Sensitivity.sides
    verdict: Verdict


class TangentRun:
    """A run with the derivatives of its state."""

    def __init__(
        self, session: Session, arrays: Mapping[str, Array], n: int, kinks: Sequence[NumberOnKink | None] = ()
    ) -> None:
        """`arrays` and `kinks`: those of DirectionRows, n rows."""
        self.session, self._n, self._arrays, self._kinks = session, n, arrays, tuple(kinks)
        tables, dtype = session.tables, session.tables.dtype
        self._cdll = cdll = session.library.cdll
        if not hasattr(cdll, "mg_begin_tangent"):
            raise SimulationError(
                "sensitivity",
                "the library was generated without derivatives",
                "",
                "write emit(derivation, derivatives=True), or `modelgen build --derivatives`",
            )
        self._given_state = session.x.copy()
        self._directions = tables.Directions(
            self._n, *(address(self._arrays[name]) for name in DIRECTION_ARRAYS), address(self._given_state)
        )
        cdll.mg_sensitivity_size.restype = cdll.mg_sensitivity_int_size.restype = ctypes.c_long
        size = cdll.mg_sensitivity_size(ctypes.byref(session.system), self._n)
        int_size = cdll.mg_sensitivity_int_size(ctypes.byref(session.system))
        self._dx = np.zeros((self._n, session.n_x), dtype=dtype)
        self._sides = np.zeros(max(self._n, 1), dtype=INTEGER)
        self._event_t = np.zeros(EVENTS, dtype=dtype)
        self._event_contact = np.zeros(EVENTS, dtype=INTEGER)
        self._event_rates = np.zeros((EVENTS, self._n), dtype=dtype)
        self._memory = np.zeros(size, dtype=dtype), np.zeros(int_size + 1, dtype=INTEGER)
        of_events = (address(each) for each in (self._event_t, self._event_contact, self._event_rates))
        self._tangent = tables.Tangent(
            address(self._dx),
            EVENTS,
            0,
            *of_events,
            0,
            0,
            0.0,
            -1,
            *(address(each) for each in self._memory),
            None,
            0,
            address(self._sides),
        )
        self._record = tables.Record()
        self._code = 0
        self._happened: list[Event] = []
        begin(session)
        head, tail = session.advance_arguments(STEPS, self._record)
        self._given = ctypes.byref(self._directions), ctypes.byref(self._tangent)
        self._head, self._tail, self._scratch = head, tail, tail[-2:]
        interruptible(lambda: cdll.mg_begin_tangent(*head, *self._given, *self._scratch), session.stop)
        raise_failure(session.settings)

    @property
    def outcome(self) -> Outcome | None:
        return OUTCOME_OF_CODE[self._code] if self._code else None

    def go_on(self, until: float) -> TangentRun:
        """Advance run and derivatives; a run that has ended stays where it is."""
        session, advance = self.session, self._cdll.mg_advance_tangent
        code, end = self._code or CONTINUE, session.tables.real(until)
        while code in (CONTINUE, FULL):
            code = interruptible(lambda: advance(*self._head, *self._given, end, *self._tail), session.stop)
            raise_failure(session.settings)
            self._happened += session.drain_events()
            self.on_full()
        self._code = code
        return self

    def state_derivatives(self) -> Array:
        """(n_by, n_x) derivatives of the present state: the core's own array."""
        return self._dx

    def on_full(self) -> None:
        """Make room where the core has none left."""

    def shown(self, outputs: Outputs) -> Shown:
        """What the run shows now."""
        session, n_sensor = self.session, self.session.shared.n_sensor
        sensed = np.zeros((self._n, max(n_sensor, 1)), dtype=session.tables.dtype)
        sides_sensed = np.full((self._n, max(n_sensor, 1)), BOTH, dtype=INTEGER)
        reasons = np.zeros(max(n_sensor, 1), dtype=INTEGER)
        if n_sensor and self._n:
            to = (ctypes.c_void_p(address(each)) for each in (sensed, reasons, sides_sensed))
            self._cdll.mg_sense_tangent(*self._head, *self._given, *to, *self._scratch)
        pairs = list(zip(outputs.sensors, outputs.states, strict=True))
        value = outputs.values(session)
        jacobian = np.array([sensed[:, i] if i >= 0 else self._dx[:, j] for i, j in pairs], dtype=float)
        of_sensors = np.array(
            [sides_sensed[:, i] if i >= 0 else BOTH + 0 * self._sides for i in outputs.sensors]
        )
        sides = _common_sides(self._common_sides(), of_sensors)
        if self._code:
            value[:], jacobian[:] = np.nan, np.nan
        shown = [int(reasons[i]) for i in outputs.sensors if i >= 0]
        verdict = self._judged(sides, next(filter(None, shown), 0), bool(np.all(np.isfinite(jacobian))))
        names = [[NAME_OF_SIDES.get(int(each), SIDES[4]) for each in row] for row in sides]
        return Shown(value, jacobian, np.array(names).reshape(sides.shape), verdict)

    def verdict(self) -> Verdict:
        """Of the derivatives of the state up to now."""
        return self._judged(self._common_sides()[None, :], 0, True)

    def _common_sides(self) -> Array:
        """(n,) sides of all outputs together: of the run, and of an event at this very time."""
        kinks = self._kinks or (None,) * self._n
        of_numbers = np.array([UNKNOWN if k and k.is_lost else LARGER if k else BOTH for k in kinks])
        sides = _common_sides(self._sides[: self._n], of_numbers.astype(INTEGER))
        event = self._event_now()
        sooner = np.select([event.by < 0, event.by > 0], [LARGER, SMALLER], BOTH) if event else BOTH
        return _common_sides(sides, np.asarray(sooner, dtype=INTEGER))

    def _judged(self, sides: Array, of_sensors: int, is_finite: bool) -> Verdict:
        """The verdict on derivatives with sides (n_of, n_by); `of_sensors`: number of a sensor's reason."""
        now, tangent = float(self.session.run.t), self._tangent
        is_undecided = bool(np.any((sides == 0) | (sides >= UNKNOWN)))
        if np.all(sides == BOTH):
            return Verdict(VERDICTS[0]) if is_finite else Verdict(VERDICTS[2], NOT_FINITE, now)
        kind = VERDICTS[2] if is_undecided or not is_finite else VERDICTS[1]
        number = next(filter(None, self._kinks), None)
        if number:
            return Verdict(kind, OF_NUMBERS, 0.0, number.place)
        if tangent.verdict and (tangent.verdict == VERDICTS.index(kind) or not of_sensors):
            contact = self._contact(tangent.reason_contact)
            return Verdict(kind, REASONS[tangent.reason], float(tangent.reason_t), contact)
        if of_sensors:
            return Verdict(kind, REASONS[of_sensors], now)
        event = self._event_now()
        return Verdict(kind, AT_EVENT, event.t, event.contact) if event else Verdict(kind, NOT_FINITE, now)

    def _event_now(self) -> EventSensitivity | None:
        """An event at this very time that comes sooner in some changed runs, later in others."""
        session = self.session
        near = float(session.settings.event_tolerance) * session.instance["scales"]["time"]
        for event in reversed(self.events()):
            if abs(event.t - float(session.run.t)) <= near and np.any(event.by):
                return event
        return None

    def _contact(self, index: int) -> str:
        return self.session.contact_name(index) if index >= 0 else ""

    def events(self) -> tuple[EventSensitivity, ...]:
        n = min(self._tangent.count, EVENTS)
        return tuple(
            EventSensitivity(float(t), self._contact(int(contact)), rates.astype(float))
            for t, contact, rates in zip(
                self._event_t[:n], self._event_contact[:n], self._event_rates[:n], strict=True
            )
        )
