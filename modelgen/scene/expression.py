"""The language of expressions: numbers, names, + - * / **, and a short list of functions.

The text is data. Python's parser only cuts it into a syntax tree; the tree is walked here, node by node,
and whatever is not listed is refused. Nothing is compiled, looked up or called in Python's name space.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import e as euler
from math import isfinite, pi

from modelgen.errors import ExpressionError
from modelgen.name_suggestions import nearest
from modelgen.scene.decimal_comma import DECIMAL_COMMA, with_point
from modelgen.scene.expression_functions import BINARY, FUNCTIONS, evaluate_binary, evaluate_call

MAX_LENGTH = 20_000  # characters
MAX_DEPTH = 150  # nested operations
LONGEST_SUM = 32  # terms of a sum that is added up from left to right
MAX_NUMBER = 1e30
MAX_EXPONENT = 64.0  # of a constant exponent
CONSTANTS: dict[str, float] = {"pi": pi, "e": euler}
LANGUAGE = "allowed are numbers, names, + - * / **, parentheses and " + " ".join(FUNCTIONS)
CONDITIONS = "there are no comparisons and conditions: use max, min, abs or sign"
UNITS = "write the number without its unit: lengths are in m, times in s, masses in kg, angles in rad"
NUMBER_WITH_UNIT = re.compile(r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([A-Za-z°µ%][A-Za-z0-9_/*^²³.-]*)")
DEGREES = ("deg", "degs", "degree", "degrees", "°")

_FOREIGN = re.compile(r"[^A-Za-z0-9_+\-*/()., \t\r\n]")
FOREIGN_REMEDIES: Mapping[str, str] = {
    "^": "write ** for a power",
    **dict.fromkeys("<>=!?&|", CONDITIONS),
    **dict.fromkeys("[]{}", "group with (...)"),
    **dict.fromkeys("·×", "write * for a product"),
    "÷": "write / for a quotient",
    "−": "write - for a minus",
}
_OPERATORS: Mapping[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Number:
    value: float


@dataclass(frozen=True, slots=True)
class Name:
    id: str


@dataclass(frozen=True, slots=True)
class Unary:
    op: str  # "-"
    x: Node


@dataclass(frozen=True, slots=True)
class Binary:
    op: str  # + - * / **
    a: Node
    b: Node


@dataclass(frozen=True, slots=True)
class Call:
    fn: str
    args: tuple[Node, ...]


@dataclass(frozen=True, slots=True)
class Cubic:
    """A derivative of a piecewise cubic of x with continuous second derivatives, as no text has it.

    Between the parameters k_i and k_(i+1), with s the distance from k_i, the cubic is c0_i + c1_i s +
    (c3_i s + c2_i) s^2, where the names begin with the axis instead of c. It is evaluated as a sum over all
    pieces, each of s cut off at its ends: no piece depends on which of them x is in. Bounds over an interval
    need the pieces alone that it meets (core/base/taylor_models.c).
    """

    x: Node
    axis: str
    pieces: int
    order: int = 0  # of the derivative, up to 2

    def tree(self) -> Node:
        """The sum over all pieces."""
        axis, order = self.axis, self.order
        lead: Node = (Name(f"{axis}0_0"), Name(f"{axis}1_0"), _scaled(2, Name(f"{axis}2_0")))[order]
        return Binary("+", lead, _halves([self._piece(i) for i in range(self.pieces)]))

    def _piece(self, i: int) -> Node:
        """What a piece adds to the value at its start; the first and the last go on beyond the ends."""
        s: Node = Binary("-", self.x, Name(f"k_{i}"))
        if i > 0:
            s = Call("max", (s, Number(0.0)))
        if i < self.pieces - 1:
            s = Call("min", (s, Binary("-", Name(f"k_{i + 1}"), Name(f"k_{i}"))))
        slope, square, cube = (Name(f"{self.axis}{k}_{i}") for k in (1, 2, 3))
        if self.order == 2:
            return Binary("*", _scaled(6, cube), s)
        factors: tuple[Node, Node] = (square, cube)
        if self.order == 1:
            factors = _scaled(2, square), _scaled(3, cube)
        inner: Node = Binary("+", factors[0], Binary("*", factors[1], s))
        if self.order == 0:
            inner = Binary("+", slope, Binary("*", inner, s))
        return Binary("*", inner, s)

    def value(self, x: float, values: Mapping[str, float]) -> float:
        """The value of `tree` at x, operation by operation the same."""
        axis, last, order = self.axis, self.pieces - 1, self.order
        terms = []
        for i in range(self.pieces):
            s = x - values[f"k_{i}"]
            if i > 0:
                s = max(s, 0.0)
            if i < last:
                s = min(s, values[f"k_{i + 1}"] - values[f"k_{i}"])
            slope, square, cube = (values[f"{axis}{k}_{i}"] for k in (1, 2, 3))
            if order == 2:
                terms.append(6.0 * cube * s)
            elif order == 1:
                terms.append((2.0 * square + 3.0 * cube * s) * s)
            else:
                terms.append((slope + (square + cube * s) * s) * s)
        lead = (f"{axis}0_0", f"{axis}1_0", f"{axis}2_0")[order]
        return (2.0 * values[lead] if order == 2 else values[lead]) + _sum_in_halves(terms)

    def numbers(
        self,
        values: Iterable[float],
        slopes: Iterable[float],
        squares: Iterable[float],
        cubes: Iterable[float],
    ) -> dict[str, float]:
        """The parameters beside the knots: the coefficients by piece."""
        named: dict[str, float] = {}
        for k, column in enumerate((values, slopes, squares, cubes)):
            named |= {f"{self.axis}{k}_{i}": float(each) for i, each in enumerate(column)}
        return named

    def deviations(self, values: Mapping[str, float]) -> dict[str, float]:
        """Parameters that bounds over many pieces need: by how much the cubic, its slope and its
        second derivative leave their chords at most over blocks of 2, 4, 8, ... pieces. A chord leaves those
        of the halves of a block the most at the knot between them."""
        n, axis = self.pieces, self.axis
        knots = [values[f"k_{i}"] for i in range(n + 1)]
        named: dict[str, float] = {}
        for order in range(3):
            at_order = replace(self, order=order)
            at = [at_order._local(i, 0.0, values) for i in range(n)]
            at.append(at_order._local(n - 1, knots[n] - knots[n - 1], values))
            off = [at_order._off_chord(i, knots[i + 1] - knots[i], values) for i in range(n)]
            found, size = [], 2
            while len(off) > 1:
                off = [max(off[i : i + 2]) for i in range(0, len(off), 2)]
                for j in range(n // size):
                    a, middle, b = j * size, j * size + size // 2, j * size + size
                    share = (knots[middle] - knots[a]) / (knots[b] - knots[a])
                    off[j] += abs(at[middle] - at[a] - share * (at[b] - at[a]))
                found += off[: n // size]
                size *= 2
            named |= {f"{axis}{4 + order}_{i}": each for i, each in enumerate(found)}
        return named

    def _local(self, i: int, s: float, values: Mapping[str, float]) -> float:
        """The value of a piece at a distance s from its knot."""
        value, slope, square, cube = (values[f"{self.axis}{k}_{i}"] for k in range(4))
        return (
            value + (slope + (square + cube * s) * s) * s,
            slope + (2 * square + 3 * cube * s) * s,
            2 * square + 6 * cube * s,
        )[self.order]

    def _off_chord(self, i: int, width: float, values: Mapping[str, float]) -> float:
        """Bound of the distance of a piece from its chord, by its greatest second derivative."""
        square, cube = values[f"{self.axis}2_{i}"], values[f"{self.axis}3_{i}"]
        bend = max(abs(2 * square), abs(2 * square + 6 * cube * width)), abs(6 * cube), 0.0
        return bend[self.order] * width * width / 8


def _scaled(factor: int, x: Node) -> Node:
    return Binary("*", Number(float(factor)), x)


def _halves(terms: Sequence[Node]) -> Node:
    """The terms added up in halves, so that the tree is not deep."""
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return Binary("+", _halves(terms[:half]), _halves(terms[half:]))


def _sum_in_halves(terms: Sequence[float]) -> float:
    """The sum in the order of `_halves`."""
    if len(terms) == 1:
        return terms[0]
    half = len(terms) // 2
    return _sum_in_halves(terms[:half]) + _sum_in_halves(terms[half:])


Node = Number | Name | Unary | Binary | Call | Cubic


def number(value: float) -> Node:
    """A number of either sign."""
    return Unary("-", Number(-value)) if value < 0 else Number(value)


Valued = tuple[Node, float | None]  # a node and, where it has no names, its value


@dataclass(frozen=True, slots=True)
class Expression:
    """A parsed expression: `text` as written, `tree` of frozen nodes, `names` that occur in it.

    `constants` are the names for whose numbers stand in the tree.
    """

    text: str
    tree: Node = field(hash=False)
    names: frozenset[str] = field(hash=False)
    constants: frozenset[str] = field(default=frozenset(), compare=False)


def parse_expression(
    text: str, names: Collection[str], constants: Mapping[str, float] | None = None
) -> Expression:
    """Parse `text` over the allowed `names` and the numbers that `constants` name beside pi and e.

    Raises ExpressionError with position, found, allowed, remedy.
    """
    _check_characters(text)
    _check_decimal_comma(text)
    flat = re.sub(r"\s", " ", text)
    indent = len(flat) - len(flat.lstrip())
    try:
        tree = _syntax(flat.strip())
    except SyntaxError as error:
        column = error.offset - 1 if error.offset else len(flat.strip())  # no offset: the end came too early
        found, remedy = _what_is_wrong(flat.strip(), frozenset(names))
        raise _error(text, found, column + indent, remedy=remedy) from None
    except (RecursionError, MemoryError, ValueError):
        raise _error(text, "it is nested too deeply", None) from None
    walker = _Walker(text, frozenset(names), CONSTANTS | dict(constants or {}), indent)
    node, _ = walker.visit(tree, 1)
    return Expression(text, node, frozenset(walker.used), frozenset(walker.replaced))


@lru_cache(maxsize=1024)
def _syntax(text: str) -> ast.expr:
    """Python's syntax tree of a text, which nothing changes."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return ast.parse(text, mode="eval").body


def _what_is_wrong(text: str, names: Collection[str]) -> tuple[str, str]:
    """What was found in a text that is no expression, and the remedy."""
    product = re.search(r"([0-9.]+)\s*\(|([0-9.]+)\s*([A-Za-z_][A-Za-z0-9_]*)", text)
    if product and (product[3] is None or product[3] in {*names, *CONSTANTS, *FUNCTIONS}):
        factors = f"{product[1]}*(...)" if product[3] is None else f"{product[2]}*{product[3]}"
        return "a product without its sign", f"write {factors}"
    unit = NUMBER_WITH_UNIT.fullmatch(text)
    if unit:
        return f"a number with the unit {unit[2]!r}", _without_unit(unit)
    if text.count("(") != text.count(")"):
        missing = ")" if text.count("(") > text.count(")") else "("
        return f"a bracket without its {missing!r}", f"add {missing}"
    if re.search(r"\b(if|else|and|or|not)\b", text):
        return "a condition", CONDITIONS
    return "it is not an expression", ""


def _without_unit(unit: re.Match[str]) -> str:
    return f'write "{unit[1]}*pi/180"' if unit[2].lower() in DEGREES else UNITS


def constant_expression(value: float) -> Expression:
    """The expression that is one number."""
    return Expression(repr(value), Number(value), frozenset())


def evaluate(expression: Expression, values: Mapping[str, float]) -> float:
    """Value of the expression in double precision; raises ExpressionError where it has no finite one."""
    missing = sorted(expression.names - values.keys())
    if missing:
        raise ExpressionError(repr(expression.text), f"no value for {missing[0]!r}")
    try:
        value = _value(expression.tree, values)
    except (ValueError, ZeroDivisionError, OverflowError):
        value = float("nan")
    if not isfinite(value):
        raise ExpressionError(repr(expression.text), "it has no finite value here")
    return value


def _value(node: Node, values: Mapping[str, float]) -> float:
    match node:
        case Number(value):
            return value
        case Name(name):
            return float(values[name])
        case Unary(_, x):
            return -_value(x, values)
        case Binary(op, a, b):
            return evaluate_binary(op, _value(a, values), _value(b, values))
        case Call(fn, args):
            return evaluate_call(fn, tuple(_value(arg, values) for arg in args))
        case Cubic(x):
            return node.value(_value(x, values), values)


def _check_characters(text: str) -> None:
    if not text.strip():
        raise _error(text, "it is empty", 0)
    if len(text) > MAX_LENGTH:
        raise _error(text, f"it has {len(text)} characters", None, f"at most {MAX_LENGTH} are allowed")
    foreign = _FOREIGN.search(text)
    unit = NUMBER_WITH_UNIT.fullmatch(text.strip())
    if foreign and unit:
        raise _error(text, f"a number with the unit {unit[2]!r}", 0, LANGUAGE, _without_unit(unit))
    if foreign:
        remedy = FOREIGN_REMEDIES.get(foreign.group(), "")
        raise _error(text, f"the character {foreign.group()!r}", foreign.start(), LANGUAGE, remedy)


def _check_decimal_comma(text: str) -> None:
    if DECIMAL_COMMA.fullmatch(text.strip()):
        found, remedy = with_point(text.strip())
        raise _error(text, found, text.index(","), LANGUAGE, remedy)


def _error(
    text: str, found: str, position: int | None, allowed: str = LANGUAGE, remedy: str = ""
) -> ExpressionError:
    shown = text if len(text) <= 60 else text[:57] + "..."
    place = "" if position is None else f" at column {position + 1}"
    return ExpressionError(f"{shown!r}{place}", found, allowed, remedy, position)


def _terms(node: ast.expr) -> list[tuple[int, ast.expr]]:
    """The terms of a sum written without parentheses, each with its sign."""
    terms: list[tuple[int, ast.expr]] = []
    while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        terms.append((1 if isinstance(node.op, ast.Add) else -1, node.right))
        node = node.left
    return [(1, node), *reversed(terms)]


class _Walker:
    """Walks Python's syntax tree by a table of node types and builds our own."""

    def __init__(self, text: str, names: frozenset[str], constants: Mapping[str, float], indent: int) -> None:
        self.text = text
        self.names = names
        self.constants = constants
        self.indent = indent
        self.used: set[str] = set()
        self.replaced: set[str] = set()

    def visit(self, node: ast.expr, depth: int) -> Valued:
        if depth > MAX_DEPTH:
            raise self.error(node, "it is nested too deeply", f"at most {MAX_DEPTH} levels are allowed")
        match node:
            case ast.Constant():
                return self.number(node)
            case ast.Name():
                return self.name(node)
            case ast.UnaryOp(op=ast.UAdd()):
                return self.visit(node.operand, depth + 1)
            case ast.UnaryOp(op=ast.USub()):
                x, value = self.visit(node.operand, depth + 1)
                return Unary("-", x), None if value is None else -value
            case ast.BinOp():
                return self.binary(node, depth)
            case ast.Call():
                return self.call(node, depth)
        if isinstance(node, ast.IfExp | ast.Compare | ast.BoolOp):
            raise self.error(node, "a condition", remedy=CONDITIONS)
        kind = re.sub(r"(?<!^)(?=[A-Z])", " ", type(node).__name__).lower()
        raise self.error(node, f"Python's {kind!r} construct")

    def error(self, node: ast.expr, found: str, allowed: str = LANGUAGE, remedy: str = "") -> ExpressionError:
        return _error(self.text, found, node.col_offset + self.indent, allowed, remedy)

    def number(self, node: ast.Constant) -> Valued:
        value = node.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(node, f"{str(value)[:40]!r} is not a real number")
        if abs(value) > MAX_NUMBER:
            raise self.error(node, "a huge number", f"numbers up to {MAX_NUMBER:g} are allowed")
        return Number(float(value)), float(value)

    def name(self, node: ast.Name) -> Valued:
        if node.id in self.names:
            self.used.add(node.id)
            return Name(node.id), None
        if node.id in self.constants:
            value = self.constants[node.id]
            self.replaced.add(node.id)
            return number(value), value
        known = sorted(self.names) + [name for name in self.constants if name not in self.names]
        if node.id in FUNCTIONS:
            raise self.error(node, f"the function {node.id!r} without (...)")
        raise self.error(
            node, f"unknown name {node.id!r}", "known names: " + " ".join(known), nearest(node.id, known)
        )

    def binary(self, node: ast.BinOp, depth: int) -> Valued:
        terms = _terms(node)
        if len(terms) > LONGEST_SUM:
            return self.sum(node, [(sign, self.visit(term, depth + 1)) for sign, term in terms])
        op = _OPERATORS.get(type(node.op))
        if op is None:
            raise self.error(node, f"the operator {type(node.op).__name__!r}", f"allowed are {BINARY}")
        a, value_a = self.visit(node.left, depth + 1)
        b, value_b = self.visit(node.right, depth + 1)
        if op == "**" and value_b is not None and abs(value_b) > MAX_EXPONENT:
            raise self.error(
                node.right, f"the exponent {value_b:g}", f"exponents up to {MAX_EXPONENT:g} are allowed"
            )
        return self.joined(node, op, (a, value_a), (b, value_b))

    def joined(self, node: ast.BinOp, op: str, a: Valued, b: Valued) -> Valued:
        tree, left, right = Binary(op, a[0], b[0]), a[1], b[1]
        if left is None or right is None:
            return tree, None
        return tree, self.constant(node, lambda: evaluate_binary(op, left, right))

    def sum(self, node: ast.BinOp, terms: Sequence[tuple[int, Valued]]) -> Valued:
        """A long sum halved again and again, so that its tree is not deep; signs are those of the terms."""
        if len(terms) == 1:
            return terms[0][1]
        half = (len(terms) + 1) // 2
        flip = terms[half][0]
        left = self.sum(node, terms[:half])
        right = self.sum(node, [(sign * flip, term) for sign, term in terms[half:]])
        return self.joined(node, "+" if flip > 0 else "-", left, right)

    def call(self, node: ast.Call, depth: int) -> Valued:
        if not isinstance(node.func, ast.Name):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
            remedy = f"write {name}(...) without what stands before it" if name in FUNCTIONS else ""
            raise self.error(node, "a call of something that is not a function", remedy=remedy)
        name = node.func.id
        if name not in FUNCTIONS:
            raise self.error(
                node, f"unknown function {name!r}", "functions: " + " ".join(FUNCTIONS),
                nearest(name, FUNCTIONS) or ("write * for a product" if name in self.names else ""),
            )  # fmt: skip
        if node.keywords:
            raise self.error(node, f"a named argument of {name!r}")
        arity = FUNCTIONS[name].arity
        if len(node.args) != arity:
            raise self.error(node, f"{name!r} with {len(node.args)} arguments", f"it takes {arity}")
        pairs = [self.visit(arg, depth + 1) for arg in node.args]
        tree = Call(name, tuple(pair[0] for pair in pairs))
        values = tuple(pair[1] for pair in pairs if pair[1] is not None)
        if len(values) < arity:
            return tree, None
        return tree, self.constant(node, lambda: evaluate_call(name, values))

    def constant(self, node: ast.expr, compute: Callable[[], float]) -> float:
        """The value of a part without names: finite and not huge, so that no later stage meets inf or NaN."""
        try:
            value = compute()
        except (ValueError, ZeroDivisionError, OverflowError):
            value = float("nan")
        if not abs(value) <= MAX_NUMBER:
            raise self.error(
                node, "a constant part without a finite value", f"values up to {MAX_NUMBER:g} are allowed"
            )
        return value
