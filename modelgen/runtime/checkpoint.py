"""The state of a run as bytes (mg_save, mg_load), and what is said where bytes do not fit."""

from __future__ import annotations

import ctypes
import hashlib
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.tables.ctypes_structures import address

SAME = "a state of the same scene, built and set alike"
_LANES = struct.Struct("<16sq")  # of a saved group of runs: what it is, and their number
_OF_LANES = b"modelgen lanes 2"
_OF_RUN = b"\x1a\nmgcpkt"  # MG_MAGIC, with which what mg_save writes begins
_DIGEST = 32  # bytes
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
    given = bytes_of(state)
    code = int(cdll.mg_load(*head, given, ctypes.c_long(len(given))))
    if code:
        found, remedy = DIFFERENCES[code]
        raise SimulationError("load", found, SAME, remedy)


def sealed(head: bytes, states: bytes) -> bytes:
    """What the core does not know of a run or group, a digest of all, and what the core saved."""
    return head + hashlib.sha256(head + states).digest() + states


def opened(mark: object, size: int) -> tuple[bytes, bytes]:
    """The head of `size` bytes and the states that `sealed` joined. SimulationError for other bytes."""
    given = bytes_of(mark)
    head, digest, states = given[:size], given[size : size + _DIGEST], given[size + _DIGEST :]
    if digest != hashlib.sha256(head + states).digest():
        found, remedy = DIFFERENCES[8 if states.startswith(_OF_RUN) else 1]
        raise SimulationError("load", found, SAME, remedy)
    return head, states


def bytes_of(mark: object) -> bytes:
    """A saved state; raises SimulationError for what are no bytes."""
    if not isinstance(mark, bytes | bytearray | memoryview):
        raise SimulationError("load", f"a {type(mark).__name__}", "bytes", "give what `save` returned")
    return bytes(mark)


def joined(codes: Sequence[int], states: Sequence[bytes]) -> bytes:
    """The outcomes of the core and the states of a group of runs, as bytes."""
    head = _LANES.pack(_OF_LANES, len(codes)) + struct.pack(f"<{len(codes)}q", *codes)
    return sealed(head, b"".join(states))


def parted(mark: object, n: int) -> tuple[tuple[int, ...], list[bytes]]:
    """What `joined` joined of n runs. Raises SimulationError where it is not that."""
    given = bytes_of(mark)
    if len(given) < _LANES.size or not given.startswith(_OF_LANES):
        found, remedy = (
            "the bytes are no saved state of runs of `start_many`",
            "give what its `save` returned",
        )
        raise SimulationError("load", found, SAME, remedy)
    if (count := _LANES.unpack_from(given)[1]) != n:
        found, remedy = f"a state of {count} runs", f"write start_many(library, {count}, ...)"
        raise SimulationError("load", found, f"one of {n} runs", remedy)
    head, states = opened(given, _LANES.size + 8 * n)
    size = len(states) // n
    return struct.unpack_from(f"<{n}q", head, _LANES.size), [
        states[k * size : (k + 1) * size] for k in range(n)
    ]
