"""The rooms of the C core: who may call whom, and that every file stands by itself."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

from tests.architecture.sources import PACKAGE
from tests.c_compiler import CC, needs_c

CORE = PACKAGE / "core"
ROOMS = (  # each may use those before it
    *("elementary", "base", "solve/lcp", "solve/friction", "region", "model", "solid", "closest"),
    *("forces", "integrate", "features", "patch", "impact", "events", "timestep", "run", "sensitivity"),
)
BODILESS = ("elementary", "base", "solve/lcp", "solve/friction", "region")  # they know no body and no scene
FUNCTION = re.compile(r"^(?:MG_API|MG_INTERNAL|static)\b[^;{}=]*?\b(mg_\w+)\([^;{]*\)\s*\{", re.MULTILINE)


def room_of(path: Path) -> str:
    return path.parent.relative_to(CORE).as_posix()


def sources() -> dict[Path, str]:
    """The text of each C file without its comments."""
    return {
        path: re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        for path in sorted(CORE.rglob("*.c"))
    }


def homes() -> dict[str, str]:
    """The room of each function."""
    return {name: room_of(path) for path, text in sources().items() for name in FUNCTION.findall(text)}


def calls() -> Iterator[tuple[str, str, str]]:
    """(file, function named in it, room of that function)."""
    known = homes()
    for path, text in sources().items():
        for name in set(re.findall(r"\bmg_\w+\b", text)) & set(known):
            yield path.relative_to(CORE).as_posix(), name, known[name]


def test_every_source_has_a_room() -> None:
    assert {room_of(path) for path in CORE.rglob("*.c")} == set(ROOMS)


def test_rooms_call_downwards() -> None:
    rank = {room: index for index, room in enumerate(ROOMS)}
    assert not [
        f"{file} calls {name} of {room}"
        for file, name, room in calls()
        if rank[room] > rank[file.rpartition("/")[0]]
    ]


def test_files_of_a_room_call_each_other_in_one_direction() -> None:
    home = {name: path for path, text in sources().items() for name in FUNCTION.findall(text)}
    called = {
        path: {home[name] for name in re.findall(r"\bmg_\w+\b", text) if name in home} - {path}
        for path, text in sources().items()
    }
    TopologicalSorter(called).prepare()  # raises CycleError, with the files of a circle


def test_headers_declare_each_function_under_its_file() -> None:
    found = {path: set(FUNCTION.findall(text)) for path, text in sources().items()}
    wrong = []
    for header in CORE.rglob("*.h"):
        parts = re.split(
            r"^/\* (\w+\.c)(?:: [^*]*)? \*/$", header.read_text(encoding="utf-8"), flags=re.MULTILINE
        )
        for file, text in zip(parts[1::2], parts[2::2], strict=True):
            declared = re.findall(r"^MG_INTERNAL\b[^;{}=]*?\b(mg_\w+)\([^;{]*\);", text, re.MULTILINE)
            here = found.get(header.parent / file, set())
            wrong += [f"{header.name}: {name} is not in {file}" for name in declared if name not in here]
    assert not wrong


def test_rooms_without_bodies_do_not_see_the_context() -> None:
    found = {path: text for path, text in sources().items() if room_of(path) in BODILESS}
    assert not [path.name for path, text in found.items() if re.search(r"\bmg_(context|system|run)\b", text)]


def test_files_include_the_doors_of_their_own_room_and_of_those_below() -> None:
    rank = {room: index for index, room in enumerate(ROOMS)}
    wrong = []
    for path in sorted([*CORE.rglob("*.c"), *CORE.rglob("*.h")]):
        own = rank.get(room_of(path), len(ROOMS))
        included = re.findall(r'#include "([^"]+)"', path.read_text(encoding="utf-8"))
        above = [name for name in included if rank.get(name.rpartition("/")[0], 0) > own]
        wrong += [f"{path.relative_to(CORE)} includes {name}" for name in above]
    assert not wrong


def test_functions_that_one_file_uses_are_static() -> None:
    users: dict[str, set[str]] = {}
    for file, name, _ in calls():
        users.setdefault(name, set()).add(file)
    shared = {
        name
        for text in sources().values()
        for name in re.findall(r"^MG_INTERNAL\b[^;{}=]*?\b(mg_\w+)\([^;{]*\)\s*\{", text, re.MULTILINE)
    }
    headers = "".join(path.read_text(encoding="utf-8") for path in sorted(CORE.rglob("*.h")))
    macros = "".join(re.findall(r"^#define(?:[^\n]*\\\n)*[^\n]*", headers, re.MULTILINE))
    named = set(re.findall(r"\bmg_\w+", macros))  # by macros, which any file may use
    assert not {name for name in shared - named if len(users[name]) < 2}


@needs_c
def test_each_file_compiles_by_itself(tmp_path: Path) -> None:
    check = "-c" if "ziglang" in CC else "-fsyntax-only"  # Zig fails without an object
    strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Wmissing-prototypes", "-Wshadow"]
    command = [*CC, check, "-O0", *strict, "-DMG_INTERNAL=", f"-I{CORE}", *map(str, sources())]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:4000]
