"""Models in a part of AMPL, enough for MacMPEC, as programs with complementarity constraints of CasADi.

R. Fourer, D. M. Gay, B. W. Kernighan, AMPL: A Modeling Language for Mathematical Programming, 2003;
complementarity: M. C. Ferris, R. Fourer, D. M. Gay, SIAM J. Optim. 9 (1999), 991-1009.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from modelgen.optimal_control.complementarity_program import ComplementarityProgram
from tests.ampl.data import read_data
from tests.ampl.expressions import Parser
from tests.ampl.names import Dummies, Indexing, Names, Parameter, SetOf, Term, Variable, index_of
from tests.ampl.tokens import AmplError, statements

SUBJECT_TO = re.compile(r"(subject\s+to|s\s*\.\s*t\s*\.)(?=[\s:])\s*", re.I)
IGNORED = {"option", "solve", "display", "printf", "end", "problem"}


Action = Callable[[Dummies], Any]


@dataclass(frozen=True)
class Relation:
    """One to three expressions with relations between them."""

    terms: tuple[Term, ...]
    signs: tuple[str, ...]


@dataclass(frozen=True)
class Constraint:
    name: str
    indexing: Indexing
    sides: tuple[Relation, ...]  # two where they complement each other


@dataclass
class AmplProgram:
    """A program and its start.

    `sign` is -1 where the model is maximised: f is its objective times `sign`.
    """

    program: ComplementarityProgram[ca.SX]
    start: np.ndarray[Any, Any]
    sign: float
    names: list[str] = field(default_factory=list)


def read_program(*files: Path) -> AmplProgram:
    """The program of a model file and its files of data, in this order.

    Raises:
        AmplError: a statement is not of the part of the language that is read.
    """
    model = _Model()
    for number, file in enumerate(files):
        model.read(file.read_text(encoding="latin-1"), data=number > 0)
    return model.program()


class _Model:
    def __init__(self) -> None:
        self.names = Names()
        self.objectives: list[tuple[float, Term]] = []
        self.constraints: list[Constraint] = []
        self.later: list[Callable[[], None]] = []

    def read(self, text: str, data: bool) -> None:
        for statement in statements(text):
            if statement in ("data", "model"):
                data = statement == "data"
            elif data and statement.split(maxsplit=1)[0].rstrip(":") in ("set", "param"):
                read_data(statement, self.names)
                self.names.forget()
            else:
                self._statement(statement)

    def _statement(self, statement: str) -> None:
        parser = Parser(SUBJECT_TO.sub("", statement, count=1), self.names)
        first = parser.text
        if first in IGNORED:
            return
        known = {
            "set": self._set, "param": self._param, "var": self._var,
            "let": self._command, "fix": self._command, "for": self._command,
            "minimize": self._objective, "maximize": self._objective,
        }  # fmt: skip
        known.get(first, self._constraint)(parser)
        if parser.at < len(parser.tokens):
            raise parser.error("the statement should end")

    def _set(self, parser: Parser) -> None:
        parser.need("set")
        name, members, within = parser.name(), None, None
        while sign := parser.take(":=", "within", "in", ","):
            if sign == ":=":
                members = parser.members()
            elif sign != ",":
                within = parser.members()
        self.names.sets[name] = SetOf(members, within)

    def _param(self, parser: Parser) -> None:
        parser.need("param")
        name, indexing = parser.name(), parser.indexing()
        value, default = None, None
        while sign := parser.take(":=", "=", "default", "integer", "binary", ">=", "<=", ">", "<", ","):
            if sign in (":=", "="):
                value = parser.expression()
            elif sign == "default":
                default = parser.expression()
            elif sign in (">=", "<=", ">", "<"):
                parser.expression()
        self.names.parameters[name] = Parameter(indexing, value, default)

    def _var(self, parser: Parser) -> None:
        parser.need("var")
        name = parser.name()
        variable = Variable(parser.indexing(), [], [], None, None)
        while sign := parser.take(">=", "<=", ":=", "default", "=", ","):
            if sign == ">=":
                variable.lower.append(parser.expression())
            elif sign == "<=":
                variable.upper.append(parser.expression())
            elif sign in (":=", "default"):
                variable.start = parser.expression()
            elif sign == "=":
                variable.definition = parser.expression()
        self.names.variables[name] = variable

    def _command(self, parser: Parser) -> None:
        """Done at once where it gives data; kept until there are variables where it gives starts."""
        variables: list[bool] = []
        action = self._action(parser, variables)
        if any(variables):
            self.later.append(lambda: action({}))
        else:
            action({})

    def _action(self, parser: Parser, variables: list[bool]) -> Action:
        """`let`, `fix`, or one of these for each member of a set, or under a condition."""
        if parser.take("{"):
            inner = self._action(parser, variables)
            parser.need("}")
            return inner
        if parser.take("for"):
            indexing = parser.indexing()
            inner = self._action(parser, variables)
            return lambda d: [inner(found) for _, found in list(indexing.each(d))]
        if parser.take("if"):
            condition = parser.condition()
            parser.need("then")
            inner = self._action(parser, variables)
            return lambda d: inner(d) if condition(d) else None
        return self._assignment(parser, variables)

    def _assignment(self, parser: Parser, variables: list[bool]) -> Action:
        what = parser.need("let", "fix")
        indexing, name = parser.indexing(), parser.name()
        keys = parser.subscripts()
        parser.need(":=")
        variables.append(name in self.names.variables)
        names = self.names
        if name in names.sets:
            members = parser.members()

            def give_set(d: Dummies) -> None:
                names.given_sets[name] = members(d)
                names.forget()

            return give_set
        term = parser.expression()

        def give(d: Dummies) -> None:
            found = [(tuple(index_of(key(each)) for key in keys), term(each)) for _, each in indexing.each(d)]
            declared: Any = names.parameters.get(name) or names.variables[name]
            (declared.fixed if what == "fix" else declared.given).update(found)
            names.forget()

        return give

    def _objective(self, parser: Parser) -> None:
        sign = 1.0 if parser.need("minimize", "maximize") == "minimize" else -1.0
        parser.name()
        parser.need(":")
        self.objectives.append((sign, parser.expression()))

    def _constraint(self, parser: Parser) -> None:
        name, indexing = parser.name(), parser.indexing()
        parser.need(":")
        sides = [self._relation(parser)]
        if parser.take("complements"):
            sides.append(self._relation(parser))
        self.constraints.append(Constraint(name, indexing, tuple(sides)))

    def _relation(self, parser: Parser) -> Relation:
        terms, signs = [parser.expression()], []
        while sign := parser.take("<=", ">=", "=", "=="):
            signs.append("=" if sign == "==" else sign)
            terms.append(parser.expression())
        return Relation(tuple(terms), tuple(signs))

    def program(self) -> AmplProgram:
        """The first objective under all constraints."""
        self.names.create_symbols()
        for apply in self.later:
            apply()
        rows = _Rows()
        for constraint in self.constraints:
            for _, dummies in constraint.indexing.each({}):
                rows.add(constraint, dummies)
        symbols, low, high, start = self._variables()
        sign, objective = self.objectives[0]
        x = ca.vertcat(*symbols, *rows.added)
        extra = len(rows.added)
        program = ComplementarityProgram(
            x=x,
            f=ca.SX(sign * objective({})),
            g=ca.vertcat(ca.SX(0, 1), *rows.g),
            lbx=np.array(low + [0.0] * extra),
            ubx=np.array(high + [np.inf] * extra),
            lbg=np.array(rows.low),
            ubg=np.array(rows.high),
            first=ca.vertcat(ca.SX(0, 1), *rows.first),
            second=ca.vertcat(ca.SX(0, 1), *rows.second),
        )
        return AmplProgram(program, np.array(start + [0.0] * extra), sign, [str(each) for each in symbols])

    def _variables(self) -> tuple[list[ca.SX], list[float], list[float], list[float]]:
        symbols, low, high, start = [], [], [], []
        for variable in self.names.variables.values():
            for key, symbol in variable.symbols.items():
                dummies = variable.indexing.bound(key)
                fixed = variable.fixed.get(key)
                lower = [float(term(dummies)) for term in variable.lower]
                upper = [float(term(dummies)) for term in variable.upper]
                given = variable.given.get(key, variable.start(dummies) if variable.start else 0.0)
                symbols.append(symbol)
                low.append(max(lower, default=-np.inf) if fixed is None else fixed)
                high.append(min(upper, default=np.inf) if fixed is None else fixed)
                start.append(float(given if fixed is None else fixed))
        return symbols, low, high, start


class _Rows:
    """Constraints and pairs as columns of expressions."""

    def __init__(self) -> None:
        self.g: list[ca.SX] = []
        self.low: list[float] = []
        self.high: list[float] = []
        self.first: list[ca.SX] = []
        self.second: list[ca.SX] = []
        self.added: list[ca.SX] = []  # parts of what complements a value between two bounds

    def add(self, constraint: Constraint, dummies: Dummies) -> None:
        if len(constraint.sides) == 1:
            self._plain(constraint.sides[0], dummies)
            return
        slacks = [_slacks(side, dummies) for side in constraint.sides]
        counts = tuple(len(each) for each in slacks)
        free = [side.terms[0](dummies) for side in constraint.sides if not side.signs]
        if counts == (1, 1):
            self._pair(slacks[0][0], slacks[1][0])
        elif sorted(counts) == [0, 2] and free:
            low, high = max(slacks, key=len)
            up, down = (ca.SX.sym(f"part_{len(self.added)}_{k}") for k in range(2))
            self.added += [up, down]
            self._row(free[0] - up + down, 0.0, 0.0)
            self._pair(low, up)
            self._pair(high, down)
        elif free and any(side.signs == ("=",) for side in constraint.sides):
            self._plain(max(constraint.sides, key=lambda side: len(side.signs)), dummies)
        else:
            raise AmplError(f"what {constraint.name!r} complements")

    def _plain(self, relation: Relation, dummies: Dummies) -> None:
        if relation.signs == ("=",):
            self._row(relation.terms[0](dummies) - relation.terms[1](dummies), 0.0, 0.0)
            return
        for slack in _slacks(relation, dummies):
            self._row(slack, 0.0, np.inf)

    def _row(self, expression: Any, low: float, high: float) -> None:
        if isinstance(expression, ca.SX):
            self.g.append(expression)
            self.low.append(low)
            self.high.append(high)
        elif not low - 1e-9 <= expression <= high + 1e-9:
            raise AmplError("a constraint of numbers alone does not hold")

    def _pair(self, first: Any, second: Any) -> None:
        self.first.append(ca.SX(first))
        self.second.append(ca.SX(second))


def _slacks(relation: Relation, dummies: Dummies) -> list[Any]:
    """What is at least zero; nothing for an expression without a relation."""
    if "=" in relation.signs:
        return []
    values = [term(dummies) for term in relation.terms]
    return [
        b - a if sign == "<=" else a - b
        for sign, a, b in zip(relation.signs, values, values[1:], strict=False)
    ]
