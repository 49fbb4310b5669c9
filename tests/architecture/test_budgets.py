"""One idea a file, one thing a function."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.architecture.sources import PYTHON, ROOT, TESTS, C, c_functions, python_functions, short

FILE = 300
FUNCTION = 40


def below_root(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("path", [*PYTHON, *C, *TESTS], ids=below_root)
def test_file_is_short(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= FILE


@pytest.mark.parametrize("path", PYTHON, ids=short)
def test_python_functions_are_short(path: Path) -> None:
    assert not {name: lines for name, lines in python_functions(path) if lines > FUNCTION}


@pytest.mark.parametrize("path", C, ids=short)
def test_c_functions_are_short(path: Path) -> None:
    found = dict(c_functions(path.read_text(encoding="utf-8")))
    assert not {name: lines for name, lines in found.items() if lines > FUNCTION}


def test_c_functions_are_counted() -> None:
    text = "typedef struct {\n  int a;\n} s;\n"
    text += "static int f(int a,\n  int b)\n{\n  if (a) {\n  }\n  return b;\n}\n"
    assert list(c_functions(text)) == [("f", 5)]
