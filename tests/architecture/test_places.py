"""What may be done in some places only: input and output, calls into C, tolerances, allocation."""

from __future__ import annotations

import ast
import fnmatch
import re
from pathlib import Path

from tests.architecture.sources import PYTHON, ROOT, C, imports, short, tree

IO_PLACES = (
    "file_writing.py",
    "scene/read.py",
    "codegen/build.py",
    "codegen/compiler.py",
    "codegen/library.py",
    "codegen/built_files.py",
    "codegen/core_cache.py",
    "identification/recording_files.py",
    "casadi_functions/compiled_function.py",
    "report/",
    "view/guarded_server.py",
    "benchmark/callgrind_counts.py",
    "benchmark/peers/",
    "benchmark/measurement_store.py",
    "benchmark/extremes_table.py",
    "benchmark/measurement_table.py",
    "export/",
    "parameter_study/sweep_folder.py",
    "parameter_study/dask_workers.py",
    "parameter_study/sweep_output.py",
    "importing/",
    "cli/",
)
IO_MODULES = {"subprocess", "shutil", "tempfile", "socket", "urllib", "http", "multiprocessing"}
IO_CALLS = {
    *("open", "print", "write_text", "write_bytes", "read_text", "read_bytes", "unlink", "mkdir"),
    *("rename", "rmdir", "savez", "savez_compressed", "savetxt", "loadtxt"),
}
PACKAGE_DATA = {  # part of the program: the text of the core, the page that plays a run
    "codegen/amalgamation.py": {"read_text"},
    "view/page.py": {"read_text", "write_text"},
}
C_CALLERS = ("codegen/library.py", "runtime/", "export/sources/")  # the last: what is written for elsewhere

# Numbers below 1e-3 in runtime/ outside Accuracy, and why each is no tolerance of a run.
SMALL = {
    ("compiled_lcp.py", 1e-12): "rounding slack of the test whether a given matrix is semidefinite",
    **{
        ("mpcc.py", 10.0**-k): "relaxations of the reference by IPOPT, its tolerances"
        for k in (4, 6, 8, 10, 11, 12)
    },
    ("painleve.py", 1e-10): "what counts as zero when the signs of a small problem are read",
    ("qp_reference.py", 1e-7): "row classification of the slow reference answer",
    ("finite_differences.py", 2e-4): "step of differences between runs",
    ("simulate.py", 1e-6): "keeps a measured wall time from being zero",
}
C_HEADERS = {"math.h", "tgmath.h", "float.h", "stddef.h", "string.h", "assert.h"}  # the last: debug core
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


def test_input_and_output_have_their_places() -> None:
    wrong = []
    for path in PYTHON:
        if not short(path).startswith(IO_PLACES):
            modules = {name.split(".")[0] for _, name in imports(path)} & IO_MODULES
            called = called_names(path) & IO_CALLS - PACKAGE_DATA.get(short(path), set())
            wrong += [f"{short(path)}: {name}" for name in sorted(modules | called)]
    assert not wrong


def test_the_core_is_called_from_the_library_and_the_runtime() -> None:
    assert not [
        short(path)
        for path in PYTHON
        if not short(path).startswith(C_CALLERS)
        for _, name in imports(path)
        if name.split(".")[0] == "ctypes"
    ]


def test_no_text_is_executed() -> None:
    """Scene text is data: nothing that could run it is called anywhere."""
    forbidden = {"eval", "exec", "compile", "sympify", "parse_expr"}
    assert not [
        f"{short(path)}:{node.lineno}: {node.func.id}"
        for path in PYTHON
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in forbidden
    ]


def test_tolerances_are_in_accuracy() -> None:
    found = set()
    for path in PYTHON:
        if short(path).startswith("runtime/") and path.name != "accuracy.py":
            numbers = [n.value for n in ast.walk(tree(path)) if isinstance(n, ast.Constant)]
            found |= {(path.name, x) for x in numbers if isinstance(x, float) and 0 < abs(x) < 1e-3}
    assert found == set(SMALL)


def test_the_core_neither_allocates_nor_prints() -> None:
    wrong = []
    for path in (path for path in C if short(path).startswith("core/")):
        text = path.read_text(encoding="utf-8")
        called = re.findall(r"\b(malloc|calloc|realloc|free|printf|fprintf|exit|abort)\s*\(", text)
        foreign = set(re.findall(r"#include <(\S+)>", text)) - C_HEADERS
        wrong += [f"{short(path)}: {name}" for name in (*called, *sorted(foreign))]
    assert not wrong


def test_the_top_level_is_fixed() -> None:
    patterns = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    ignored = [pattern.strip("/") for pattern in patterns]
    names = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    kept = {name for name in names if not any(fnmatch.fnmatch(name, pattern) for pattern in ignored)}
    assert (kept - {"uv.lock"}) | {"generated"} == TOP_LEVEL
