"""Real numbers of the tables of the core, one after another, to which the integers of the tables point."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Hashable, Mapping, Sequence
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
INTEGER = np.dtype(np.intc)  # C's int
WHOLE_SCENE = "mg_rhs"  # the composed right-hand side


def may_share(instance: Mapping[str, Any], functions: Collection[str]) -> bool:
    """Whether pairs may share numbers. A change of a parameter of the scene makes equal ones different, and
    the function of a whole scene takes all parameters in the order of the model.

    `functions`: the names of those of the library.
    """
    return not instance.get("parameters") and WHOLE_SCENE not in functions


class NumberPool:
    """Equal numbers that many pairs have are there once, unless each must have a place of its own."""

    def __init__(self, shares: bool) -> None:
        self.values: list[float] = []
        self.shares = shares
        self._known: dict[Hashable, int] = {}

    def append(self, numbers: Sequence[float]) -> int:
        """Adds the numbers at the end; returns where they start."""
        start = len(self.values)
        self.values.extend(numbers)
        return start

    def place(self, numbers: Sequence[float], *use: Hashable) -> int:
        """Where the numbers start, which are added unless they are there for the same use."""
        if not self.shares:
            return self.append(numbers)
        key = (*use, array("d", numbers).tobytes())  # 0.0 and -0.0 are two numbers
        if key not in self._known:
            self._known[key] = self.append(numbers)
        return self._known[key]
