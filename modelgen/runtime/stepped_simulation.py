"""A run that its caller drives: steps, inputs that change between them, the state in between."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Iterator, Mapping
from math import inf
from typing import Unpack

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, expect
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import (
    check_flag,
    check_keywords,
    is_number,
    shown,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.checkpoint import opened, sealed
from modelgen.runtime.contacts import Contact, contacts_of
from modelgen.runtime.controllers import ControlFunction, Controller
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.sensors import Sensors
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.simulate import repeated
from modelgen.runtime.solver_choice import raise_failure
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Event, Outcome, Trajectory

_HEAD = struct.Struct("<qdq")  # of a saved run: calls of the controller, time of its first, the core's code
STEPS = 1_000_000  # in one call of the core
START_KEYWORDS = ("inputs", "parameters", "accuracy", "estimate", *STEPPING)  # of `start`


def start(
    library: Library,
    *,
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    accuracy: Accuracy | str | None = None,
    estimate: bool = False,
    **stepping: Unpack[Stepping],
) -> Simulation:
    """Start a run that the caller drives.

    Args:
        library: what `build` returned.
        inputs: values of inputs at t = 0, by name; the scene's defaults for the others.
        parameters: values of parameters of the scene by name; others keep the scene's own.
        accuracy: every tolerance and choice, or "coarse", "fast", "balanced", "tight"; the scene's own when
            None.
        estimate: note the inputs of the run, so that its error can be estimated (`Simulation.estimate`) and
            its trust told (`Simulation.trajectory`).
        stepping: method, step, scheme, solver, fallback, in place of the accuracy's or scene's (`Accuracy`).

    Raises:
        ModelgenError: what is given is no library, or the start, an input, a parameter or a setting is
            refused.
    """
    expect("start", library, Library)
    check_keywords("start", stepping, START_KEYWORDS)
    check_flag("estimate", estimate)
    library = with_parameters(library, parameters)
    session = Session(library, accuracy_of(library.manifest.instance, accuracy, stepping))
    simulation = Simulation(session, estimate)
    simulation.inputs.update(values_by_name("inputs", inputs))
    simulation.begin()
    return simulation


class Simulation:
    """A run between two steps. `start` makes one; arrays are views that change as the run goes on.

    `session` is the run in the core's memory, with its statistics in `session.run` (modelgen.h).
    """

    def __init__(self, session: Session, estimate: bool = False) -> None:
        self.session = session
        # the inputs that the run had: times, s, and the settings up to each
        self._driven: list[tuple[float, Array]] | None = [] if estimate else None
        self._record = session.tables.Record()
        self._code: int | None = None  # of the core, once the run has ended
        self.sensors = Sensors(session)
        self.inputs = Inputs(session, self.sensors.forget)
        self._early: tuple[Event, ...] = ()
        self._controller: Controller | None = None
        self._advance = session.library.cdll.mg_advance
        self._real = session.tables.real
        self._head, self._tail = session.advance_arguments(STEPS, self._record)

    def begin(self) -> None:
        """Settle the start on its constraints with the inputs as they are; raises SimulationError."""
        begin(self.session)
        self.inputs.begun = True
        self._note()
        self.sensors.forget()
        if self.session.start_code:
            self._code = self.session.start_code
        self._early = tuple(self.session.drain_events())

    @property
    def t(self) -> float:
        """Time, s."""
        return float(self.session.run.t)

    @property
    def outcome(self) -> Outcome | None:
        """How the run ended early, with the advice as value; None as long as it can be advanced."""
        return None if self._code is None else OUTCOME_OF_CODE[self._code]

    @property
    def state(self) -> Array:
        """(n,) q and u of all bodies, eta of all contacts, work: the core's own array, not to be written."""
        return self.session.x

    def step(self, until: float) -> tuple[Event, ...]:
        """Go on to the time `until`, s; the events on the way, each located. Inputs that were set since the
        last step take effect first.

        A run that cannot go on stops with what it has: see `outcome`.

        Raises:
            SimulationError: `until` is no time after the present, or the run has ended.
        """
        session = self.session
        if not (is_number(until) and session.run.t <= until < inf):
            raise self._wrong_time(until)
        if self._code is not None:
            raise self._ended()
        events, self._early = self._early, ()
        code = CONTINUE
        self.sensors.forget()
        for stop in (until,) if self._driven is None else self._stops(until):
            code = CONTINUE
            while code in (CONTINUE, FULL):
                code = self._advance(*self._head, self._real(stop), *self._tail)
                if session.events.count:
                    events += tuple(session.drain_events())
            raise_failure(session.settings)
            self._note()
            if code:
                self._stop(code)
                break
        return events

    def estimate(self) -> Estimate:
        """The estimated error of the run so far, as of `simulate`, at the ends of its steps; see
        `trajectory`."""
        found = self.trajectory().estimate
        assert found is not None
        return found

    def trajectory(self) -> Trajectory:
        """The run so far as `simulate` gives it, with samples at the ends of its steps: its estimated error,
        and whether and why not it is trusted. It is made again with the inputs that it had, those that its
        controller set included, and with its companion.

        Raises SimulationError where the inputs were not noted: for `start(.., estimate=True)` they are, until
        a saved state is loaded.
        """
        if not self._driven:
            found, remedy = "the inputs of the run are not known", "write start(.., estimate=True)"
            raise SimulationError("estimate", found, "those since the start are needed", remedy)
        return repeated(self.session.library, self.session.accuracy, self._driven)

    def _note(self) -> None:
        """Note the settings of the inputs up to the present time."""
        if self._driven is not None:
            self._driven.append((float(self.session.run.t), self.session.input.copy()))

    def _stops(self, until: float) -> Iterator[float]:
        """The times, up to one, between which no controller is called."""
        while self._controller is not None:
            next_call = self._controller.call_after(self.session.run.t)
            if next_call >= until:
                break
            yield next_call
        yield until

    @property
    def contacts(self) -> Mapping[str, Contact]:
        """The contacts with shapes and the limits of joints, by name, at the present state."""
        return contacts_of(self.session)

    def save(self) -> bytes:
        """The state of the run, its inputs and the instants of its controller included. Loaded into a run of
        the same library, parameters and settings, also in another process, it goes on bit for bit."""
        calls, start = (0, 0.0) if self._controller is None else self._controller.instants
        return sealed(_HEAD.pack(calls, start, self._code or 0), self.session.save())

    def load(self, mark: bytes) -> None:
        """Go to a saved state. The controller stays the one that is set. Raises SimulationError where `mark`
        is not what `save` returned for the same library, parameters and settings; it says what differs."""
        head, state = opened(mark, _HEAD.size)
        self.session.load(state)
        self.sensors.forget()
        self._driven = None
        calls, start, code = _HEAD.unpack(head)
        self._code, self._early = code or None, ()
        if self._controller is not None:
            self._controller.instants = calls, start

    def controller(self, function: ControlFunction, every: float) -> None:
        """Let a function set inputs at sampled instants: now and after each further time `every`, s.

        Args:
            function: expressions of t and components of sensors by input, {"push": "-3*place_x"}; or
                Python's (t, sensors) -> a dict of inputs and values, a number if there is one input, or
                None; or a CasADi function whose inputs are `t` and sensors and whose outputs are inputs of
                the scene, by name; or the address of a C function of type mg_control (modelgen.h).
                Expressions and CasADi functions are compiled. The command of an input with
                hold = "linear" is its rate, per s. A value beyond the range of its input is set to the
                nearest end.
            every: time between two instants, s. The function is never called in between, so that steps,
                events and their errors are those of a run with piecewise given inputs.

        Raises:
            SimulationError: names or sizes of the function are none of the scene.
        """
        self._controller = controller = Controller(self.session, function, every)
        self._advance = self.session.library.cdll.mg_advance_controlled
        self._head, self._tail = self.session.advance_arguments(STEPS, self._record)
        self._head = (*self._head, ctypes.byref(controller.structure))

    def _stop(self, code: int) -> None:
        """Note the end of the run; raises what a controller raised, after which the run can go on."""
        controller = self._controller
        if controller is not None and controller.failure is not None:
            failure, controller.failure = controller.failure, None
            raise failure
        if controller is not None and controller.wrong_command():
            name = controller.wrong_command()
            raise SimulationError(
                "controller",
                f"a command for {name!r} that is not finite, at t = {self.t:.6g} s",
                "a finite number",
            )
        self._code = code

    def _wrong_time(self, until: object) -> SimulationError:
        allowed = f"a time from the present one, {self.t!r} s, on, not infinite"
        return SimulationError("step", f"until = {shown(until)}", allowed, "write until=sim.t + 0.01")

    def _ended(self) -> SimulationError:
        outcome = OUTCOME_OF_CODE[self._code or 0]
        found = f"the run ended at t = {self.t:.6g} s: {outcome.name.lower()}"
        return SimulationError("step", found, "", outcome.value)
