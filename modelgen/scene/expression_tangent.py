"""Values of expressions with their derivatives along a change of names, by the chain rule."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, cosh, exp, hypot, log, sin, sinh, sqrt, tan, tanh
from sys import float_info

from modelgen.errors import ExpressionError
from modelgen.scene.expression import Binary, Call, Expression, Name, Node, Number, Unary
from modelgen.scene.expression_functions import evaluate_binary, evaluate_call

ROUNDING = 8 * float_info.epsilon  # of the sizes of its parts: what a difference may be and count as zero


@dataclass(frozen=True, slots=True)
class Tangent:
    """The value of an expression and its derivative.

    `size` is the sum of the sizes of what the value is added up from, of which its rounding is a part. On a
    kink, or at a jump or the end of a domain, the derivative is none, or that of one side.
    """

    value: float
    rate: float
    size: float
    is_kink: bool = False


def tangent(expression: Expression, values: Mapping[str, float], rates: Mapping[str, float]) -> Tangent:
    """The value with its derivative where names have these values and derivatives, 0 for those without one.

    Raises ExpressionError where it has no finite value or derivative.
    """
    try:
        return _tangent(expression.tree, values, rates)
    except (ValueError, ZeroDivisionError, OverflowError):
        raise ExpressionError(repr(expression.text), "it has no finite derivative here") from None


def _tangent(node: Node, values: Mapping[str, float], rates: Mapping[str, float]) -> Tangent:
    match node:
        case Number(value):
            return Tangent(value, 0.0, abs(value))
        case Name(name):
            return Tangent(values[name], rates.get(name, 0.0), abs(values[name]))
        case Unary(_, x):
            of = _tangent(x, values, rates)
            return Tangent(-of.value, -of.rate, of.size, of.is_kink)
        case Binary(op, a, b):
            return _binary(op, _tangent(a, values, rates), _tangent(b, values, rates))
        case Call(fn, args):
            return _call(fn, tuple(_tangent(each, values, rates) for each in args))
    raise ValueError(f"{type(node).__name__} has no derivative")


def _binary(op: str, a: Tangent, b: Tangent) -> Tangent:
    value, is_kink = evaluate_binary(op, a.value, b.value), a.is_kink or b.is_kink
    if op in "+-":
        return Tangent(value, a.rate + (b.rate if op == "+" else -b.rate), a.size + b.size, is_kink)
    if op == "**":
        is_kink |= _is_zero(a) and a.rate != 0 and not (b.value >= 1 and b.rate == 0)
        by_a = b.value * evaluate_binary("**", a.value, b.value - 1) if a.rate and not is_kink else 0.0
        by_b = log(a.value) * value if b.rate and a.value > 0 else 0.0
        is_kink |= b.rate != 0 and not a.value > 0
    elif op == "*":
        by_a, by_b = b.value, a.value
    else:
        by_a, by_b = 1 / b.value, -value / b.value
    return _chained(value, ((by_a, a), (by_b, b)), is_kink)


def _chained(value: float, parts: tuple[tuple[float, Tangent], ...], is_kink: bool) -> Tangent:
    rate = sum(by * of.rate for by, of in parts if of.rate)
    return Tangent(value, rate, abs(value) + sum(abs(by) * of.size for by, of in parts), is_kink)


def _call(name: str, args: tuple[Tangent, ...]) -> Tangent:
    numbers = tuple(each.value for each in args)
    value, is_kink = evaluate_call(name, numbers), any(each.is_kink for each in args)
    if name in ("min", "max"):
        a, b = args
        taken, other = (a, b) if value == a.value else (b, a)
        at_both = abs(a.value - b.value) <= ROUNDING * (a.size + b.size) and a.rate != b.rate
        return Tangent(value, taken.rate, max(taken.size, other.size if at_both else 0), is_kink or at_both)
    if name == "atan2":
        y, x = args
        square = hypot(*numbers) ** 2
        jumps = _is_zero(y) and (x.value <= 0 or _is_zero(x)) and bool(y.rate or (_is_zero(x) and x.rate))
        parts = ((x.value / square, y), (-y.value / square, x)) if square else ()
        return _chained(value, parts, is_kink or jumps)
    (x,) = args
    if name in ("abs", "sign"):
        side = evaluate_call("sign", numbers) if name == "abs" else 0.0
        return _chained(value, ((side, x),), is_kink or (_is_zero(x) and x.rate != 0))
    ends = {"sqrt": x.value == 0, "asin": abs(x.value) == 1, "acos": abs(x.value) == 1}
    if ends.get(name):
        return Tangent(value, 0.0, abs(value), is_kink or x.rate != 0)
    return _chained(value, ((_DERIVATIVES[name](x.value), x),), is_kink)


def _is_zero(x: Tangent) -> bool:
    return abs(x.value) <= ROUNDING * x.size


_DERIVATIVES: Mapping[str, Callable[[float], float]] = {
    "sin": cos,
    "cos": lambda x: -sin(x),
    "tan": lambda x: 1 + tan(x) ** 2,
    "asin": lambda x: 1 / sqrt((1 - x) * (1 + x)),
    "acos": lambda x: -1 / sqrt((1 - x) * (1 + x)),
    "atan": lambda x: 1 / (1 + x * x),
    "sinh": cosh,
    "cosh": sinh,
    "tanh": lambda x: 1 - tanh(x) ** 2,
    "exp": exp,
    "log": lambda x: 1 / x,
    "sqrt": lambda x: 1 / (2 * sqrt(x)),
}
