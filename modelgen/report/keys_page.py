"""The manual's page of the keys of scene files, written from the JSON Schema that the reader uses."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from modelgen.scene.json_schema import scene_schema

Schema = dict[str, Any]

UNBOUNDED = 1e30  # limits of the schema that only keep numbers finite
HEADER = """# Keys of scene files

Every table and key of a scene file, with values, default and meaning; generated from the JSON Schema.

A number may be written as an expression of constants, such as `"pi/2"`. `modelgen schema` prints the same as
JSON Schema, for validation and for completion in editors. [Scenes](scenes.md) explains the tables.
"""
TABLES = (
    ("contact", "[[contact]]"),
    ("force", "[[force]]"),
    ("torque", "[[torque]]"),
    ("spring", "[[spring]]"),
)


def keys_page() -> str:
    """Markdown: one section for each table of the scene format, one row for each key."""
    schema = scene_schema()
    keys, definitions = schema["properties"], schema["$defs"]
    top = {name: each for name, each in keys.items() if name in ("gravity", "observe", "fold")}
    parts = [HEADER, *_section("Top level", top, ())]
    parts += _section("`[run]`", keys["run"]["properties"], keys["run"].get("required", ()))
    parts += _variants("`[[body]]`", "motion", definitions["body"])
    parts += _variants("`shape`", "kind", definitions["shape"])
    for name, title in TABLES:
        table = keys[name]["items"]
        parts += _section(f"`{title}`", table["properties"], table.get("required", ()))
    parts += _variants("`[[joint]]`", "kind", keys["joint"]["items"])
    return "\n".join(parts) + "\n"


def _section(title: str, keys: Schema, required: Iterable[str]) -> list[str]:
    rows = [_row(name, each, set(required)) for name, each in _flat(keys)]
    head = ["| key | values | default | meaning |", "| --- | --- | --- | --- |"]
    return [f"## {title}\n", *head, *rows, ""]


def _variants(title: str, tag: str, schema: Schema) -> list[str]:
    """A table whose keys depend on `tag`: the keys that all variants share, then those of each."""
    tables = {each["properties"][tag]["const"]: each for each in schema["oneOf"]}
    merged: dict[str, Schema] = {}
    for name, table in tables.items():
        merged[name] = {**merged.get(name, {}), **table["properties"]}
    first = next(iter(merged.values()))
    shared = {key: each for key, each in first.items() if all(each == m.get(key) for m in merged.values())}
    required = set.intersection(*(set(table.get("required", ())) for table in tables.values()))
    default = next((name for name, table in tables.items() if tag not in table.get("required", ())), None)
    kinds = {tag: {"enum": list(merged), "description": first[tag]["description"], "default": default}}
    parts = _section(title, kinds | shared, required)
    for name, table in tables.items():
        own = {key: each for key, each in table["properties"].items() if key != tag and key not in shared}
        if own:
            section = _section(f'{title} with `{tag} = "{name}"`', own, table.get("required", ()))
            parts += [f"#{section[0]}", *section[1:]]
    alone = [name for name, t in tables.items() if set(t["properties"]) <= {tag, *shared}]
    return [*parts, f"No keys of its own: {', '.join(f'`{name}`' for name in alone)}.\n"] if alone else parts


def _flat(keys: Schema) -> Iterator[tuple[str, Schema]]:
    """Every key, those of a table within a table as `outer.inner`."""
    for name, each in keys.items():
        yield name, each
        for branch in each.get("anyOf", [each]):
            inner = branch.get("items", branch) if branch.get("type") == "array" else branch
            for key, value in inner.get("properties", {}).items():
                yield f"{name}.{key}", value


def _row(name: str, each: Schema, required: set[str]) -> str:
    default = "required" if name in required else _written(each.get("default"))
    cells = (f"`{name}`", _values(each), default, each.get("description", ""))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


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
