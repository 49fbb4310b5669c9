"""The inputs of a run, which its caller sets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, MutableMapping
from math import inf, isfinite, nan

from modelgen.errors import SimulationError
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.arguments import check_name, input_range, is_number
from modelgen.runtime.session import Session
from modelgen.runtime.tables.ctypes_structures import Array


class Inputs(MutableMapping[str, float]):
    """The inputs of a run by name. A value that is set takes effect at the present time of the run.

    An input with hold = "linear" goes on from its present value at a rate: `ramp` sets the rate, and the
    value, which is continuous, cannot be set during a run.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._kinds = session.instance["inputs"]
        self._index = {kind["name"]: k for k, kind in enumerate(self._kinds)}

    def __getitem__(self, name: str) -> float:
        value, rate, since = self._setting(name)
        return float(value + rate * (self._session.run.t - since))

    def __setitem__(self, name: str, value: float) -> None:
        setting, kind = self._setting(name), self._kind(name)
        self._check(name, value)
        t = self._session.run.t
        if kind["hold"] == "linear" and t > 0:
            raise SimulationError(
                f"input {name!r}", "a jump to another value", "an input with hold = 'linear' is continuous",
                f"write sim.inputs.ramp({name!r}, rate), or set it before the run starts",
            )  # fmt: skip
        setting[:] = value, 0.0, t

    def ramp(self, name: str, rate: float) -> None:
        """Let an input with hold = "linear" change at a rate, per s, from the present time and value on."""
        kind = self._kind(name)
        if kind["hold"] != "linear":
            raise SimulationError(
                f"input {name!r}", f"a rate, but its hold is {kind['hold']!r}", "", "set its value instead"
            )
        if not is_number(rate) or not abs(rate) < float("inf"):
            raise SimulationError(f"input {name!r}", repr(rate), "a finite rate, per s", "")
        value = self[name]
        self._setting(name)[:] = value, rate, self._session.run.t

    def __delitem__(self, name: str) -> None:
        raise SimulationError(f"input {name!r}", "it cannot be removed", "", "set it to its default")

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def __repr__(self) -> str:
        return repr(dict(self))

    def _kind(self, name: str) -> Mapping[str, object]:
        if name not in self._index:
            check_name("input", name, self._index)
        kind: Mapping[str, object] = self._kinds[self._index[name]]
        return kind

    def _setting(self, name: str) -> Array:
        self._kind(name)
        at = SETTING_SIZE * self._index[name]
        return self._session.input[at : at + SETTING_SIZE]

    def _check(self, name: str, value: object) -> None:
        kind = self._kinds[self._index[name]]
        least, largest = input_range(kind)
        number = float(value) if is_number(value) else nan  # type: ignore[arg-type]
        if not isfinite(number) or not least <= number <= largest:
            within = f"from {least:g} to {largest:g}" if largest - least < inf else "that is finite"
            raise SimulationError(f"input {name!r}", repr(value), f"a number {within}", "change the value")
