"""What may be done in some places only: input and output, calls into C, tolerances, allocation."""

from __future__ import annotations

import ast
import fnmatch
import re
from pathlib import Path

import pytest

from tests.architecture.sources import PYTHON, ROOT, C, imports, short, tree

IO_PLACES = (
    "scene/read.py",
    "codegen/build.py",
    "codegen/compiler.py",
    "codegen/library.py",
    "report/",
    "measure/counts.py",
    "measure/peers/",
    "measure/store.py",
    "measure/survey_table.py",
    "measure/table.py",
    "measure/counts.py",
    "measure/peers/program.py",
    "measure/peers/programs/",
    "cli/",
)
IO_MODULES = {"subprocess", "shutil", "tempfile", "socket", "urllib", "http", "multiprocessing"}
IO_CALLS = {
    *("open", "print", "write_text", "write_bytes", "read_text", "read_bytes", "unlink", "mkdir"),
    *("rename", "rmdir", "savez", "savez_compressed", "savetxt", "loadtxt"),
}
PACKAGE_DATA = {"codegen/emit.py": {"read_text"}}  # the text of the core is part of the program
C_CALLERS = ("codegen/library.py", "runtime/")

# Numbers below 1e-3 in runtime/ outside Accuracy, and why each is no tolerance of a run.
SMALL = {
    ("complementarity.py", 1e-12): "rounding slack of the test whether a given matrix is semidefinite",
    **{
        ("mpcc.py", 10.0**-k): "relaxations of the reference by IPOPT, its tolerances"
        for k in (4, 6, 8, 10, 11, 12)
    },
    ("painleve.py", 1e-10): "what counts as zero when the signs of a small problem are read",
    ("reference.py", 1e-7): "row classification of the slow reference answer",
    ("simulate.py", 1e-6): "keeps a measured wall time from being zero",
}
TOP_LEVEL = {"pyproject.toml", "README.md", "LICENSE", "modelgen", "generated", "tests", "scenes"}


def called_names(path: Path) -> set[str]:
    calls = [node.func for node in ast.walk(tree(path)) if isinstance(node, ast.Call)]
    names = {f.id for f in calls if isinstance(f, ast.Name)}
    return names | {f.attr for f in calls if isinstance(f, ast.Attribute)}


def test_no_line_is_broken_where_a_console_thinks_it_ends() -> None:
    """Through a pipe it would be after 80 characters, within a sentence."""
    calls = [(path, node) for path in PYTHON for node in ast.walk(tree(path)) if isinstance(node, ast.Call)]
    printed = [
        (path, node)
        for path, node in calls
        if isinstance(node.func, ast.Attribute) and node.func.attr == "print"
    ]
    broken = [
        f"{short(path)}:{node.lineno}"
        for path, node in printed
        if "soft_wrap" not in {keyword.arg for keyword in node.keywords}
    ]
    assert printed
    assert not broken


@pytest.mark.parametrize("path", [p for p in PYTHON if not short(p).startswith(IO_PLACES)], ids=short)
def test_input_and_output_have_their_places(path: Path) -> None:
    modules = {name.split(".")[0] for _, name in imports(path)}
    assert not modules & IO_MODULES
    assert not called_names(path) & IO_CALLS - PACKAGE_DATA.get(short(path), set())


@pytest.mark.parametrize("path", [p for p in PYTHON if not short(p).startswith(C_CALLERS)], ids=short)
def test_the_core_is_called_from_the_library_and_the_runtime(path: Path) -> None:
    assert not {name for _, name in imports(path) if name.split(".")[0] == "ctypes"}


@pytest.mark.parametrize("path", PYTHON, ids=short)
def test_no_text_is_executed(path: Path) -> None:
    """Scene text is data: nothing that could run it is called anywhere."""
    names = {
        node.func.id
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert not names & {"eval", "exec", "compile", "sympify", "parse_expr"}


def test_tolerances_are_in_accuracy() -> None:
    found = set()
    for path in PYTHON:
        if short(path).startswith("runtime/") and path.name != "accuracy.py":
            numbers = [n.value for n in ast.walk(tree(path)) if isinstance(n, ast.Constant)]
            found |= {(path.name, x) for x in numbers if isinstance(x, float) and 0 < abs(x) < 1e-3}
    assert found == set(SMALL)


@pytest.mark.parametrize("path", C, ids=short)
def test_the_core_neither_allocates_nor_prints(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"\b(malloc|calloc|realloc|free|printf|fprintf|exit|abort)\s*\(", text)
    assert set(re.findall(r"#include <(\S+)>", text)) <= {
        "math.h",
        "tgmath.h",
        "float.h",
        "stddef.h",
        "string.h",
    }


def test_the_top_level_is_fixed() -> None:
    patterns = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    ignored = [pattern.strip("/") for pattern in patterns]
    names = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    kept = {name for name in names if not any(fnmatch.fnmatch(name, pattern) for pattern in ignored)}
    assert (kept - {"uv.lock"}) | {"generated"} == TOP_LEVEL
