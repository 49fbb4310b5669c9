"""Instructions of a run, counted by valgrind's callgrind on a C program of the run alone."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

from modelgen.codegen.compiler import LIBRARIES, find_compiler
from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.driver import ENTRY, driver_text

CPU = "-march=haswell"  # callgrind knows no newer vector instructions
LEFT_OUT = ("-march=native", "-shared", "-fPIC", "-Wl,-z,defs")
COUNTED = ("double", "float")  # valgrind has no long double
LONGEST_S = 0.2  # of CPU time for a run that is counted; callgrind takes fifty times as long


@cache
def missing_counter() -> str:
    """Why instructions are not counted here; empty where they are."""
    return "" if shutil.which("valgrind") else "valgrind is not installed: instructions are not counted"


def instructions(library: Library, accuracy: Accuracy, until: float, level: str) -> int | None:
    """What the core takes from a settled start to `until`, compiled for Haswell; None where it is not counted."""
    if missing_counter() or library.real not in COUNTED:
        return None
    compiler = find_compiler()
    flags = [flag for flag in compiler.flags(library.real, level) if flag not in LEFT_OUT]
    with tempfile.TemporaryDirectory() as name:
        source, program = Path(name) / "run.c", Path(name) / "run"
        source.write_text(driver_text(library, accuracy, until))
        include = f"-I{library.path.parent}"
        command = [
            *compiler.command,
            *flags,
            CPU,
            '-DMG_HASH="counted"',
            include,
            "-o",
            program,
            source,
            *LIBRARIES,
        ]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            return None
        return _counted(program)


def _counted(program: Path) -> int | None:
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={ENTRY}"]
    done = subprocess.run([*tool, str(program)], capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", done.stderr)
    return int(found[1]) if found else None
