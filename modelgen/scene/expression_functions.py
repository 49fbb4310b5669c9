"""Functions and operators of expressions, in double precision."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

BINARY = "+ - * / **"


@dataclass(frozen=True, slots=True)
class Function:
    arity: int
    value: Callable[..., float]


def _sign(x: float) -> float:
    return 0.0 if x == 0.0 else math.copysign(1.0, x)


FUNCTIONS: Mapping[str, Function] = {
    "sin": Function(1, math.sin),
    "cos": Function(1, math.cos),
    "tan": Function(1, math.tan),
    "asin": Function(1, math.asin),
    "acos": Function(1, math.acos),
    "atan": Function(1, math.atan),
    "atan2": Function(2, math.atan2),
    "sinh": Function(1, math.sinh),
    "cosh": Function(1, math.cosh),
    "tanh": Function(1, math.tanh),
    "exp": Function(1, math.exp),
    "log": Function(1, math.log),
    "sqrt": Function(1, math.sqrt),
    "abs": Function(1, math.fabs),
    "sign": Function(1, _sign),
    "min": Function(2, min),
    "max": Function(2, max),
}


def evaluate_call(name: str, args: tuple[float, ...]) -> float:
    return float(FUNCTIONS[name].value(*args))


def evaluate_binary(op: str, a: float, b: float) -> float:
    """`a op b` for op in + - * / **; raises ValueError, ZeroDivisionError or OverflowError as math does."""
    match op:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "/":
            return a / b
        case "**":
            return math.pow(a, b)
    raise ValueError(f"operator {op!r} is not one of {BINARY}")
