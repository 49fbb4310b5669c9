"""Arrays as arguments of the C core, and read-only results."""

from __future__ import annotations

import ctypes
from typing import Any

from numpy.typing import NDArray

C_REALS: dict[str, Any] = {
    "f": ctypes.c_float,
    "d": ctypes.c_double,
    "g": ctypes.c_longdouble,
}  # by dtype.char


def pointer(array: NDArray[Any]) -> ctypes.c_void_p:
    """A pointer to the data of a contiguous array."""
    return ctypes.c_void_p(array.ctypes.data)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """The same array, made read-only."""
    array.setflags(write=False)
    return array
