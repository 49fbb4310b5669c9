"""Arrays for the C core, and results that nobody changes."""

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
    """To a contiguous array's data."""
    return ctypes.c_void_p(array.ctypes.data)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """The array itself, read-only from now on."""
    array.setflags(write=False)
    return array
