"""The source files of the package as syntax trees, and their C functions as line counts."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "modelgen"

PYTHON = sorted(PACKAGE.rglob("*.py"))
C = sorted([*PACKAGE.rglob("*.c"), *PACKAGE.rglob("*.h")])
TESTS = sorted([*(ROOT / "tests").rglob("*.py"), *(ROOT / "tests").rglob("*.c")])


def short(path: Path) -> str:
    """The path below the package: `scene/read.py`."""
    return path.relative_to(PACKAGE).as_posix()


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """(line, module) of each import, at any depth of the file; `from a import b` counts as a and as a.b."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{short(path)}:{node.lineno}: relative import"
            yield node.lineno, node.module or ""
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def is_module(name: str) -> bool:
    """Whether a dotted name is a module of the package rather than something defined in one."""
    path = ROOT / name.replace(".", "/")
    return path.is_dir() or path.with_suffix(".py").is_file()


def python_functions(path: Path) -> Iterator[tuple[str, int]]:
    """(name, lines) of each function, from its `def` to its end."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or 0) - node.lineno + 1


def c_functions(text: str) -> Iterator[tuple[str, int]]:
    """(name, lines) of each function: a block at depth 0 whose head ends with `)`, to its closing brace."""
    lines = text.splitlines()
    head: list[str] = []
    depth, start, name = 0, 0, ""
    for number, line in enumerate(lines):
        code = re.sub(r'//.*|/\*.*?\*/|"[^"]*"', "", line)
        if depth == 0:
            head = [] if code.rstrip().endswith((";", "}")) and "{" not in code else [*head, code]
            if "{" in code:
                opening = " ".join(head).split("{")[0].rstrip()
                found = re.search(r"(\w+)\s*\([^{]*\)$", opening)
                name, start = (found[1] if found else ""), number
        depth += code.count("{") - code.count("}")
        if depth == 0 and "{" in " ".join(head):
            if name:
                yield name, number - start + 1
            head, name = [], ""
