"""The inputs of many runs, which their caller sets."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping, Sequence
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.arguments import check_name, input_range, lanes_in, one_or_each
from modelgen.runtime.by_name import ByName
from modelgen.runtime.inputs import cannot_be_removed, is_beyond, is_jump, refused_rate, refused_value
from modelgen.runtime.session_group import SessionGroup
from modelgen.runtime.tables.ctypes_structures import Array


class InputsByLane(MutableMapping[str, Array]):
    """The inputs of all lanes by name, (n,) each: arrays of the present values, that are written to, or
    set as a whole: to one number, or to one for each lane.

    A value that is written takes effect at the present time of its lane. An input with hold = "linear" goes
    on from its present value at a rate: `ramp` sets the rate, and the value, which is continuous, can be
    written to before a lane starts or is reset.

    Attributes:
        bounds: (n, number of inputs, 2) least and largest value in each lane, infinite where there is none.
        defaults: (n, number of inputs).
    """

    def __init__(self, group: SessionGroup, libraries: Sequence[Library]) -> None:
        """`libraries`: of each lane, whose ranges hold there."""
        self._group = group
        self._kinds = group.library.manifest.instance["inputs"]
        self._own = [each.manifest.instance["inputs"] for each in libraries]
        shape = (group.n, len(self._kinds))
        self.bounds = np.array([[input_range(kind) for kind in own] for own in self._own]).reshape(*shape, 2)
        self.defaults = np.array([[kind["default"] for kind in own] for own in self._own]).reshape(shape)
        self._index = ByName({kind["name"]: k for k, kind in enumerate(self._kinds)}, "input")
        self._shown = {each["name"]: np.empty(group.n) for each in self._kinds if each["hold"] == "linear"}
        self.refresh()

    def __getitem__(self, name: str) -> Array:
        value = self._settings(name)[0]
        return self._shown.get(name, value)

    def __setitem__(self, name: str, values: Any) -> None:
        """Raises SimulationError for an unknown name, and for what are no numbers of the lanes."""
        self[name][:] = one_or_each(f"input {name!r}", values, self._group.n)

    def __delitem__(self, name: str) -> None:
        raise cannot_be_removed(name)

    def ramp(self, name: str, rates: Any, lanes: Any = None) -> None:
        """Let an input with hold = "linear" change at rates, one number or (n,) per s, from now on; in lanes,
        (n,) of bool or indices, or in all.

        Raises SimulationError where it has another hold, or a rate is not finite.
        """
        check_name("ramp", name, self._shown)
        given = one_or_each(f"ramp: {name!r}", rates, self._group.n)
        lanes = slice(None) if lanes is None else lanes_in("ramp: lanes", lanes, self._group.n)
        if len(bad := np.flatnonzero(~np.isfinite(given))):
            raise refused_rate(f"input {name!r} of lane {bad[0]}", float(given[bad[0]]))
        self._check(name, lanes)
        value, rate, since = self._settings(name)
        value[lanes], rate[lanes] = self._shown[name][lanes], given[lanes]
        since[lanes] = self._group.t[lanes]

    def check(self) -> None:
        """Raises SimulationError where a value that was written is refused."""
        for name in self._index:
            self._check(name)

    def refresh(self) -> None:
        """Show the present values."""
        for name, shown in self._shown.items():
            shown[:] = self._present(name)

    def restart(self, lanes: Array) -> None:
        """Let lanes that go back to t = 0 start with the values that are shown, and their rates."""
        for name in self._index:
            self._check(name, lanes, True)
            value, _, since = self._settings(name)
            value[lanes], since[lanes] = self[name][lanes], 0.0

    def _check(self, name: str, lanes: Any = slice(None), may_jump: bool = False) -> None:
        """Of a line, which may lead out of the range, what was written is checked: the jumps."""
        at = self._index[name]
        kind, values, present = self._kinds[at], self[name], self._present(name)
        refused = outside = is_beyond(values, *self.bounds[:, at].T)
        if kind["hold"] == "linear" and not may_jump:
            refused = is_jump(kind, values, present)
        if len(bad := np.arange(self._group.n)[lanes][refused[lanes]]):
            lane = int(bad[0])
            where = f"input {name!r} of lane {lane}"
            raise refused_value(self._own[lane][at], where, float(values[lane]), bool(outside[lane]))

    def _present(self, name: str) -> Array:
        value, rate, since = self._settings(name)
        present: Array = value + rate * (self._group.t - since)
        return present

    def _settings(self, name: str) -> tuple[Array, Array, Array]:
        """Value, rate and time of the settings of an input, (n,) each."""
        at, settings = SETTING_SIZE * self._index[name], self._group.arrays["input"]
        return settings[:, at], settings[:, at + 1], settings[:, at + 2]

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)
