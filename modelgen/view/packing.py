"""Arrays as text of a page: base64 of little-endian numbers."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
SHORT = 65536  # vertices that two bytes can number
UNIT = 127  # of a signed byte


def packed(values: Array) -> str:
    """Numbers as 32-bit floats."""
    return _text(values, "<f4")


def packed_doubles(values: Array) -> str:
    """Numbers as 64-bit floats."""
    return _text(values, "<f8")


def packed_bytes(directions: Array) -> str:
    """Components from -1 to 1 as signed bytes."""
    return _text(np.rint(UNIT * directions), "i1")


def packed_indices(indices: Array, count: int) -> dict[str, Any]:
    """Numbers of `count` vertices, in two bytes each if that is enough, with the number of bytes."""
    size = 2 if count <= SHORT else 4
    return {"bytes": size, "values": _text(indices, f"<u{size}")}


def _text(values: Array, kind: str) -> str:
    return b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
