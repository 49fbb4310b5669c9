"""Values of expressions with their derivatives along a change of names, by the chain rule.

On a kink, as that of abs(x) at zero, the derivative is the one-sided one along the change: the limit of the
quotient as the change goes to zero from above. The chain rule holds for these as well.
"""

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
    kink, the derivative holds for the change alone, not for the opposite one; at a jump or the end of a
    domain (`is_lost`) it is none.
    """

    value: float
    rate: float
    size: float
    is_kink: bool = False
    is_lost: bool = False  # on a kink without a derivative on either side


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
            return Tangent(-of.value, -of.rate, of.size, of.is_kink, of.is_lost)
        case Binary(op, a, b):
            return _binary(op, _tangent(a, values, rates), _tangent(b, values, rates))
        case Call(fn, args):
            return _call(fn, tuple(_tangent(each, values, rates) for each in args))
    raise ValueError(f"{type(node).__name__} has no derivative")


def _binary(op: str, a: Tangent, b: Tangent) -> Tangent:
    value = evaluate_binary(op, a.value, b.value)
    if op in "+-":
        rate = a.rate + (b.rate if op == "+" else -b.rate)
        return Tangent(value, rate, a.size + b.size, *_told((a, b)))
    ends = False
    if op == "**":
        ends = _is_zero(a) and a.rate != 0 and not (b.value >= 1 and b.rate == 0)
        by_a = b.value * evaluate_binary("**", a.value, b.value - 1) if a.rate and not ends else 0.0
        by_b = log(a.value) * value if b.rate and a.value > 0 else 0.0
        ends |= b.rate != 0 and not a.value > 0
    elif op == "*":
        by_a, by_b = b.value, a.value
    else:
        by_a, by_b = 1 / b.value, -value / b.value
    return _chained(value, ((by_a, a), (by_b, b)), ends)


def _told(args: tuple[Tangent, ...], is_kink: bool = False, is_lost: bool = False) -> tuple[bool, bool]:
    """`is_kink` and `is_lost` of what follows from others."""
    lost = is_lost or any(each.is_lost for each in args)
    return lost or is_kink or any(each.is_kink for each in args), lost


def _chained(value: float, parts: tuple[tuple[float, Tangent], ...], is_lost: bool = False) -> Tangent:
    rate = sum(by * of.rate for by, of in parts if of.rate)
    size = abs(value) + sum(abs(by) * of.size for by, of in parts)
    return Tangent(value, rate, size, *_told(tuple(of for _, of in parts), is_lost=is_lost))


def _call(name: str, args: tuple[Tangent, ...]) -> Tangent:
    numbers = tuple(each.value for each in args)
    value = evaluate_call(name, numbers)
    if name in ("min", "max"):
        a, b = args
        taken, other = (a, b) if value == a.value else (b, a)
        at_both = abs(a.value - b.value) <= ROUNDING * (a.size + b.size) and a.rate != b.rate
        rate = evaluate_call(name, (a.rate, b.rate)) if at_both else taken.rate
        return Tangent(value, rate, max(taken.size, other.size if at_both else 0), *_told(args, at_both))
    if name == "atan2":
        y, x = args
        square = hypot(*numbers) ** 2
        jumps = _is_zero(y) and (x.value <= 0 or _is_zero(x)) and bool(y.rate or (_is_zero(x) and x.rate))
        parts = ((x.value / square, y), (-y.value / square, x)) if square else ()
        return _chained(value, parts or ((0.0, y), (0.0, x)), jumps)
    (x,) = args
    at_zero = name in ("abs", "sign") and _is_zero(x) and x.rate != 0
    if name == "abs" and at_zero:
        return Tangent(value, abs(x.rate), abs(value) + x.size, *_told(args, True))
    if name in ("abs", "sign"):
        return _chained(value, ((evaluate_call("sign", numbers) if name == "abs" else 0.0, x),), at_zero)
    ends = {"sqrt": x.value == 0, "asin": abs(x.value) == 1, "acos": abs(x.value) == 1}
    if ends.get(name):
        return Tangent(value, 0.0, abs(value), *_told(args, is_lost=x.rate != 0))
    return _chained(value, ((_DERIVATIVES[name](x.value), x),))


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
