"""Types of single values in the scene format: each reads itself and states its JSON Schema.

Reader and schema come from the same objects, so that they cannot drift apart.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import pi
from typing import Any, Protocol

from modelgen.name_suggestions import nearest
from modelgen.scene.source_location import Place, describe

HUGE = 1e30  # beyond it no number of a scene is meaningful
Schema = dict[str, Any]

_CONSTANT_TEXT = {
    "type": "string",
    "minLength": 1,
    "description": 'an expression of constants, such as "pi/2"',
}


class Type(Protocol):
    def read(self, value: object, place: Place) -> Any: ...
    def schema(self) -> Schema: ...


@dataclass(frozen=True, slots=True)
class Real:
    """A number, or a text such as "pi/2", in [minimum, maximum]."""

    minimum: float = -HUGE
    maximum: float = HUGE

    @property
    def allowed(self) -> str:
        if self.minimum == 1.0 / HUGE:
            return f"a positive number up to {self.maximum:g} is allowed"
        return f"a number from {self.minimum:g} to {self.maximum:g} is allowed"

    def read(self, value: object, place: Place) -> float:
        number = place.number(value) if isinstance(value, str) else value
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise place.error(describe(value), self.allowed)
        if not self.minimum <= number <= self.maximum:
            raise place.error(describe(value), self.allowed)
        return float(number)

    def schema(self) -> Schema:
        number = {"type": "number", "minimum": self.minimum, "maximum": self.maximum}
        return {"anyOf": [number, _CONSTANT_TEXT]}


@dataclass(frozen=True, slots=True)
class Bound:
    """A number, or the text "none", which reads to None."""

    def read(self, value: object, place: Place) -> float | None:
        return None if value == "none" else NUMBER.read(value, place)

    def schema(self) -> Schema:
        return {"anyOf": [{"const": "none"}, NUMBER.schema()]}


@dataclass(frozen=True, slots=True)
class Lead:
    """A rise in m a turn, which reads to m per radian."""

    def read(self, value: object, place: Place) -> float:
        return NUMBER.read(value, place) / (2 * pi)

    def schema(self) -> Schema:
        return NUMBER.schema()


LIMIT = Bound()
POSITIVE = Real(minimum=1.0 / HUGE)
NUMBER = Real()


@dataclass(frozen=True, slots=True)
class Whole:
    minimum: int
    maximum: int

    def read(self, value: object, place: Place) -> int:
        found: object = value
        if isinstance(value, str) and (number := place.number(value)).is_integer():
            found = int(number)
            if place.follows():
                raise place.error(
                    f"the whole number {found} that follows from a parameter",
                    "counts decide what is compiled",
                    "write a number, or a constant without parameters",
                )
        if isinstance(found, bool) or not isinstance(found, int) or not self.minimum <= found <= self.maximum:
            allowed = f"a whole number from {self.minimum} to {self.maximum} is allowed"
            raise place.error(describe(value), allowed)
        return found

    def schema(self) -> Schema:
        number = {"type": "integer", "minimum": self.minimum, "maximum": self.maximum}
        return {"anyOf": [number, _CONSTANT_TEXT]}


@dataclass(frozen=True, slots=True)
class Switch:
    def read(self, value: object, place: Place) -> bool:
        if not isinstance(value, bool):
            raise place.error(describe(value), "true or false is allowed")
        return value

    def schema(self) -> Schema:
        return {"type": "boolean"}


@dataclass(frozen=True, slots=True)
class Choice:
    options: tuple[str, ...]
    number: str = ""  # the remedy for a number in place of a name

    def read(self, value: object, place: Place) -> str:
        if value not in self.options:
            remedy = nearest(value, self.options) if isinstance(value, str) else self.number
            raise place.error(describe(value), "allowed are " + ", ".join(self.options), remedy)
        return str(value)

    def schema(self) -> Schema:
        return {"enum": list(self.options)}


@dataclass(frozen=True, slots=True)
class Text:
    """A text that matches a pattern."""

    pattern: str
    allowed: str

    def read(self, value: object, place: Place) -> str:
        if not isinstance(value, str) or not re.fullmatch(self.pattern, value):
            raise place.error(describe(value), self.allowed)
        return value

    def schema(self) -> Schema:
        return {"type": "string", "pattern": self.pattern}


def words(most: int, least: int = 0) -> Text:
    """Words on one line, of `least` to `most` characters. Control characters, separators of lines and what
    XML cannot hold are refused: such a text is shown in tables, pages and model descriptions."""
    allowed = f"one line of at most {most} characters, without control characters, is allowed"
    return Text(rf"^[^\x00-\x1f\x7f-\x9f\u2028\u2029\ufffe\uffff]{{{least},{most}}}$", allowed)


@dataclass(frozen=True, slots=True)
class ExpressionText:
    """A number, or the text of an expression; its names are checked where they are known."""

    doc: str

    def read(self, value: object, place: Place) -> str:
        if isinstance(value, str):
            return value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise place.error(describe(value), f"a number or an {self.doc} is allowed")
        return repr(NUMBER.read(value, place))

    def schema(self) -> Schema:
        number = {"type": "number", "minimum": -HUGE, "maximum": HUGE}
        return {"anyOf": [number, {"type": "string", "minLength": 1, "description": self.doc}]}
