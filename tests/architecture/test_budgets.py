"""No function is so long that it hides its subject."""

from __future__ import annotations

from tests.architecture.sources import PYTHON, C, c_functions, python_functions, short

PYTHON_LINES, C_LINES = 100, 150


def test_python_functions_have_one_subject() -> None:
    assert not [
        f"{short(path)}: {name} has {lines} lines"
        for path in PYTHON
        for name, lines in python_functions(path)
        if lines > PYTHON_LINES
    ]


def test_c_functions_have_one_subject() -> None:
    assert not [
        f"{short(path)}: {name} has {lines} lines"
        for path in C
        for name, lines in c_functions(path.read_text(encoding="utf-8"))
        if lines > C_LINES
    ]


def test_c_functions_are_counted() -> None:
    text = "typedef struct {\n  int a;\n} s;\n"
    text += "static int f(int a,\n  int b)\n{\n  if (a) {\n  }\n  return b;\n}\n"
    assert list(c_functions(text)) == [("f", 5)]
