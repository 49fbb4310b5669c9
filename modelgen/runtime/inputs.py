"""The inputs of a run, which its caller sets."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping
from math import inf, nan
from typing import Any

from modelgen.errors import SimulationError
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.arguments import input_range, is_number, shown
from modelgen.runtime.by_name import ByName
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import Array

Kind = Mapping[str, Any]  # an input of a manifest's instance
NO_INPUTS = "declare it in the scene, as an [[input]] with this name"


def is_outside(kind: Kind, value: Any) -> Any:
    """Whether a value is beyond the range of its input or not finite."""
    return is_beyond(value, *input_range(kind))


def is_beyond(value: Any, least: Any, largest: Any) -> Any:
    """Whether a value, or each of an array, is outside a range or not finite."""
    return (value != value) | (abs(value) == inf) | (value < least) | (value > largest)


def is_jump(kind: Kind, value: Any, present: Any) -> Any:
    """Whether a value, or each of an array, is a jump from the present one, which an input with
    hold = "linear" cannot make during a run."""
    return (kind["hold"] == "linear") & (value != present)


def refused_value(kind: Kind, where: str, value: object, outside: bool) -> SimulationError:
    """The error of a value that is outside, or a jump; `where` is the input, and of which run."""
    if not outside:
        return SimulationError(
            where, "a jump to another value", "an input with hold = 'linear' is continuous",
            f"write inputs.ramp({kind['name']!r}, rate), or give the value where the run starts",
        )  # fmt: skip
    least, largest = input_range(kind)
    within = f"from {least:g} to {largest:g}" if largest - least < inf else "that is finite"
    by_function = "sim = start(library); sim.controller(f, every=0.01) takes a function f(t, sensors)"
    remedy = by_function if callable(value) else "change the value"
    return SimulationError(where, shown(value), f"a number {within}", remedy)


def refused_rate(where: str, rate: object) -> SimulationError:
    """The error of a rate that is no finite number."""
    return SimulationError(where, shown(rate), "a finite rate, per s", "")


def cannot_be_removed(name: str) -> SimulationError:
    return SimulationError(f"input {name!r}", "it cannot be removed", "", "set it to its default")


class Inputs(MutableMapping[str, float]):
    """The inputs of a run by name. A value that is set takes effect at the present time of the run.

    An input with hold = "linear" goes on from its present value at a rate: `ramp` sets the rate, and the
    value, which is continuous, cannot be set during a run.
    """

    def __init__(self, session: Session, changed: Callable[[], None] = lambda: None) -> None:
        """`changed` is called after each change."""
        self._session, self._changed = session, changed
        self.begun = False  # whether the run has started
        self._kinds = session.instance["inputs"]
        self._index = ByName({kind["name"]: k for k, kind in enumerate(self._kinds)}, "input", NO_INPUTS)

    def __getitem__(self, name: str) -> float:
        value, rate, since = self._setting(name)
        return float(value + rate * (self._session.run.t - since))

    def __setitem__(self, name: str, value: float) -> None:
        kind, present = self._kind(name), self[name]
        number = float(value) if is_number(value) else nan
        outside = is_outside(kind, number)
        if outside or (self.begun and is_jump(kind, number, present)):
            raise refused_value(kind, f"input {name!r}", value, outside)
        if kind["hold"] == "linear" and self.begun:
            return  # its present value, from which it goes on at its rate
        self._set(name, number, 0.0)

    def ramp(self, name: str, rate: float) -> None:
        """Let an input with hold = "linear" change at a rate, per s, from the present time and value on."""
        kind = self._kind(name)
        if kind["hold"] != "linear":
            raise SimulationError(
                f"input {name!r}", f"a rate, but its hold is {kind['hold']!r}", "", "set its value instead"
            )
        if not is_number(rate) or not abs(rate) < inf:
            raise refused_rate(f"input {name!r}", rate)
        self._set(name, self[name], rate)

    def __delitem__(self, name: str) -> None:
        raise cannot_be_removed(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def __repr__(self) -> str:
        return repr(dict(self))

    def _kind(self, name: str) -> Kind:
        kind: Kind = self._kinds[self._index[name]]
        return kind

    def _setting(self, name: str) -> Array:
        self._kind(name)
        at = SETTING_SIZE * self._index[name]
        return self._session.input[at : at + SETTING_SIZE]

    def _set(self, name: str, value: float, rate: float) -> None:
        self._setting(name)[:] = value, rate, self._session.run.t
        self._changed()
