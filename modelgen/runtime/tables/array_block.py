"""Arrays of one type that lie one behind the other in memory: one allocation, one address to ask for."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np

from modelgen.runtime.tables.ctypes_structures import Array, address


def by_address(arrays: Mapping[str, Array], addresses: Mapping[str, int]) -> dict[int, Array]:
    """Arrays by their addresses; both are given by name."""
    return {addresses[name]: array for name, array in arrays.items()}


class ArrayBlock:
    """Where the arrays of a block lie, by name."""

    def __init__(self, shapes: Mapping[str, tuple[int, ...]]) -> None:
        self._parts: list[tuple[str, int, int, tuple[int, ...]]] = []
        self._size = 0
        for name, shape in shapes.items():
            end = self._size + prod(shape)
            self._parts.append((name, self._size, end, shape))
            self._size = end + 1  # so that the addresses of empty arrays differ, too

    @property
    def size(self) -> int:
        """Numbers of all arrays."""
        return self._size

    def zeros(self, dtype: np.dtype[Any]) -> tuple[dict[str, Array], dict[str, int]]:
        """New arrays of zeros, and their addresses; all keep the whole block."""
        block = np.zeros(self._size, dtype=dtype)
        first, width = address(block), dtype.itemsize
        arrays, addresses = {}, {}
        for name, start, end, shape in self._parts:
            part = block[start:end]
            arrays[name] = part if len(shape) == 1 else part.reshape(shape)
            addresses[name] = first + start * width
        return arrays, addresses
