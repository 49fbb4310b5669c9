"""Many mg_run of one library, with their arrays by lane."""

from __future__ import annotations

import ctypes
from typing import Any, cast

import numpy as np

from modelgen.runtime.session import Session
from modelgen.runtime.tables.ctypes_structures import RUN_ARRAYS, Array, address


def lanes_of(session: Session, n: int) -> tuple[ctypes.Array[ctypes.Structure], dict[str, Array]]:
    """n mg_run before their start, and the arrays to which they point, (n, length) each, by name."""
    runs = (session.tables.Run * n)()
    arrays = {}
    for name in RUN_ARRAYS:
        like = session.run_arrays[name]
        arrays[name] = array = np.zeros((n, len(like)), dtype=like.dtype)
        first, row = address(array), array.strides[0]
        for lane, run in enumerate(runs):
            setattr(run, name, first + lane * row)
    arrays["feature_pair"][:] = -1
    arrays["input"][:] = session.input
    return runs, arrays


def times_of(session: Session, runs: ctypes.Array[ctypes.Structure]) -> Array:
    """The times of all runs, (n,) s, as an array that changes with them."""
    kind, memory = session.tables.Run, cast(Any, runs)
    return np.ndarray((len(runs),), session.tables.dtype, memory, kind.t.offset, (ctypes.sizeof(kind),))
