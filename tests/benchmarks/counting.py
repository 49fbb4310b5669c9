"""Instructions by callgrind: what a process takes, and a library that callgrind can run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from modelgen.codegen.built_files import seal
from modelgen.codegen.compiler import compile_library, find_compiler
from modelgen.codegen.core_cache import runtime_object
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import INSTANCE, STRUCTURE

COUNTED_CPU = "-march=haswell"  # callgrind knows no newer vector instructions


def callgrind(module: str, *arguments: object) -> int:
    """Instructions of the whole process `python -m module arguments`."""
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    command = [*tool, sys.executable, "-m", module, *map(str, arguments)]
    steady = {**os.environ, "PYTHONHASHSEED": "0"}
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=steady)
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1])


def countable(library: Library, folder: Path) -> None:
    """The library compiled again for COUNTED_CPU into `folder`, with its records beside it."""
    (folder / STRUCTURE).write_text(library.manifest.structure_json())
    (folder / INSTANCE).write_text(library.manifest.instance_json())
    (folder / "library.json").write_text(library.record.to_json())
    compiler = find_compiler()
    flags = [COUNTED_CPU if flag == "-march=native" else flag for flag in compiler.flags("double")]
    source, target = library.path.parent / "model.c", folder / library.path.name
    define = f'-DMG_HASH="{library.record.hash}"'
    runtime = runtime_object(compiler, tuple(flags))
    compile_library(compiler, (*flags, define), source, runtime, target, folder / "compiler.log")
    seal(target)
