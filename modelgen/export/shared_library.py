"""Texts of C compiled to a shared library."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from modelgen.codegen.built_files import cache_folder
from modelgen.codegen.compiler import LIBRARIES, SHARED, Compiler, run_compiler
from modelgen.file_writing import scratch_folder

NAME, LOG = "compiled.so", "compiled.log"


def shared_library(
    compiler: Compiler, flags: Sequence[str], texts: Mapping[str, str], units: Sequence[str]
) -> bytes:
    """The library of `units`, which are files of `texts` or objects with their full path.

    Raises LibraryError where the compiler fails; the message names the log, which lies in the cache folder.
    """
    with scratch_folder() as folder:
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8")
        command = [*compiler.command, *flags, *SHARED, "-o", NAME, *units, *LIBRARIES]
        run_compiler(command, folder, cache_folder() / LOG)
        return (folder / NAME).read_bytes()
