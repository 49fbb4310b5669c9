"""A function of the core whose comment says "Needs .." asserts it in the debug core."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import pytest

CORE = Path(__file__).parents[2] / "modelgen" / "core"
SOURCES = {
    path.relative_to(CORE).as_posix(): path.read_text(encoding="utf-8") for path in CORE.rglob("*.[ch]")
}
COMMENT = re.compile(r"^/\*(?P<text>.*?)\*/(?P<below>.*?)(?=^/\*|^\s*$|\Z)", re.MULTILINE | re.DOTALL)
HEAD = re.compile(r"^(?:\w[\w \t]*?[ *])(mg_\w+)\(", re.MULTILINE)  # from the first column: no call is
ASSERTION = re.compile(r"\bMG_(?:NEEDS\w*|REQUIRE)\(")


def without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)


def needing(text: str) -> set[str]:
    """Functions declared or defined in the first lines below a comment with the word "Needs"."""
    said = (found for found in COMMENT.finditer(text) if re.search(r"\bNeeds\b", found["text"]))
    return {name for found in said for name in HEAD.findall(found["below"])}


def bodies(text: str) -> dict[str, str]:
    """Text between the braces of each function that is defined, without comments."""
    code, found = without_comments(text), {}
    for head in HEAD.finditer(code):
        start = next(i for i in range(head.end(), len(code)) if code[i] in "{;")
        depth = 0
        for i in range(start, len(code) if code[start] == "{" else start):
            depth += {"{": 1, "}": -1}.get(code[i], 0)
            if not depth:
                found[head[1]] = code[start : i + 1]
                break
    return found


def unasserted(sources: Mapping[str, str]) -> set[str]:
    """Functions that say they need something and assert nothing, or are not defined."""
    defined = {name: body for text in sources.values() for name, body in bodies(text).items()}
    said = set[str]().union(*(needing(text) for text in sources.values()))
    return {name for name in said if not ASSERTION.search(defined.get(name, ""))}


def test_each_function_that_needs_something_asserts_it() -> None:
    assert len(set[str]().union(*(needing(text) for text in SOURCES.values()))) > 100
    assert unasserted(SOURCES) == set()


HEADER = """
/* Does one thing. */
MG_INTERNAL int mg_other(const mg_context *c);

/* Does another at (t, x), and a third. Needs
   the poses at x. */
MG_INTERNAL const mg_real *mg_planted(mg_context *c, mg_real t, const mg_real *x,
                                      int which);
MG_INTERNAL void mg_planted_too(mg_context *c);

MG_INTERNAL void mg_without_comment(mg_context *c);
"""
SOURCE = """
MG_INTERNAL int mg_other(const mg_context *c) { return 1; }

MG_INTERNAL const mg_real *mg_planted(mg_context *c, mg_real t, const mg_real *x,
                                      int which) {
  %s
  for (int i = 0; i < 3; i++) {
    mg_other(c);
  }
  return 0;
}

MG_INTERNAL void mg_planted_too(mg_context *c) { %s }

MG_INTERNAL void mg_without_comment(mg_context *c) { MG_NEEDS_ANY(c, MG_VALID_POSES); }
"""


@pytest.mark.parametrize(
    ("first", "second", "found"),
    [
        ("MG_NEEDS(c, MG_VALID_POSES, t, x);", "MG_REQUIRE(c != 0);", set()),
        ("/* MG_NEEDS(c, MG_VALID_POSES, t, x); */", "MG_NEEDS_ANY(c, MG_VALID_POSES);", {"mg_planted"}),
        ("MG_NEEDS_AT(c, MG_VALID_POSES, x);", "MG_NOTE(c, MG_VALID_POSES, t, x);", {"mg_planted_too"}),
        ("int MG_NEEDS;", "", {"mg_planted", "mg_planted_too"}),
    ],
)
def test_one_that_does_not_is_found(first: str, second: str, found: set[str]) -> None:
    assert unasserted({"planted.h": HEADER, "planted.c": SOURCE % (first, second)}) == found


def test_a_static_function_is_looked_at_where_it_is_defined() -> None:
    text = "/* Needs the rows. */\nstatic int mg_planted(mg_context *c) {\n  return mg_rows(c);\n}\n"
    assert unasserted({"planted.c": text}) == {"mg_planted"}
    assert unasserted({"planted.c": text.replace("return", "MG_NEEDS_ANY(c, 1);\n  return")}) == set()
    assert unasserted({"planted.h": "/* Needs the rows. */\nint mg_planted(void);\n"}) == {"mg_planted"}
