"""The C compiler of the programs that tests compile themselves: the one that also compiles the libraries."""

from __future__ import annotations

import pytest

from modelgen.codegen.compiler import find_compiler
from modelgen.errors import CompilerMissing


def _command() -> tuple[str, ...]:
    try:
        return find_compiler().command
    except CompilerMissing:
        return ()


CC = _command()  # the words before the flags: of the compiler that CC names, else of one that is installed
needs_c = pytest.mark.skipif(not CC, reason="needs a C compiler")
