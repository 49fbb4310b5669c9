"""Instructions of a run, counted by valgrind's callgrind on a C program of the run alone."""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path

from modelgen.codegen.compiler import LIBRARIES, Compiler, find_compiler, run_program
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import INSTANCE, STRUCTURE, Manifest
from modelgen.file_writing import scratch_folder
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.c_initialisers import ENTRY, driver_text

CPU = "-march=haswell"  # callgrind knows no newer vector instructions
NOT_OF_A_PROGRAM = ("-march=native", "-fPIC")
COUNTED = ("double", "float")  # valgrind's long double has the digits of double


@cache
def why_not_counted() -> str:
    """Why no instructions are counted here; empty where they are."""
    return "" if shutil.which("valgrind") else "valgrind is not installed: no instructions are counted"


def instructions(library: Library, accuracy: Accuracy, until: float, level: str) -> int | None:
    """Instructions of the core from a settled start to `until`, compiled for Haswell; None: not counted."""
    if why_not_counted() or library.real not in COUNTED:
        return None
    with scratch_folder() as folder:
        source, program = folder / "run.c", folder / "run"
        source.write_text(driver_text(library, accuracy, until))
        model, runtime = _model(library, level), _runtime(library.real, level)
        if model is None:
            return None
        if not _compiled(library, level, ["-o", program, source, model, runtime, *LIBRARIES]):
            return None
        return counted([str(program)], ENTRY)


def _model(library: Library, level: str) -> Path | None:
    """The model as an object, beside the library; compiled once, and only while its C is the library's."""
    target = library.path.with_suffix(".counted.o")
    if target.exists():
        return target
    folder = library.path.parent
    texts = ((folder / name).read_text() for name in (STRUCTURE, INSTANCE))
    if Manifest.from_json(*texts).kinds_hash != library.manifest.kinds_hash:
        return None
    return target if _compiled(library, level, ["-c", "-o", target, folder / "model.c"]) else None


def _runtime(real: str, level: str) -> Path:
    """The core for the processor that is counted."""
    compiler = find_compiler()
    return runtime_object(compiler, _flags(compiler, real, level), lambda line: None)


def _flags(compiler: Compiler, real: str, level: str) -> tuple[str, ...]:
    flags = [flag for flag in compiler.flags(real, level) if flag not in NOT_OF_A_PROGRAM]
    return (*flags, CPU)


def _compiled(library: Library, level: str, rest: list[str | Path]) -> bool:
    compiler = find_compiler()
    named = ['-DMG_HASH="counted"', f"-I{library.path.parent}"]
    command = [*compiler.command, *_flags(compiler, library.real, level), *named, *map(str, rest)]
    return run_program(command).returncode == 0


def counted(command: list[str], function: str) -> int | None:
    """Instructions within a function of a program; None: not counted, or the program fails."""
    if why_not_counted():
        return None
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={function}"]
    done = run_program([*tool, *command])
    found = re.search(r"Collected : (\d+)", done.stderr)
    return int(found[1]) if found and done.returncode == 0 else None
