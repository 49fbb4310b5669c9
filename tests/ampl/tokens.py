"""Text of the modelling language AMPL in statements and tokens."""

from __future__ import annotations

import re
from dataclasses import dataclass

COMMENT = re.compile(r"#[^\n]*|/\*.*?\*/", re.S)
TOKEN = re.compile(
    r"""\s*(?:
    (?P<number>(?:\d+\.(?!\.)\d*|\.\d+|\d+)(?:[eE][+-]?\d+)?)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<string>'[^']*'|"[^"]*")
  | (?P<symbol>:=|<=|>=|==|!=|<>|\.\.|\*\*|&&|\|\||[-+*/^(){}\[\]:;,<>=!.])
    )""",
    re.X,
)


class AmplError(ValueError):
    """A statement that is not of the part of the language that is read here."""


@dataclass(frozen=True)
class Token:
    kind: str  # number, name, string, symbol
    text: str


def statements(text: str) -> list[str]:
    """Those of a file, without comments and without their semicolons."""
    parts = (" ".join(part.split()) for part in COMMENT.sub(" ", text).split(";"))
    return [part for part in parts if part]


def tokens(statement: str) -> list[Token]:
    found, at = [], 0
    while at < len(statement.rstrip()):
        match = TOKEN.match(statement, at)
        if match is None:
            raise AmplError(f"{statement[at : at + 30]!r} in {statement[:80]!r}")
        kind = str(match.lastgroup)
        text = match[kind]
        found.append(Token(kind, text[1:-1] if kind == "string" else text))
        at = match.end()
    return found
