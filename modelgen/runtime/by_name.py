"""Results by name: a dict that says which names it has, where it is asked for another one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeVar

from modelgen.runtime.arguments import check_name

Value = TypeVar("Value")


class ByName(dict[str, Value]):
    """A dict whose lookup raises UnknownNameError, a KeyError with all names and the nearest one.

    >>> ByName({"ring-ball": 1.0}, "contact")["ball-ring"]
    Traceback (most recent call last):
    modelgen.errors.UnknownNameError: contact: 'ball-ring'; ring-ball; did you mean 'ring-ball'?
    """

    def __init__(
        self,
        values: Mapping[str, Value] | Iterable[tuple[str, Value]],
        what: str = "name",
        none: str = "",
    ) -> None:
        """`what` the names are of, as the error says it, and its remedy where there are none."""
        super().__init__(values)
        self._what, self._none = what, none

    def __getitem__(self, name: str) -> Value:
        if not isinstance(name, str) or name not in self:
            check_name(self._what, name, self, self._none)
        return super().__getitem__(name)
