"""The state of a run as bytes (mg_save, mg_load), and what is said where bytes do not fit."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.tables.ctypes_structures import address

SAME = "a state of the same scene, built and set alike"
DIFFERENCES: Mapping[int, tuple[str, str]] = {  # by the code of mg_load: what was found, and the remedy
    1: ("the bytes are no saved state of a run", "give the bytes that `save` returned"),
    2: ("it was saved by another version of the core", "run with the version that saved it"),
    3: ("it was saved with another real type", "build the library with the same `real`"),
    4: ("it was saved by another library", "build from the same scene, compiler and level"),
    5: ("it is of a scene with other numbers of bodies, contacts or joints", "load it into its own scene"),
    6: (
        "it is of a scene with other tables: parameters, masses, friction or what touches what",
        "load it into its own scene",
    ),
    7: ("it was saved with other settings", "give the accuracy with which it was saved"),
    8: ("bytes are missing or changed", "save it again"),
}


def save(cdll: ctypes.CDLL, head: tuple[Any, ...], size: int) -> bytes:
    """The `size` bytes of an mg_run; `head` points to its mg_system, its mg_settings and itself."""
    out = np.empty(size, dtype=np.uint8)
    cdll.mg_save(*head, ctypes.c_void_p(address(out)))
    return out.tobytes()


def load(cdll: ctypes.CDLL, head: tuple[Any, ...], state: bytes) -> None:
    """Load bytes into an mg_run. Raises SimulationError, with the run as it was, where they do not fit."""
    if not isinstance(state, bytes | bytearray | memoryview):
        raise SimulationError("load", f"a {type(state).__name__}", "bytes", "give what `save` returned")
    given = bytes(state)
    code = int(cdll.mg_load(*head, given, ctypes.c_long(len(given))))
    if code:
        found, remedy = DIFFERENCES[code]
        raise SimulationError("load", found, SAME, remedy)
