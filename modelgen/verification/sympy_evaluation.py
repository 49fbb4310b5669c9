"""The value of a sympy expression at given numbers, by walking it: nothing is compiled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import sympy as sp

_FUNCTIONS: Mapping[Any, Callable[..., float]] = {
    sp.sin: math.sin, sp.cos: math.cos, sp.tan: math.tan, sp.asin: math.asin, sp.acos: math.acos,
    sp.atan: math.atan, sp.atan2: math.atan2, sp.sinh: math.sinh, sp.cosh: math.cosh, sp.tanh: math.tanh,
    sp.asinh: math.asinh, sp.acosh: math.acosh, sp.atanh: math.atanh, sp.exp: math.exp, sp.log: math.log,
    sp.Abs: abs, sp.sign: lambda x: math.copysign(1.0, x) if x else 0.0, sp.floor: math.floor,
    sp.ceiling: math.ceil, sp.Min: min, sp.Max: max, sp.Add: lambda *a: math.fsum(a),
    sp.Mul: lambda *a: math.prod(a), sp.Pow: lambda a, b: a**b,
}  # fmt: skip
_NAMED: Mapping[str, Callable[..., float]] = {
    "fmod": math.fmod, "copysign": math.copysign, "lt": lambda a, b: float(a < b),
    "le": lambda a, b: float(a <= b), "eq": lambda a, b: float(a == b), "ne": lambda a, b: float(a != b),
    "not": lambda a: float(not a), "and": lambda a, b: float(bool(a) and bool(b)),
    "or": lambda a, b: float(bool(a) or bool(b)),
}  # fmt: skip


def value_of(expression: sp.Basic, known: Mapping[Any, float]) -> float:
    """NaN where it has no finite value; KeyError for a symbol that is not known."""
    if expression.is_Symbol:
        return float(known[expression])
    if expression.is_Number or expression.is_NumberSymbol:
        return float(expression)
    arguments = [value_of(argument, known) for argument in expression.args]
    named = getattr(expression.func, "__name__", "")
    function = _FUNCTIONS.get(expression.func) or _NAMED[named]
    try:
        value = function(*arguments)
    except (ValueError, ZeroDivisionError, OverflowError):
        return math.nan
    return float(value) if isinstance(value, int | float) else math.nan
