"""The C core as two texts: one header, `modelgen.h`, and one source, `modelgen_runtime.c`.

The core is written as many files; it is compiled as one unit, in which the functions that its files share are
static. The texts include nothing but each other and the C library, so that a folder that holds both compiles
by itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable

HEADER, SOURCE = "modelgen.h", "modelgen_runtime.c"
ELEMENTARY, SENSITIVITY = "elementary/", "sensitivity/"  # folders of the core
INCLUDE = re.compile(r'#include "([^"]+)"[^\n]*\n')  # begins with a literal, which is found ten times as fast


@cache
def core_files() -> dict[str, str]:
    """The hand-written C files, by path within the core, in alphabetical order."""
    found = {name: item.read_text(encoding="utf-8") for name, item in _walk(resources.files("modelgen.core"))}
    return dict(sorted(found.items()))


@cache
def header_text() -> str:
    """The public header with all headers that it includes."""
    return _merged([HEADER], set())


@cache
def runtime_text(derivatives: bool = False, lines: bool = False) -> str:
    """The source files of the core, each header once.

    Args:
        derivatives: with those that differentiate runs.
        lines: with directives by which a compiler, and an assertion that fails, name these files.
    """
    sources = [name for name in _sources() if derivatives or not name.startswith(SENSITIVITY)]
    return _unit("The core of modelgen", sources, lines)


@cache
def elementary_text() -> str:
    """The elementary functions alone, which kernels call: to be linked with kernels without the core."""
    sources = [name for name in _sources() if name.startswith(ELEMENTARY)]
    return _unit("The elementary functions of modelgen's core", sources)


def _sources() -> list[str]:
    return [name for name in core_files() if name.endswith(".c")]


def _unit(what: str, sources: list[str], lines: bool = False) -> str:
    known = {HEADER}
    _merged([HEADER], known)
    return f'/* {what} in one file, made from its sources. */\n#include "{HEADER}"\n\n' + _merged(
        sources, known, lines
    )


def abi() -> int:
    """The ABI number that the public header defines."""
    match = re.search(r"#define MG_ABI (\d+)", core_files()[HEADER])
    assert match is not None
    return int(match.group(1))


def _walk(folder: Traversable, prefix: str = "") -> Iterator[tuple[str, Traversable]]:
    for item in folder.iterdir():
        if item.is_dir():
            yield from _walk(item, f"{prefix}{item.name}/")
        elif item.name.endswith((".c", ".h")):
            yield prefix + item.name, item


def _merged(names: list[str], known: set[str], lines: bool = False) -> str:
    """The texts in order; each included header is inserted where it is first included."""
    files = core_files()

    def text(name: str) -> str:
        def include(match: re.Match[str]) -> str:
            header, line = match.group(1), files[name].count("\n", 0, match.end()) + 1
            back = _line(line, name) if lines else ""
            if header in known:
                return back
            known.add(header)
            return text(header) + back

        return (_line(1, name) if lines else "") + INCLUDE.sub(include, files[name])

    return "".join(f"/* {name} */\n{text(name)}\n" for name in names)


def _line(number: int, name: str) -> str:
    return f'#line {number} "{name}"\n'
