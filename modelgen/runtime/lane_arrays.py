"""Many mg_run of one library, with their arrays by lane."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar, cast

import numpy as np

from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.array_block import ArrayBlock
from modelgen.runtime.tables.ctypes_structures import Array

Given = TypeVar("Given")
Made = TypeVar("Made")


def lanes_of(session: Session, n: int) -> tuple[ctypes.Array[ctypes.Structure], dict[str, Array]]:
    """n mg_run before their start, and the arrays to which they point, (n, length) each, by name."""
    runs = (session.tables.Run * n)()
    lengths = {name: (len(array), array.dtype) for name, array in session.run_arrays.items()}
    arrays = rows_of_lanes(runs, lengths)
    arrays["feature_pair"][:] = -1
    arrays["input"][:] = session.input
    return runs, arrays


def rows_of_lanes(
    structures: ctypes.Array[ctypes.Structure], lengths: Mapping[str, tuple[int, np.dtype[Any]]]
) -> dict[str, Array]:
    """Arrays of zeros (n, length) by name, to whose rows n structures point by consecutive pointers."""
    n, arrays, at = len(structures), dict[str, Array](), dict[str, int]()
    for kind in dict.fromkeys(kind for _, kind in lengths.values()):
        block = ArrayBlock({name: (n, length) for name, (length, own) in lengths.items() if own == kind})
        of_kind, places = block.zeros(kind)
        arrays |= of_kind
        at |= places
    widths = [length * kind.itemsize for length, kind in lengths.values()]
    pointers = field_of(structures, next(iter(lengths)), np.dtype(np.uintp), len(lengths))
    pointers[:] = np.outer(np.arange(n, dtype=np.uintp), widths) + [at[name] for name in lengths]
    return {name: arrays[name] for name in lengths}


def each_once(function: Callable[[Given], Made], values: Sequence[Given]) -> list[Made]:
    """What a function makes of each value, called once for lanes that have the same object."""
    made = {key: function(value) for key, value in {id(value): value for value in values}.items()}
    return [made[id(value)] for value in values]


def field_of(
    structures: ctypes.Array[ctypes.Structure], name: str, dtype: np.dtype[Any], count: int = 1
) -> Array:
    """Consecutive fields of n structures, (n, count) from one of this name on, as an array that changes with
    them."""
    kind, memory = structures._type_, cast(Any, structures)
    strides = ctypes.sizeof(kind), dtype.itemsize
    return np.ndarray((len(structures), count), dtype, memory, getattr(kind, name).offset, strides)
