"""Types of lists and tables in the scene format: each reads itself and states its JSON Schema."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any

from modelgen.name_suggestions import SYNONYMS, synonym
from modelgen.scene.key_remedies import meant
from modelgen.scene.scalar_types import NUMBER, Choice, Schema, Type
from modelgen.scene.source_location import Place, describe


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list of `length` items (any length from 0 if None)."""

    item: Type
    length: int | None
    example: str = ""  # as a remedy shows it

    def read(self, value: object, place: Place) -> tuple[Any, ...]:
        if not isinstance(value, list | tuple) or (self.length is not None and len(value) != self.length):
            size = "a list" if self.length is None else f"a list of {self.length}"
            raise place.error(describe(value), f"{size} is allowed", self._remedy(value))
        return tuple(self.item.read(each, place.item(index)) for index, each in enumerate(value))

    def schema(self) -> Schema:
        schema: Schema = {"type": "array", "items": self.item.schema()}
        return schema if self.length is None else schema | {"minItems": self.length, "maxItems": self.length}

    def _remedy(self, value: object) -> str:
        """How to write it; whole numbers that are too many may be numbers with decimal commas."""
        if self.length is None:
            return "write [a, b, ...]"
        pointed = _with_points(value, self.length) if isinstance(value, list) else []
        if len(pointed) == 1:
            return f"decimals have a point: write [{', '.join(pointed[0])}]"
        return f"write {self.example or '[' + ', '.join('...' for _ in range(self.length)) + ']'}"


def _with_points(values: list[Any], length: int) -> list[list[str]]:
    """The ways to read a list that is too long as `length` numbers: two whole numbers side by side may be one
    with a decimal comma."""
    if len(values) < length or len(values) > 2 * length:
        return []
    if not values:
        return [[]]
    first, *rest = values
    found = [[str(first), *others] for others in _with_points(rest, length - 1)]
    if rest and type(first) is type(rest[0]) is int and rest[0] >= 0:
        found += [[f"{first}.{rest[0]}", *others] for others in _with_points(rest[1:], length - 1)]
    return found


@dataclass(frozen=True, slots=True)
class Field:
    """One key of a table. A default of None on a field that is not required means: absent."""

    key: str
    type: Type
    doc: str
    required: bool = False
    default: Any = None


@dataclass(frozen=True, slots=True)
class Table:
    """A table of known keys. Reads to a dict with every key; absent ones hold their default."""

    fields: tuple[Field, ...]
    exclusive: tuple[tuple[str, ...], ...] = ()  # groups of keys of which at most one is written
    instead_of_list: str = ""  # what to write where it is written as a list of tables

    def read(self, value: object, place: Place) -> dict[str, Any]:
        if not isinstance(value, Mapping):
            keys = [field.key for field in self.fields if field.required] or [self.fields[0].key]
            pairs = ", ".join(f"{key} = ..." for key in keys)
            in_words = (self.instead_of_list if isinstance(value, list) else "") or f"write {{ {pairs} }}"
            raise place.error(describe(value), "a table is allowed", in_words)
        self._check_keys(value, place)
        return {
            field.key: field.type.read(value[field.key], place.key(field.key))
            if field.key in value
            else field.default
            for field in self.fields
        }

    def schema(self) -> Schema:
        properties = {field.key: _property(field) for field in self.fields}
        required = [field.key for field in self.fields if field.required]
        schema: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
        if required:
            schema["required"] = required
        pairs = [[a, b] for group in self.exclusive for i, a in enumerate(group) for b in group[i + 1 :]]
        if pairs:
            schema["not"] = {"anyOf": [{"required": pair} for pair in pairs]}
        return schema

    def _check_keys(self, value: Mapping[Any, object], place: Place) -> None:
        known = [field.key for field in self.fields]
        for key in value:
            if key not in known:
                shown = key if isinstance(key, str) and len(key) <= 60 else str(key)[:57] + "..."
                allowed = "allowed are " + ", ".join(known)
                raise place.error(f"unknown key {shown!r}", allowed, meant(shown, known))
        for field in self.fields:
            if field.required and field.key not in value:
                added = f"a [[{field.key}]]" if isinstance(field.type, Several) else field.key
                raise place.error(f"the key {field.key!r} is missing", "", f"add {added}: {field.doc}")
        for group in self.exclusive:
            written = [key for key in group if key in value]
            if len(written) > 1:
                found = " and ".join(map(repr, written)) + " together"
                raise place.error(found, "one of " + ", ".join(group) + " is allowed", "remove the others")


@dataclass(frozen=True, slots=True)
class Tagged:
    """A table whose keys depend on the value of `tag`. Reads to a dict that includes the tag."""

    tag: str
    doc: str
    tables: Mapping[str, Table]
    default: str | None = None  # the tag's value where it is not written

    def read(self, value: object, place: Place) -> dict[str, Any]:
        allowed = "allowed are " + ", ".join(self.tables)
        if not isinstance(value, Mapping):
            raise place.error(describe(value), "a table is allowed", f'write {{ {self.tag} = "...", ... }}')
        if self.tag not in value and self.default is None:
            others = [key for key in value if self.tag in SYNONYMS.get(str(key).lower(), ())]
            remedy = f"write {self.tag} in place of {others[0]}" if others else f"add {self.tag}: {self.doc}"
            raise place.error(f"the key {self.tag!r} is missing", allowed, remedy)
        written = value.get(self.tag, self.default)
        tag = Choice(tuple(self.tables)).read(written, place.key(self.tag))
        rest = {key: each for key, each in value.items() if key != self.tag}
        self._check_misplaced(tag, rest, place)
        return {self.tag: tag} | self.tables[tag].read(rest, place)

    def schema(self) -> Schema:
        return {"oneOf": [self._branch(name, table) for name, table in self.tables.items()]}

    def _check_misplaced(self, tag: str, rest: Mapping[Any, object], place: Place) -> None:
        """A key that belongs to other values of the tag deserves a better answer than `unknown`."""
        own = [field.key for field in self.tables[tag].fields]
        for key in (key for key in rest if key not in own):
            homes = [name for name, table in self.tables.items() if key in (f.key for f in table.fields)]
            if homes:
                found = f"the key {key!r} where {self.tag} is {tag!r}"
                allowed = f"it belongs to {self.tag} = " + " or ".join(map(repr, homes))
                raise place.error(found, f"{allowed}; allowed here are {', '.join(own)}", synonym(key, own))

    def _branch(self, name: str, table: Table) -> Schema:
        schema = table.schema()
        schema["properties"] = {self.tag: {"const": name, "description": self.doc}} | schema["properties"]
        if name != self.default:
            schema["required"] = [self.tag, *schema.get("required", [])]
        return schema


@dataclass(frozen=True, slots=True)
class Several:
    """A list of tables, or just one where `single`. Reads to a tuple of (place, value)."""

    item: Type
    single: bool = False
    label: str = ""  # what messages call an item that has a name

    def read(self, value: object, place: Place) -> tuple[tuple[Place, Any], ...]:
        if self.single and isinstance(value, Mapping):
            return ((place, self.item.read(value, place)),)
        if not isinstance(value, list | tuple):
            raise place.error(describe(value), "a list of tables is allowed", self._remedy(value, place))
        places = [self.place(each, place.item(index)) for index, each in enumerate(value)]
        return tuple((at, self.item.read(each, at)) for at, each in zip(places, value, strict=True))

    def schema(self) -> Schema:
        item = self.item.schema()
        items = {"type": "array", "items": item}
        return {"anyOf": [item, items]} if self.single else items

    def _remedy(self, value: object, place: Place) -> str:
        if isinstance(value, Mapping):
            return f"write [[{place.path}]]"
        item = self.item.type if isinstance(self.item, Defined) else self.item
        if isinstance(item, Tagged) and isinstance(value, str) and value in item.tables:
            return f'write {{ {item.tag} = "{value}", ... }}'
        return ""

    def place(self, value: object, place: Place) -> Place:
        """The place of an item, with its name where it has one."""
        name = value.get("name") if isinstance(value, Mapping) else None
        return place.named(f"{self.label} {name[:40]!r}") if self.label and isinstance(name, str) else place


@dataclass(frozen=True, slots=True)
class Defined:
    """A type that the schema states once, under a name."""

    name: str
    type: Type

    def read(self, value: object, place: Place) -> Any:
        return self.type.read(value, place)

    def schema(self) -> Schema:
        return {"$ref": f"#/$defs/{self.name}"}


@dataclass(frozen=True, slots=True)
class NamedNumbers:
    """A table of numbers whose keys the user chooses."""

    pattern: str
    allowed: str

    def read(self, value: object, place: Place) -> tuple[tuple[str, float], ...]:
        table = self.named(value, place)
        return tuple((key, NUMBER.read(each, place.key(key))) for key, each in table.items())

    def named(self, value: object, place: Place) -> Mapping[str, object]:
        """The table, whose names are allowed; raises SceneError."""
        if not isinstance(value, Mapping):
            raise place.error(describe(value), "a table of names and numbers is allowed")
        for key in value:
            if not isinstance(key, str) or not re.fullmatch(self.pattern, key):
                raise place.error(f"the name {str(key)[:60]!r}", self.allowed)
        return value

    def schema(self) -> Schema:
        return {
            "type": "object",
            "patternProperties": {self.pattern: NUMBER.schema()},
            "additionalProperties": False,
        }


def _property(field: Field) -> Schema:
    default = {} if field.default is None else {"default": _plain(field.default)}
    return field.type.schema() | {"description": field.doc} | default


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    return [_plain(each) for each in value] if isinstance(value, tuple) else value
