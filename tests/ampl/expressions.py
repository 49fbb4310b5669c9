"""Expressions, conditions, sets and indexing of AMPL, as functions of their dummy indices."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import casadi as ca

from tests.ampl.names import Dummies, Indexing, Key, Members, Names, SetTerm, Term, index_of
from tests.ampl.tokens import AmplError, Token, tokens

FUNCTIONS = {"sqrt", "exp", "log", "sin", "cos", "tan", "atan", "abs"}
RELATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, "<=": operator.le, "=": operator.eq, "==": operator.eq, "!=": operator.ne,
    "<>": operator.ne, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip
ENDS_A_SET = {
    ",",
    "}",
    ")",
    ":",
    ":=",
    "diff",
    "union",
    "inter",
    "cross",
    "within",
    "in",
    "then",
    "default",
    "and",
    "or",
    "&&",
    "||",
    "",
}


class Parser:
    """Reads one statement from its tokens."""

    def __init__(self, statement: str, names: Names) -> None:
        self.statement, self.names = statement, names
        self.tokens: list[Token] = tokens(statement)
        self.at = 0

    @property
    def text(self) -> str:
        """Of the next token; nothing at the end."""
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    @property
    def kind(self) -> str:
        return self.tokens[self.at].kind if self.at < len(self.tokens) else ""

    def take(self, *texts: str) -> str | None:
        """The next token if it is one of these."""
        if self.kind in ("name", "symbol") and self.text in texts:
            self.at += 1
            return self.tokens[self.at - 1].text
        return None

    def need(self, *texts: str) -> str:
        found = self.take(*texts)
        if found is None:
            raise self.error(f"expected {' or '.join(texts)}")
        return found

    def name(self) -> str:
        if self.kind != "name":
            raise self.error("expected a name")
        self.at += 1
        return self.tokens[self.at - 1].text

    def error(self, what: str) -> AmplError:
        return AmplError(f"{what}, found {self.text!r} in {self.statement[:90]!r}")

    # expressions

    def expression(self) -> Term:
        found = self._product()
        while sign := self.take("+", "-"):
            found = _binary(operator.add if sign == "+" else operator.sub, found, self._product())
        return found

    def _product(self) -> Term:
        found = self._signed()
        while sign := self.take("*", "/"):
            found = _binary(operator.mul if sign == "*" else operator.truediv, found, self._signed())
        return found

    def _signed(self) -> Term:
        if self.take("-"):
            inner = self._signed()
            return lambda d: -inner(d)
        if self.take("+"):
            return self._signed()
        base = self._primary()
        if self.take("^", "**"):
            return _binary(operator.pow, base, self._signed())
        return base

    def _primary(self) -> Term:
        if self.kind == "number":
            number = float(self.text)
            self.at += 1
            return lambda _: number
        if self.kind == "string":
            text = self.text
            self.at += 1
            return lambda _: text
        if self.take("("):
            inner = self.expression()
            self.need(")")
            return inner
        if self.take("if"):
            return self._conditional()
        if self.text in ("sum", "prod"):
            return self._iterated(self.name())
        return self._named(self.name())

    def _conditional(self) -> Term:
        condition = self.condition()
        self.need("then")
        yes = self.expression()
        no: Term = self.expression() if self.take("else") else lambda _: 0.0
        return lambda d: yes(d) if condition(d) else no(d)

    def _iterated(self, what: str) -> Term:
        indexing, inner = self.indexing(), self._product()
        if what == "sum":
            return lambda d: sum((inner(each) for _, each in indexing.each(d)), 0.0)
        return lambda d: math.prod(inner(each) for _, each in indexing.each(d))

    def _named(self, name: str) -> Term:
        if self.text == "(":
            return self._call(name)
        keys = self.subscripts()
        names = self.names

        def value(d: Dummies) -> Any:
            if not keys and name in d:
                return d[name]
            return names.value(name, tuple(index_of(key(d)) for key in keys))

        return value

    def subscripts(self) -> list[Term]:
        if not self.take("["):
            return []
        keys = [self.expression()]
        while self.take(","):
            keys.append(self.expression())
        self.need("]")
        return keys

    def _call(self, name: str) -> Term:
        self.need("(")
        given = [self.expression()]
        while self.take(","):
            given.append(self.expression())
        self.need(")")
        if name in ("min", "max"):
            chosen = min if name == "min" else max
            return lambda d: chosen(each(d) for each in given)
        if name not in FUNCTIONS:
            raise self.error(f"function {name!r} is not read")
        return lambda d: _applied(name, given[0](d))

    # conditions

    def condition(self) -> Term:
        found = self._all_of()
        while self.take("or", "||"):
            found = _either(found, self._all_of())
        return found

    def _all_of(self) -> Term:
        found = self._relation()
        while self.take("and", "&&"):
            found = _both(found, self._relation())
        return found

    def _relation(self) -> Term:
        start = self.at
        if self.take("("):  # a condition, a tuple, or an expression
            try:
                inner = self.condition()
                self.need(")")
                if self.text not in RELATIONS and self.text not in ("+", "-", "*", "/", "^", "in"):
                    return inner
            except AmplError:
                pass
            self.at = start
        key = self._tuple()
        if self.take("in"):
            members = self.members()
            return lambda d: tuple(index_of(each(d)) for each in key) in members(d)
        relation = RELATIONS[self.need(*RELATIONS)]
        other = self.expression()
        return lambda d: relation(key[0](d), other(d))

    def _tuple(self) -> list[Term]:
        start = self.at
        if self.take("("):
            found = [self.expression()]
            while self.take(","):
                found.append(self.expression())
            self.need(")")
            if len(found) > 1:
                return found
            self.at = start
        return [self.expression()]

    # sets

    def members(self) -> SetTerm:
        found = self._crossed()
        while sign := self.take("diff", "union", "inter"):
            found = _joined(sign, found, self._crossed())
        return found

    def _crossed(self) -> SetTerm:
        found = self._set()
        while self.take("cross"):
            found = _product_of(found, self._set())
        return found

    def _set(self) -> SetTerm:
        if self.take("{"):
            return self._listed()
        start = self.at
        if self.take("("):
            try:
                inner = self.members()
                self.need(")")
                return inner
            except AmplError:
                self.at = start
        if self.kind == "name" and self._after() in ENDS_A_SET:
            name, names = self.name(), self.names
            return SetTerm(lambda _: names.members(name), lambda: names.size(name))
        low = self.expression()
        self.need("..")
        high = self.expression()
        return SetTerm(lambda d: {(k,): None for k in range(round(low(d)), round(high(d)) + 1)}, lambda: 1)

    def _after(self) -> str:
        """Text of the token after the next."""
        return self.tokens[self.at + 1].text if self.at + 1 < len(self.tokens) else ""

    def _listed(self) -> SetTerm:
        if self.take("}"):
            return SetTerm(lambda _: {}, lambda: 1)
        first = self.at
        parts: list[Term] = [self.expression()]
        if self.text == "..":
            self.at = first
            inner = self.members()
            self.need("}")
            return inner
        while self.take(","):
            parts.append(self.expression())
        self.need("}")
        return SetTerm(lambda d: {(index_of(part(d)),): None for part in parts}, lambda: 1)

    def indexing(self) -> Indexing:
        """In braces; an empty one where there are none."""
        if not self.take("{"):
            return Indexing()
        items = [self._item()]
        while self.take(","):
            items.append(self._item())
        condition = self.condition() if self.take(":") else None
        self.need("}")
        return Indexing(tuple(items), condition)

    def _item(self) -> tuple[tuple[str, ...] | None, SetTerm]:
        start = self.at
        pattern = self._pattern()
        if pattern is not None and self.take("in"):
            return pattern, self.members()
        self.at = start
        return None, self.members()

    def _pattern(self) -> tuple[str, ...] | None:
        if self.kind == "name":
            return (self.name(),)
        if not self.take("("):
            return None
        found = []
        while self.kind == "name":
            found.append(self.name())
            if not self.take(","):
                break
        return tuple(found) if self.take(")") else None


def _binary(do: Callable[[Any, Any], Any], a: Term, b: Term) -> Term:
    return lambda d: do(a(d), b(d))


def _both(a: Term, b: Term) -> Term:
    return lambda d: a(d) and b(d)


def _either(a: Term, b: Term) -> Term:
    return lambda d: a(d) or b(d)


def _applied(name: str, value: Any) -> Any:
    if isinstance(value, ca.SX):
        return getattr(ca, "fabs" if name == "abs" else name)(value)
    return abs(value) if name == "abs" else getattr(math, name)(value)


def _joined(how: str, a: SetTerm, b: SetTerm) -> SetTerm:
    def members(d: Dummies) -> Members:
        first, second = a(d), b(d)
        if how == "union":
            return first | second
        return {key: None for key in first if (key in second) == (how == "inter")}

    return SetTerm(members, a.size)


def _product_of(a: SetTerm, b: SetTerm) -> SetTerm:
    return SetTerm(lambda d: {_together(x, y): None for x in a(d) for y in b(d)}, lambda: a.size() + b.size())


def _together(a: Key, b: Key) -> Key:
    return (*a, *b)
