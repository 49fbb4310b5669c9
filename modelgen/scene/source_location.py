"""Location of a value in the scene file, and errors that name it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from modelgen.errors import ExpressionError, SceneError
from modelgen.scene.expression import Expression, evaluate, parse_expression
from modelgen.scene.expression_tangent import Tangent, tangent

if TYPE_CHECKING:
    from modelgen.scene.scene_types import Input


class Use(NamedTuple):
    """A value of the scene that follows from a parameter."""

    parameter: str
    path: str
    label: str

    def __str__(self) -> str:
        return f"{self.path} ({self.label})" if self.label else self.path


class Kink(NamedTuple):
    """A number of a scene that is on a kink where it moves with a parameter."""

    place: str
    is_lost: bool  # it has no derivative; else that for larger values of the parameter


@dataclass(frozen=True, slots=True)
class Motion:
    """A change of all numbers of a scene with one parameter: each by `step` times its derivative."""

    rates: Mapping[str, float]  # derivatives of that parameter and of the constants that follow from it
    step: float
    moved: list[Tangent]  # numbers that it moves, as they are read
    kinks: list[Kink]  # numbers that are on a kink

    def of(self, found: Tangent, place: str) -> float:
        """The number after the change."""
        if found.is_kink:
            self.kinks.append(Kink(place, found.is_lost))
        if found.rate:
            self.moved.append(found)
        return found.value + self.step * found.rate


@dataclass(frozen=True, slots=True)
class Place:
    """The key path of one value, such as `body[0].shape.radius`, in one source."""

    source: str
    path: str = ""
    label: str = ""  # such as "body 'egg'"
    remarks: list[str] = field(default_factory=list, compare=False, repr=False)  # shared by all of a source
    constants: Mapping[str, float] = field(default_factory=dict, compare=False)  # of the scene, by name
    following: Mapping[str, frozenset[str]] = field(
        default_factory=dict, compare=False
    )  # the parameters that a constant follows from, one itself among them
    uses: list[Use] = field(default_factory=list, compare=False, repr=False)  # shared by all of a source
    inputs: tuple[Input, ...] = field(default=(), compare=False)  # of the scene
    motion: Motion | None = field(default=None, compare=False)  # of its numbers, along a parameter

    def __str__(self) -> str:
        where = ": ".join(part for part in (self.source, self.path) if part)
        return f"{where} ({self.label})" if self.label else where

    def key(self, key: str) -> Place:
        return self._at(f"{self.path}.{key}" if self.path else key, self.label)

    def item(self, index: int) -> Place:
        return self._at(f"{self.path}[{index}]", self.label)

    def named(self, label: str) -> Place:
        return self._at(self.path, label)

    def _at(self, path: str, label: str) -> Place:
        shared = self.remarks, self.constants, self.following, self.uses, self.inputs, self.motion
        return Place(self.source, path, label, *shared)

    def error(self, found: str, allowed: str = "", remedy: str = "") -> SceneError:
        return SceneError(str(self), found, allowed, remedy)

    def remark(self, found: str, remedy: str) -> None:
        """Keep a remark on what is allowed but seldom meant; it becomes a warning of the scene."""
        where = f"{self.path} ({self.label})" if self.label else self.path
        self.remarks.append(f"{where}: {found}; {remedy}")

    def expression(self, text: str, names: Collection[str]) -> Expression:
        """The expression `text` over `names`; a refusal names this place."""
        try:
            expression = parse_expression(text, names, self.constants)
        except ExpressionError as error:
            raise self.error(f"in {error.where}: {error.found}", error.allowed, error.remedy) from None
        followed = self._followed(expression)
        if followed and names:
            raise self.error(
                f"in {describe(text)}: the parameter {followed[0]!r} in an expression of {' '.join(names)}",
                "parameters are allowed in numbers and shapes; such an expression is compiled",
                f'name an [[input]] with default = "{followed[0]}", and use that',
            )
        self.note(followed)
        return expression

    def followed_in(self, text: str, names: Collection[str]) -> dict[str, float]:
        """The constants in an expression over `names` that follow from parameters, with their values;
        they are noted."""
        words = dict.fromkeys(re.findall(r"[A-Za-z_]\w*", text)) if self.following else {}
        found = {w: self.constants[w] for w in words if w in self.following and w not in names}
        self.note(sorted({each for name in found for each in self.following[name]}))
        return {name: self._moved(name, value) for name, value in found.items()}

    def _followed(self, expression: Expression) -> list[str]:
        """The parameters that an expression follows from."""
        if not self.following:
            return []
        return sorted({each for name in expression.constants for each in self.following.get(name, ())})

    def note(self, parameters: Iterable[str]) -> None:
        """Keep that the value at this place follows from these parameters."""
        self.uses.extend(Use(name, self.path, self.label) for name in parameters)

    def follows(self, *keys: str) -> bool:
        """Whether a value at this place, or below one of these keys of it, follows from a parameter."""
        if not self.uses:
            return False
        paths = [self.key(key).path for key in keys] or [self.path]
        return any(
            use.path == path or use.path.startswith((f"{path}.", f"{path}["))
            for use in self.uses
            for path in paths
        )

    def number(self, text: str) -> float:
        """The value of an expression without names but those of constants, such as `pi/2`."""
        if text in self.constants:
            self.note(sorted(self.following.get(text, ())))
            return self._moved(text, self.constants[text])
        try:
            return self._moved(text, self.value(self.expression(text, ()), {}))
        except SceneError as error:
            raise SceneError(
                error.where, error.found, error.allowed, error.remedy or "write a number"
            ) from None

    def _moved(self, text: str, value: float) -> float:
        """The value of an expression of constants, after the change of its numbers, if there is one."""
        if self.motion is None:
            return value
        expression = parse_expression(text, self.motion.rates, self.constants)
        if not expression.names:
            return value
        return self.motion.of(self.tangent(expression, self.motion.rates), self.path)

    def tangent(self, expression: Expression, rates: Mapping[str, float]) -> Tangent:
        """The value of an expression of constants, with its derivative from those of the constants; a refusal
        names this place."""
        try:
            return tangent(expression, self.constants, rates)
        except ExpressionError as error:
            raise self.error(f"in {error.where}: {error.found}", "a finite derivative is required") from None

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
