"""Controllers of a run: a Python function, a CasADi function or a C function, called at sampled instants."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.name_suggestions import nearest
from modelgen.runtime.arguments import check_span, is_number
from modelgen.runtime.core_session import Session
from modelgen.runtime.sensors import Readings
from modelgen.runtime.tables.ctypes_structures import address

Commands = Mapping[str, float] | float | None
C_FUNCTION: Any = ctypes.CFUNCTYPE(None).__mro__[1]  # the base of all pointers to C functions
PythonController = Callable[[float, Readings], Commands]
Expressions = Mapping[str, str]  # by input: expressions of t and components of sensors
ControlFunction = PythonController | int | Expressions | Any  # or a function of CasADi


class Controller:
    """A controller of a session and the memory that the core shares with it.

    An exception in a Python function is kept in `failure`, and the run stops before that instant has an
    effect.
    """

    def __init__(self, session: Session, function: ControlFunction, every: float) -> None:
        check_span("controller: every", every, "give the time between two calls, s")
        names = session.instance["sensors"]["names"]
        dtype = session.tables.dtype
        self.failure: BaseException | None = None
        self._inputs = [each["name"] for each in session.instance["inputs"]]
        self._sensors = np.zeros(session.shared.n_sensor + 1, dtype=dtype)
        self._command = np.zeros(len(self._inputs) + 1, dtype=dtype)
        self._readings = Readings(names, self._sensors)
        self._kept, entry = self._entry(session, function)
        self.structure = session.tables.Controller(
            entry, None, every, float(session.run.t), 0, address(self._sensors), address(self._command)
        )

    @property
    def instants(self) -> tuple[int, float]:
        """How often it has been called, and the time of its first call, s."""
        return int(self.structure.calls), float(self.structure.start)

    @instants.setter
    def instants(self, value: tuple[int, float]) -> None:
        self.structure.calls, self.structure.start = value

    def call_after(self, t: float) -> float:
        """The time of the first call after the one that is due at t, s, or after t."""
        each, real = self.structure, self._sensors.dtype.type  # as the core computes it
        due, after = (real(each.start) + real(each.period) * real(each.calls + k) for k in (0, 1))
        return float(due if t < due else after)

    def wrong_command(self) -> str:
        """The name of an input whose command is not finite; empty if there is none."""
        bad = np.flatnonzero(~np.isfinite(self._command[:-1]))
        return self._inputs[int(bad[0])] if len(bad) else ""

    def _entry(self, session: Session, function: ControlFunction) -> tuple[Any, int]:
        """What must be kept alive, and the address of a function of type mg_control."""
        if isinstance(function, Mapping) or _is_casadi_function(function):
            from modelgen.codegen.casadi_controllers import (  # needs CasADi and a compiler
                ENTRY,
                compiled_controller,
            )

            sensors = session.instance["sensors"]["names"]
            given: Any = function
            path = compiled_controller(given, sensors, self._inputs, session.library.real)
            library = ctypes.CDLL(str(path))
            return library, _address(getattr(library, ENTRY))
        if isinstance(function, int) and not isinstance(function, bool):
            return None, function
        if isinstance(function, C_FUNCTION):
            return function, _address(function)
        if callable(function):
            callback = session.tables.Control(self._called(function))
            return callback, _address(callback)
        allowed = "expressions by input, a Python or CasADi function, or the address of a C function"
        raise SimulationError("controller", repr(function), allowed, "give one of these")

    def _called(self, function: PythonController) -> Callable[..., None]:
        command, readings, take = self._command, self._readings, self._take

        def call(_data: Any, t: float, _sensors: Any, _command: Any) -> None:
            try:
                take(function(t, readings))
            except BaseException as error:
                self.failure = error
                command[:] = np.nan

        return call

    def _take(self, commands: Commands) -> None:
        if commands is None:
            return
        if isinstance(commands, Mapping):
            for name, value in commands.items():
                if name not in self._inputs:
                    allowed = "inputs: " + ", ".join(self._inputs)
                    raise SimulationError(
                        "controller", f"a command for {name!r}", allowed, nearest(str(name), self._inputs)
                    )
                self._command[self._inputs.index(name)] = value
        elif is_number(commands) and len(self._inputs) == 1:
            self._command[0] = commands
        else:
            raise SimulationError(
                "controller", f"the commands {commands!r}", "a dict of inputs and values, or None", ""
            )


def _is_casadi_function(function: object) -> bool:
    """Whether it is one, without an import of CasADi."""
    return type(function).__module__.partition(".")[0] == "casadi"


def _address(function: Any) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)
