"""The manual's page of the keys of scene files, written from the JSON Schema that the reader uses."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest
from modelgen.scene.json_schema import scene_schema

Schema = dict[str, Any]

UNBOUNDED = 1e30  # limits of the schema that only keep numbers finite
HEADER = """# Keys of scene files

Every table and key of a scene file, with values, default and meaning; generated from the JSON Schema.

A number may be written as an expression of constants, such as `"pi/2"`. `modelgen schema` prints the same as
JSON Schema, for validation and for completion in editors. [Scenes](scenes.md) explains the tables.
"""
TABLES = (
    ("parameter", "[[parameter]]"),
    ("pattern", "[[pattern]]"),
    ("contact", "[[contact]]"),
    ("contacts", "[contacts]"),
    ("force", "[[force]]"),
    ("torque", "[[torque]]"),
    ("spring", "[[spring]]"),
)


@dataclass(frozen=True, slots=True)
class Row:
    """One key of a table: its values, default and meaning, as Markdown."""

    key: str
    values: str
    default: str
    meaning: str

    def markdown(self) -> str:
        cells = (f"`{self.key}`", self.values, self.default, self.meaning)
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


@dataclass(frozen=True, slots=True)
class Section:
    """The keys of a table, or those of one of its kinds."""

    table: str  # "`[[contact]]`"
    title: str  # the same, with the kind if the section is about one
    rows: tuple[Row, ...]
    names: tuple[str, ...]  # what the section is about: "contact"; "torus"
    level: int = 2
    without_keys: tuple[str, ...] = ()  # kinds that have no keys of their own

    def markdown(self) -> str:
        head = ["| key | values | default | meaning |", "| --- | --- | --- | --- |"]
        lines = [f"{'#' * self.level} {self.title}\n", *head, *(row.markdown() for row in self.rows), ""]
        return "\n".join(lines)


def keys_page() -> str:
    """Markdown: one section for each table of the scene format, one row for each key."""
    parts = [HEADER]
    for section in sections():
        parts.append(section.markdown())
        if section.without_keys:
            parts.append(f"No keys of its own: {', '.join(f'`{name}`' for name in section.without_keys)}.\n")
    return "\n".join(parts) + "\n"


def page_of(name: str) -> str:
    """Markdown of `sections_of` a name."""
    parts = []
    for section in sections_of(name):
        if section.rows:
            parts.append(section.markdown())
        if name in section.without_keys:
            parts.append(f"`{name}` has no keys of its own beside those of {section.table}.\n")
    return "\n".join(parts)


def sections_of(name: str) -> tuple[Section, ...]:
    """What the scene format says of a name: a table or kind whole, and the rows of a key in every table.

    Raises:
        ModelgenError: no table, key or kind has that name.
    """
    found = []
    for section in sections():
        rows = section.rows
        if name not in section.names:
            rows = tuple(row for row in rows if name in row.key.split("."))
        if rows or name in section.without_keys:
            found.append(replace(section, rows=rows))
    if not found:
        raise ModelgenError(
            f"key {name!r}",
            "the scene format has no table, key or kind of that name",
            "`modelgen manual keys` lists all",
            nearest(name, sorted(_names())),
        )
    return tuple(found)


def sections() -> tuple[Section, ...]:
    """The tables of the scene format in the order of the page, after each the kinds of it."""
    schema = scene_schema()
    keys, definitions = schema["properties"], schema["$defs"]
    top = {name: each for name, each in keys.items() if name in ("constants", "gravity", "observe", "fold")}
    found = [_section("Top level", top, (), ())]
    found.append(_section("`[run]`", keys["run"]["properties"], keys["run"].get("required", ()), ("run",)))
    found += _variants("`[[body]]`", "motion", definitions["body"], "body")
    found += _variants("`shape`", "kind", definitions["shape"], "shape")
    for name, title in TABLES:
        table = keys[name].get("items", keys[name])
        found.append(_section(f"`{title}`", table["properties"], table.get("required", ()), (name,)))
    found += _variants("`[[joint]]`", "kind", keys["joint"]["items"], "joint")
    return tuple(found)


def _names() -> set[str]:
    """Every table, kind and key."""
    found: set[str] = set()
    for section in sections():
        keys = (part for row in section.rows for part in row.key.split("."))
        found |= {*section.names, *section.without_keys, *keys}
    return found


def _section(title: str, keys: Schema, required: Iterable[str], names: tuple[str, ...]) -> Section:
    rows = tuple(_row(name, each, needed) for name, each, needed in _flat(keys, set(required)))
    return Section(title, title, rows, names)


def _variants(title: str, tag: str, schema: Schema, name: str) -> list[Section]:
    """A table whose keys depend on `tag`: the keys that all variants share, then those of each."""
    tables = {each["properties"][tag]["const"]: each for each in schema["oneOf"]}
    merged: dict[str, Schema] = {}
    for kind, table in tables.items():
        merged[kind] = {**merged.get(kind, {}), **table["properties"]}
    first = next(iter(merged.values()))
    shared = {key: each for key, each in first.items() if all(each == m.get(key) for m in merged.values())}
    required = set.intersection(*(set(table.get("required", ())) for table in tables.values()))
    default = next((kind for kind, table in tables.items() if tag not in table.get("required", ())), None)
    kinds = {tag: {"enum": list(merged), "description": first[tag]["description"], "default": default}}
    found = [_section(title, kinds | shared, required, (name,))]
    for kind, table in tables.items():
        own = {key: each for key, each in table["properties"].items() if key != tag and key not in shared}
        if own:
            section = _section(title, own, table.get("required", ()), (kind,))
            found.append(replace(section, title=f'{title} with `{tag} = "{kind}"`', level=3))
    alone = tuple(kind for kind, t in tables.items() if set(t["properties"]) <= {tag, *shared})
    return [*found[:-1], replace(found[-1], without_keys=alone)]


def _flat(keys: Schema, required: set[str]) -> Iterator[tuple[str, Schema, bool]]:
    """Every key and whether its table requires it; those of a table within a table as `outer.inner`."""
    for name, each in keys.items():
        yield name, each, name in required
        for branch in each.get("anyOf", [each]):
            inner = branch.get("items", branch) if branch.get("type") == "array" else branch
            for key, value in inner.get("properties", {}).items():
                yield f"{name}.{key}", value, key in inner.get("required", ())


def _row(name: str, each: Schema, required: bool) -> Row:
    default = "required" if required else _written(each.get("default"))
    return Row(name, _values(each), default, each.get("description", ""))


def _written(default: Any) -> str:
    if default is None or default in ([], ()):
        return ""
    return f"`{json.dumps(default, ensure_ascii=False)}`"


def _values(each: Schema) -> str:
    """Description of the values that a key may have."""
    if "$ref" in each:
        return f"a {each['$ref'].rsplit('/', 1)[1]} table"
    if "const" in each:
        return f"`{each['const']}`"
    if "enum" in each:
        return ", ".join(f"`{value}`" for value in each["enum"])
    for several in ("anyOf", "oneOf"):
        if several in each:
            words = [_values(b) for b in each[several] if "constants" not in b.get("description", "")]
            return " or ".join(dict.fromkeys(words))
    return _plain(each)


def _plain(each: Schema) -> str:
    kind = each.get("type", "any")
    if kind == "array":
        size = each.get("minItems")
        fixed = size is not None and size == each.get("maxItems")
        return f"list of {f'{size} ' if fixed else ''}({_values(each.get('items', {}))})"
    if kind in ("number", "integer"):
        return {"number": "number", "integer": "whole number"}[kind] + _range(each)
    return {"string": "text", "boolean": "`true`, `false`", "object": "table"}.get(kind, str(kind))


def _range(each: Schema) -> str:
    low, high = each.get("minimum", -UNBOUNDED), each.get("maximum", UNBOUNDED)
    if low > -UNBOUNDED and high < UNBOUNDED:
        return f", {low:g} to {high:g}"
    if low > -UNBOUNDED:
        return ", positive" if 0 < low < 1e-20 else f", at least {low:g}"
    return f", at most {high:g}" if high < UNBOUNDED else ""
