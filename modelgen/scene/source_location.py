"""Location of a value in the scene file, and errors that name it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from modelgen.errors import ExpressionError, SceneError
from modelgen.scene.expression import Expression, evaluate, parse_expression
from modelgen.scene.scene_types import Input


@dataclass(frozen=True, slots=True)
class Place:
    """The key path of one value, such as `body[0].shape.radius`, in one source."""

    source: str
    path: str = ""
    label: str = ""  # such as "body 'egg'"
    remarks: list[str] = field(default_factory=list, compare=False, repr=False)  # shared by all of a source
    constants: Mapping[str, float] = field(default_factory=dict, compare=False)  # of the scene, by name
    inputs: tuple[Input, ...] = field(default=(), compare=False)  # of the scene

    def __str__(self) -> str:
        where = ": ".join(part for part in (self.source, self.path) if part)
        return f"{where} ({self.label})" if self.label else where

    def key(self, key: str) -> Place:
        return replace(self, path=f"{self.path}.{key}" if self.path else key)

    def item(self, index: int) -> Place:
        return replace(self, path=f"{self.path}[{index}]")

    def named(self, label: str) -> Place:
        return replace(self, label=label)

    def error(self, found: str, allowed: str = "", remedy: str = "") -> SceneError:
        return SceneError(str(self), found, allowed, remedy)

    def remark(self, found: str, remedy: str) -> None:
        """Keep a remark on what is allowed but seldom meant; it becomes a warning of the scene."""
        where = f"{self.path} ({self.label})" if self.label else self.path
        self.remarks.append(f"{where}: {found}; {remedy}")

    def expression(self, text: str, names: Collection[str]) -> Expression:
        """The expression `text` over `names`; a refusal names this place."""
        try:
            return parse_expression(text, names, self.constants)
        except ExpressionError as error:
            raise self.error(f"in {error.where}: {error.found}", error.allowed, error.remedy) from None

    def number(self, text: str) -> float:
        """The value of an expression without names but those of constants, such as `pi/2`."""
        try:
            return self.value(self.expression(text, ()), {})
        except SceneError as error:
            raise SceneError(
                error.where, error.found, error.allowed, error.remedy or "write a number"
            ) from None

    def value(self, expression: Expression, values: Mapping[str, float]) -> float:
        """The finite value of an expression; a refusal names this place."""
        try:
            return evaluate(expression, values)
        except ExpressionError as error:
            raise self.error(f"in {error.where}: {error.found}", "a finite value is required") from None


def describe(value: object) -> str:
    """A short text for a value that was found: its kind and as much of it as fits a line."""
    match value:
        case bool():
            return "true" if value else "false"
        case int() if abs(value) > 10**30:
            return "a huge integer"
        case int() | float():
            return f"the number {value!r}"
        case str():
            return f"the text {_short(repr(value))}"
        case list() | tuple():
            return f"a list of {len(value)}"
        case dict():
            return "a table"
    return f"a {type(value).__name__}"


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
