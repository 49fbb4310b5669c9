"""Statements of data: members of sets, and values of parameters and starts of variables as lists and
tables."""

from __future__ import annotations

import re
from typing import Any

from tests.ampl.names import Key, Members, Names, index_of
from tests.ampl.tokens import AmplError

WORD = re.compile(r":=|[:()]|'[^']*'|\"[^\"]*\"|[^\s:,()]+(?:\.\S*)?")


def read_data(statement: str, names: Names) -> None:
    """`set ..` or `param ..` of a part with data."""
    kind, words = statement.split(maxsplit=1)[0].rstrip(":"), _words(statement)
    if kind == "set":
        name, listed = words[1], words[words.index(":=") + 1 :]
        names.given_sets[name] = _members(listed, names.size(name))
    elif words[1] == ":":
        _columns(words[2:], names)
    else:
        _one(words[1:], names)


def _words(statement: str) -> list[str]:
    return WORD.findall(statement.replace(",", " "))


def _value(word: str) -> Any:
    if word[0] in "'\"":
        return word[1:-1]
    try:
        return index_of(float(word))
    except ValueError:
        return word


def _members(words: list[str], size: int) -> Members:
    values = [_value(word) for word in words if word not in "()"]
    return {tuple(values[k : k + size]): None for k in range(0, len(values), size)}


def _columns(words: list[str], names: Names) -> None:
    """`param : [SET :] a b c := key a b c ..`"""
    at = words.index(":=")
    heads, rows = words[:at], words[at + 1 :]
    members: str | None = None
    if ":" in heads:
        members, heads = heads[0], heads[2:]
    size = names.size(members) if members else _indices(names, heads[0])
    width = size + len(heads)
    if len(rows) % width:
        raise AmplError(f"{len(rows)} entries in rows of {width} of param {heads}")
    if members:
        names.given_sets[members] = {}
    for k in range(0, len(rows), width):
        key = tuple(_value(word) for word in rows[k : k + size])
        if members:
            names.given_sets[members][key] = None
        for head, word in zip(heads, rows[k + size : k + width], strict=True):
            _give(names, head, key, word)


def _one(words: list[str], names: Names) -> None:
    """`param a := ..`, a number, a list or tables"""
    name, rest = words[0], words[1:]
    if ":" in rest:
        while rest:
            rest = _table(name, rest, names)
        return
    listed = rest[rest.index(":=") + 1 :]
    size = _indices(names, name)
    for k in range(0, len(listed), size + 1):
        _give(names, name, tuple(_value(word) for word in listed[k : k + size]), listed[k + size])


def _table(name: str, words: list[str], names: Names) -> list[str]:
    """Read `: columns := row values ..` and return what follows it."""
    at = words.index(":=")
    columns, rest = [_value(word) for word in words[:at] if word != ":"], words[at + 1 :]
    end = rest.index(":") if ":" in rest else len(rest)
    rows, width = rest[:end], len(columns) + 1
    if len(rows) % width:
        raise AmplError(f"{len(rows)} entries in rows of {width} of param {name}")
    for k in range(0, len(rows), width):
        for column, word in zip(columns, rows[k + 1 : k + width], strict=True):
            _give(names, name, (_value(rows[k]), column), word)
    return rest[end:]


def _indices(names: Names, name: str) -> int:
    declared: Any = names.parameters.get(name) or names.variables.get(name)
    if declared is None:
        raise AmplError(f"data for {name!r}, which is not declared")
    size: int = declared.indexing.size()
    return size


def _give(names: Names, name: str, key: Key, word: str) -> None:
    if word == ".":  # the default
        return
    declared: Any = names.parameters.get(name) or names.variables[name]
    declared.given[key] = _value(word)
