"""The core's solvers compiled alone, without the set of kinds of a scene."""

from __future__ import annotations

import ctypes
import subprocess
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from tests.c_compiler import CC
from tests.running import held, pool

CORE = Path(__file__).parents[2] / "modelgen" / "core"
SOLVERS = ("elementary", "base", "solve")  # rooms that know no bodies
WARNINGS = (  # a room alone does not use all that the rooms below it offer
    *("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wshadow", "-Wconversion"),
    "-Wno-unused-function",
)
REALS: dict[str, tuple[tuple[str, ...], Any]] = {
    "double": ((), np.float64),
    "float": (("-DMG_REAL_FLOAT",), np.float32),
    "long double": (("-DMG_REAL_LONG",), np.longdouble),
}


@dataclass(frozen=True)
class CoreBuild:
    cdll: ctypes.CDLL
    dtype: Any


def includes(*rooms: str) -> str:
    """Lines that include the sources of some rooms of the core, of all if none is named."""
    folders = [CORE / room for room in rooms] or [CORE]
    sources = [path for folder in folders for path in sorted(folder.rglob("*.c"))]
    return "".join(f'#include "{path.relative_to(CORE)}"\n' for path in sources)


def compile_core(text: str, *flags: str) -> Path:
    """The solvers, and `text` after them, in one file."""
    return compile_text(includes(*SOLVERS) + text, *flags)


def compile_text(text: str, *flags: str) -> Path:
    """The file that a text of C gives with the core beside it, compiled once in a test run."""
    command = [*CC, *WARNINGS, f"-I{CORE}", *flags]
    folder = pool() / sha256("\0".join([*command, text]).encode()).hexdigest()[:16]
    folder.mkdir(parents=True, exist_ok=True)
    unit, out = folder / "unit.c", folder / "unit.out"
    with held(folder / ".lock"):
        if not out.exists():
            unit.write_text(text)
            done = subprocess.run(
                [*command, unit, "-o", out, "-lm"], capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, done.stderr
    return out


def core_in(real: str, *flags: str) -> CoreBuild:
    """The library of the solvers over "double", "float" or "long double"."""
    return library_in(real, includes(*SOLVERS), "-O2", *flags)


def library_in(real: str, text: str, *flags: str) -> CoreBuild:
    """The library that a text gives over "double", "float" or "long double"."""
    define, dtype = REALS[real]
    path = compile_text(text, *flags, "-fvisibility=hidden", "-shared", "-fPIC", *define)
    return CoreBuild(ctypes.CDLL(str(path)), dtype)


def active_solve(core: CoreBuild, A: np.ndarray, b: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, int]:
    """Forces on the marked rows (`mg_active_solve`), and the rank of their matrix."""
    n = len(b)
    given = [np.asfortranarray(A, dtype=core.dtype), b.astype(core.dtype), active.astype(np.intc)]
    z = np.full(n, np.nan, dtype=core.dtype)
    work = np.empty(core.cdll.mg_lcp_work_size(n), dtype=core.dtype)
    iwork = np.empty(core.cdll.mg_lcp_iwork_size(n), dtype=np.intc)
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (*given, z, work, iwork)]
    return z, int(core.cdll.mg_active_solve(ctypes.c_int(n), *pointers))
