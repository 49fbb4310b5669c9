"""The sets, parameters and variables of a model, with their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from tests.ampl.tokens import AmplError

Key = tuple[Any, ...]
Members = dict[Key, None]  # a set, in its order
Dummies = dict[str, Any]
Term = Callable[[Dummies], Any]  # an expression: its value where the dummy indices have these values


def index_of(value: Any) -> Any:
    """A value as an index: whole numbers are integers."""
    return int(value) if isinstance(value, float) and value == int(value) else value


@dataclass(frozen=True)
class SetTerm:
    """A set where the dummy indices have some values, and the number of indices of a member."""

    members: Callable[[Dummies], Members]
    size: Callable[[], int]

    def __call__(self, dummies: Dummies) -> Members:
        return self.members(dummies)


@dataclass(frozen=True)
class Indexing:
    """`{i in I, (j, k) in A: condition}`; a set without dummy indices has the pattern None."""

    items: tuple[tuple[tuple[str, ...] | None, SetTerm], ...] = ()
    condition: Term | None = None

    def each(self, dummies: Dummies) -> Iterator[tuple[Key, Dummies]]:
        """Members with the values of the dummy indices."""
        for key, found in self._from(0, (), dummies):
            if self.condition is None or self.condition(found):
                yield key, found

    def _from(self, at: int, key: Key, dummies: Dummies) -> Iterator[tuple[Key, Dummies]]:
        if at == len(self.items):
            yield key, dummies
            return
        pattern, members = self.items[at]
        for member in members(dummies):
            found = _matched(pattern, member, dummies)
            if found is not None:
                yield from self._from(at + 1, key + member, found)

    def bound(self, key: Key) -> Dummies:
        """The values of the dummy indices at a member."""
        dummies: Dummies = {}
        for pattern, members in self.items:
            size = len(pattern) if pattern is not None else members.size()
            part, key = key[:size], key[size:]
            dummies |= dict(zip(pattern or (), part, strict=pattern is not None))
        return dummies

    def size(self) -> int:
        """Indices of a member."""
        return sum(len(pattern) if pattern is not None else members.size() for pattern, members in self.items)


def _matched(pattern: tuple[str, ...] | None, member: Key, dummies: Dummies) -> Dummies | None:
    """With the dummy indices of a member; None where one that is known already has another value."""
    if pattern is None:
        return dummies
    found = dict(dummies)
    for name, value in zip(pattern, member, strict=True):
        if name in dummies and dummies[name] != value:
            return None
        found[name] = value
    return found


@dataclass
class Parameter:
    indexing: Indexing
    value: Term | None
    default: Term | None
    given: dict[Key, Any] = field(default_factory=dict)


@dataclass
class Variable:
    indexing: Indexing
    lower: list[Term]
    upper: list[Term]
    start: Term | None
    definition: Term | None
    given: dict[Key, float] = field(default_factory=dict)  # starts that data or `let` give
    fixed: dict[Key, float] = field(default_factory=dict)
    symbols: dict[Key, ca.SX] = field(default_factory=dict)


@dataclass
class SetOf:
    members: SetTerm | None
    within: SetTerm | None


class Names:
    """What the statements of a model declare."""

    def __init__(self) -> None:
        self.sets: dict[str, SetOf] = {}
        self.parameters: dict[str, Parameter] = {}
        self.variables: dict[str, Variable] = {}
        self.given_sets: dict[str, Members] = {}
        self._known: dict[tuple[str, Key], Any] = {}

    def forget(self) -> None:
        """Values that were derived, after a value that they rest on was changed."""
        self._known.clear()

    def size(self, name: str) -> int:
        """Indices of a member of a set."""
        declared = self.sets[name]
        term = declared.within or declared.members
        return term.size() if term is not None else 1

    def members(self, name: str) -> Members:
        if name in self.given_sets:
            return self.given_sets[name]
        declared = self.sets.get(name)
        if declared is None or declared.members is None:
            raise AmplError(f"set {name!r} has no members")
        if (name, ()) not in self._known:
            self._known[name, ()] = declared.members({})
        found: Members = self._known[name, ()]
        return found

    def value(self, name: str, key: Key) -> Any:
        """Of a parameter, a number; of a variable, its symbol or its definition."""
        if name in self.variables and self.variables[name].definition is None:
            return self.variables[name].symbols[key]
        if (name, key) not in self._known:
            self._known[name, key] = self._derived(name, key)
        return self._known[name, key]

    def _derived(self, name: str, key: Key) -> Any:
        if name in self.variables:
            variable = self.variables[name]
            assert variable.definition is not None
            return variable.definition(variable.indexing.bound(key))
        if name not in self.parameters:
            raise AmplError(f"name {name!r} is unknown")
        parameter = self.parameters[name]
        if key in parameter.given:
            return parameter.given[key]
        term = parameter.value or parameter.default
        if term is None:
            raise AmplError(f"parameter {name}{list(key)} has no value")
        return term(parameter.indexing.bound(key))

    def create_symbols(self) -> None:
        """A symbol for each variable that is not defined by others."""
        for name, variable in self.variables.items():
            if variable.definition is None:
                keys = [key for key, _ in variable.indexing.each({})]
                variable.symbols = {key: ca.SX.sym(name + "".join(f"_{k}" for k in key)) for key in keys}
