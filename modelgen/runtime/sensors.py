"""What the sensors of a run show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from modelgen.runtime.by_name import ByName
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import Array


def parts_of(slots: Sequence[tuple[str, int]]) -> dict[str, slice | int]:
    """Where the components of each sensor stand in a row: an index, or a slice of several."""
    parts: dict[str, slice | int] = {}
    end = 0
    for name, size in slots:
        parts[name] = slice(end, end + size) if size > 1 else end
        end += size
    return parts


class Readings(Mapping[str, "float | Array"]):
    """What sensors show, by name: a float, or an array (3,) or (4,), in SI units."""

    def __init__(self, slots: Sequence[tuple[str, int]], values: Array) -> None:
        self.values_in_order = values
        self._parts = ByName(parts_of(slots), "sensor")

    def __getitem__(self, name: str) -> float | Array:
        part = self._parts[name]
        found = self.values_in_order[part]
        return found.copy() if isinstance(part, slice) else float(found)

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def __repr__(self) -> str:
        return repr(dict(self))


class Sensors(Readings):
    """The sensors of a run at its present state, which is sensed once.

    A gap is NaN while no closest points of its pair are followed; accelerations and forces of joints are NaN
    in time-stepping.
    """

    def __init__(self, session: Session) -> None:
        super().__init__(session.instance["sensors"]["names"], session.sensed)
        self._session = session
        self._is_known = False

    def forget(self) -> None:
        """Sense anew at the next access, as the state or an input has changed."""
        self._is_known = False

    def __getitem__(self, name: str) -> float | Array:
        if not self._is_known:
            self._session.sense()
            self._is_known = True
        return super().__getitem__(name)
