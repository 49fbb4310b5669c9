"""How many contacts may be closed at a time: as many as their scratch memory allows, which grows with the
square of that number. The memory is reserved; what a run touches of it follows the contacts that are closed.
"""

from __future__ import annotations

import ctypes
import os
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.tables.ctypes_structures import INTEGER

SHARE = 0.5  # of the memory of the machine that one run may reserve
UNKNOWN_MACHINE = 2**31  # bytes that it may reserve where that memory is not known
ROWS_MAX = 26_000  # MG_ROW_MAX
EXPORTED = 3 * 2**28  # bytes in an exported program, as static arrays: two runs fit below 2 GiB


def memory_of_run() -> int:
    """Bytes that a run may reserve on this machine."""
    try:
        return int(SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):  # no POSIX system
        return UNKNOWN_MACHINE


def fit_scratch(cdll: ctypes.CDLL, system: Any, dtype: np.dtype[Any], most: int) -> tuple[int, int]:
    """Lower the `closed_capacity` of an mg_system until its scratch arrays take at most `most` bytes.

    Returns their lengths, numbers and integers. Raises SimulationError where not one closed contact has room.
    """

    def bytes_at(capacity: int) -> int:
        system.closed_capacity = capacity
        work, iwork = scratch_sizes(cdll, system)
        return work * dtype.itemsize + iwork * INTEGER.itemsize if work >= 0 else most + 1

    fits, beyond = 1, int(system.closed_capacity)
    if beyond and bytes_at(beyond) > most:
        least = bytes_at(1)
        if least > most:
            raise SimulationError(
                f"{system.n_contact} contacts of {system.n_body} bodies",
                f"a run needs {gibibytes(least)} of memory",
                f"it may take {gibibytes(most)}",
                "list fewer pairs in [[contact]], or use fewer bodies or more memory",
            )
        while beyond - fits > 1:
            middle = (fits + beyond) // 2
            fits, beyond = (middle, beyond) if bytes_at(middle) <= most else (fits, middle)
        system.closed_capacity = fits
    return scratch_sizes(cdll, system)


def scratch_sizes(cdll: ctypes.CDLL, system: Any) -> tuple[int, int]:
    """Lengths of the scratch arrays of an mg_system, numbers and integers; -1 where the core has no such
    size."""
    functions = cdll.mg_work_size, cdll.mg_iwork_size
    for function in functions:
        function.restype = ctypes.c_longlong
    work, iwork = (int(function(ctypes.byref(system))) for function in functions)
    return work, iwork


def solver_scratch(
    work_size: Any, iwork_size: Any, dtype: np.dtype[Any], rows: int, *contacts: int
) -> tuple[Any, Any]:
    """The scratch arrays of a solver of the core, by its functions of their lengths.

    Raises SimulationError for more rows than the core can number, or more memory than the machine gives.
    """
    if rows > ROWS_MAX:
        remedy = "divide the problem into its independent parts"
        raise SimulationError("complementarity problem", f"{rows} rows", f"at most {ROWS_MAX}", remedy)
    work_size.restype = iwork_size.restype = ctypes.c_longlong
    return scratch(int(work_size(rows, *contacts)), int(iwork_size(rows, *contacts)), dtype)


def scratch(work: int, iwork: int, dtype: np.dtype[Any]) -> tuple[Any, Any]:
    """The scratch arrays. Raises SimulationError where the machine does not give that much."""
    try:
        return np.empty(work, dtype=dtype), np.zeros(iwork, dtype=INTEGER)
    except MemoryError:
        needed = gibibytes(work * dtype.itemsize + iwork * INTEGER.itemsize)
        raise SimulationError(
            "memory of a run",
            f"{needed} are needed, and the machine does not give them",
            f"a run may take {gibibytes(memory_of_run())} of this machine where it is free",
            "end other programs, or list fewer pairs in [[contact]]",
        ) from None


def gibibytes(n: int) -> str:
    """A size for a message."""
    return f"{n / 2**30:.3g} GiB"
