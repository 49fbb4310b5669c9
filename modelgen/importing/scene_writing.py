"""Text of a scene file from its tables: readable TOML with comments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any

import numpy as np

WIDTH = 110
DIGITS = 15
NOTHING = 1e-15  # a length, component of a unit vector or velocity that is zero but for rounding


@dataclass(frozen=True)
class Section:
    """A table of a scene file, such as `[[body]]`, with a comment before it.

    Attributes:
        head: its name, with a dot before the last part of a table within a table.
        values: its keys; a value is text, a number, a truth value, a list, or a mapping written inline.
        single: whether the table exists once (`[run]`).
    """

    head: str
    values: Mapping[str, Any]
    comment: str = ""
    single: bool = False
    inner: Sequence[Section] = field(default_factory=tuple)


def scene_text(head: Sequence[str], top: Mapping[str, Any], sections: Iterable[Section]) -> str:
    """The text of a scene file.

    Args:
        head: lines of the comment that begins it; an item of a list begins with `- `.
        top: keys before all tables.
        sections: its tables, in order.
    """
    lines = [*_comment(head)]
    if top:
        lines += ["", *(line for key, value in top.items() for line in _assigned(key, value))]
    for section in sections:
        lines += _section(section)
    return "\n".join(lines) + "\n"


def rounded(x: float) -> float:
    """A number with 15 digits."""
    return float(f"{float(x):.{DIGITS}g}") + 0.0


def vector(x: Iterable[float]) -> list[float]:
    """Components with 15 digits; zero where they are nothing but rounding, also beside the largest one."""
    values = np.asarray(list(x), dtype=float)
    least = NOTHING * max(1.0, float(np.abs(values).max(initial=0.0)))
    return [0.0 if abs(each) < least else rounded(each) for each in values]


def moments(x: Iterable[float]) -> list[float]:
    """Moments of inertia with 15 digits, however small."""
    return [rounded(each) for each in x]


def _comment(head: Sequence[str]) -> Iterator[str]:
    for line in head:
        hanging = "  " if line.startswith("- ") else ""
        broken = wrap(line, WIDTH - 2, subsequent_indent=hanging, break_on_hyphens=False) or [""]
        yield from (f"# {each}".rstrip() for each in broken)


def _section(section: Section) -> Iterator[str]:
    yield ""
    if section.comment:
        yield from _comment([section.comment])
    yield f"[{section.head}]" if section.single else f"[[{section.head}]]"
    for key, value in section.values.items():
        yield from _assigned(key, value)
    for each in section.inner:
        yield from _section(each)


def _assigned(key: str, value: Any) -> list[str]:
    """`key = value`, a long list with an item a line."""
    text = _value(value)
    if len(key) + len(text) + 3 <= WIDTH or not isinstance(value, list | tuple):
        return [f"{key} = {text}"]
    if all(isinstance(each, int | float) for each in value):
        return [f"{key} = [", *wrap(text[1:-1], WIDTH, initial_indent="  ", subsequent_indent="  "), "]"]
    return [f"{key} = [", *_rows(value), "]"]


def _rows(value: Sequence[Any]) -> Iterator[str]:
    """Items, as many a line as fit."""
    line = " "
    for each in value:
        text = f" {_value(each)},"
        if len(line) + len(text) > WIDTH and line.strip():
            yield line
            line = " "
        line += text
    yield line


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(rounded(value))
    if isinstance(value, Mapping):
        return (
            "{}"
            if not value
            else "{ " + ", ".join(f"{key} = {_value(each)}" for key, each in value.items()) + " }"
        )
    return "[" + ", ".join(_value(each) for each in value) + "]"
