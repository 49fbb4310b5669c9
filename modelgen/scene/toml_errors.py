"""Syntax errors of TOML files, in terms of what the user wrote."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass

from modelgen.scene.decimal_comma import DECIMAL_COMMA, with_point

_POSITION = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")
_NUMBER = r"[-+]?\d[\d_]*(?:\.\d+)?(?:[eE][-+]?\d+)?"
_WITH_UNIT = re.compile(rf"({_NUMBER})\s*([A-Za-zµ°%][\w/^*²]*)")
LISTS = ("body", "contact", "joint", "force", "torque", "spring")  # tables of which there may be several
_CASE = {"true": "true", "false": "false", "nan": "nan", "inf": "inf", "none": "", "null": ""}


@dataclass(frozen=True, slots=True)
class SyntaxFault:
    """One syntax error: the line (from 1; 0: the end of the file), what was found there, and the remedy."""

    line: int
    found: str
    remedy: str


def syntax_fault(text: str, error: tomllib.TOMLDecodeError) -> SyntaxFault:
    """The first syntax error of a TOML text, described by its line."""
    message = str(error)
    position = _POSITION.search(message)
    number, column = (int(position[1]), int(position[2])) if position and position[1] else (0, 0)
    lines = text.splitlines()
    line = lines[number - 1] if 0 < number <= len(lines) else ""
    what = message[: position.start()] if position else message
    found, remedy = _explained(what, line, column - 1)
    return SyntaxFault(number, found, remedy)


def _explained(message: str, line: str, column: int) -> tuple[str, str]:
    """What was found, and the remedy; `message` is that of the parser, which stopped at `column` (from 0)."""
    key = line.partition("=")[0].strip()
    if declared := re.fullmatch(r"Cannot declare \((.*)\) twice", message):
        name = ".".join(re.findall(r"'([^']*)'", declared[1]))
        remedy = f"write [[{name}]] for each of them" if name in LISTS else "merge the two"
        return f"the table [{name}] is written twice", remedy
    if line.lstrip().startswith("[") and message.startswith("Cannot overwrite"):
        name = line.strip().strip("[]")
        return f"{name!r} is already a table or a value", f"write [[{name}]] for every entry of a list"
    if message.startswith(("Cannot overwrite", "Duplicate inline table key")):
        named = re.search(r"'(.*)'", message)
        return f"the key {named[1] if named else key!r} is given twice", "remove one of the two"
    if message.startswith("Expected newline"):
        return _after_value(line, column)
    if message == "Invalid value":
        return _invalid_value(key, line[column:].split("#")[0].strip())
    if message.startswith("Expected '=' after a key"):
        return _no_equals_sign(line, column)
    if message.startswith("Invalid statement"):
        if line.lstrip().startswith(("{", "<")):
            return (
                f"the line {_short(line.strip())!r}",
                "a scene is TOML, no JSON and no XML",
            )
        if line.lstrip().startswith(("//", "/*", "%", ";", "--")):
            return f"the line {line.strip()!r}", "begin comments with #"
        return f"the line {line.strip()!r}", "write key = value, or a table such as [run]"
    if "array declaration" in message or "table declaration" in message:
        return f"the header {line.strip()!r} lacks a closing bracket", "write [name] or [[name]]"
    if message.startswith("Unclosed inline table"):
        return (
            "a table in braces without closing brace, or without a comma between two entries",
            "write { a = 1, b = 2 } on one line",
        )
    if message.startswith("Unclosed array") or "array" in message:
        return (
            "a list without closing bracket, or without a comma between two entries",
            "write [a, b, c]; a list may go on over several lines",
        )
    if "initial character for a key part" in message:
        return (
            "a table in braces that goes on after the end of its line, or that ends in a comma",
            "write { a = 1, b = 2 } on one line",
        )
    if message.startswith(
        ("Illegal character '\\n'", "Unterminated string", 'Expected "\'"', "Expected '\"'")
    ):
        return "a text without closing quotation mark", 'end the text with " on the same line'
    if "'\\'" in message:
        return "a backslash in a text", r"write \\, or put the text in single quotes"
    return message, "mend the text there"


def _short(text: str) -> str:
    return text if len(text) <= 40 else f"{text[:37]}..."


def _after_value(line: str, column: int) -> tuple[str, str]:
    """The value ended, but the line goes on."""
    value = line.partition("=")[2].strip()
    rest = line[column:].split("#")[0].strip()
    if comma := DECIMAL_COMMA.search(value):
        return with_point(comma[0])
    if re.match(r"[-+]?\d+\.(?!\d)", value):
        whole = value.partition(".")[0]
        return f"the number {whole}. without digits after the point", f"write {whole}.0"
    if re.match(r"[-+]?0\d", value):
        return f"the number {value.split()[0]} with a leading zero", "leave the zero out"
    if (unit := _WITH_UNIT.match(value)) and not unit[2].startswith("_"):
        return f"the number {unit[1]} with the unit {unit[2]!r}", "write the number alone, in SI units"
    return f"{rest!r} after the value", "write one key = value on a line; comments begin with #"


def _invalid_value(key: str, value: str) -> tuple[str, str]:
    """There is no value, or none that TOML knows."""
    word = re.match(r"[A-Za-z_][\w./-]*", value)
    if not value:
        return f"the key {key!r} without a value", f"write a value after the '=', or remove {key!r}"
    if word and word[0].lower() in _CASE:
        known = _CASE[word[0].lower()]
        return f"the value {word[0]}", f"write {known}" if known else f"leave out {key!r}, if it has no value"
    if point := re.match(r"[-+]?(?=\.\d)", value):
        rest = value[point.end() :].split(",")[0].rstrip(" ]}")
        return f"the number {point[0]}{rest} without digits before the point", f"write {point[0]}0{rest}"
    if word:
        return f"the text {word[0]} without quotation marks", f'write "{word[0]}"'
    return f"{value[:40]!r} is no value", 'a value is a number, "a text", true, false, [a, b] or { a = b }'


def _no_equals_sign(line: str, column: int) -> tuple[str, str]:
    """A key is not followed by '='."""
    character = line[column : column + 1]
    if character == ":":
        return f"':' after the key {line[:column].strip()!r}", "write key = value"
    if character and not character.isascii():
        return f"the character {character!r} in a key", "use the letters A-Z and a-z, digits, _ and - in keys"
    before = line[:column].rstrip()
    if comma := re.search(rf"(?:{DECIMAL_COMMA.pattern})$", before):
        return with_point(comma[0])
    return f"no '=' after the key {re.split('[{,]', before)[-1].strip()!r}", "write key = value"
