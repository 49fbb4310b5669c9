"""Truncated power series of expressions: Taylor coefficients of any order, many expansion points at once.

A series is an array (order + 1, points) of coefficients a_0, a_1, ... in powers of s. The recurrences follow
from the differential equation of each function (Griewank and Walther, Evaluating Derivatives, 2008, ch. 13).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from modelgen.errors import ExpressionError
from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Number, Unary

Array = np.ndarray[Any, np.dtype[np.float64]]


def taylor(expression: Expression, values: Mapping[str, Array]) -> Array:
    """The series of the expression, each name a series; raises ExpressionError where it has none."""
    with np.errstate(all="ignore"):
        series = _series(expression.tree, values)
    if not np.isfinite(series).all():
        raise ExpressionError(repr(expression.text), "it has no power series here")
    return series


def _series(node: Node, values: Mapping[str, Array]) -> Array:
    match node:
        case Number(value):
            return _constant(value, next(iter(values.values())))
        case Name(name):
            return values[name]
        case Unary(_, x):
            return -_series(x, values)
        case Binary(op, a, b):
            if op == "**":
                return _power(_series(a, values), b, values)
            return _BINARY[op](_series(a, values), _series(b, values))
        case Call(fn, args):
            return _FUNCTIONS[fn](*(_series(arg, values) for arg in args))
        case Cubic():
            return _series(node.tree(), values)


def _constant(value: float, like: Array) -> Array:
    series = np.zeros_like(like)
    series[0] = value
    return series


def _times(a: Array, b: Array) -> Array:
    product = np.zeros_like(a)
    for k in range(len(a)):
        product[k] = np.sum(a[: k + 1] * b[k::-1], axis=0)
    return product


def _over(a: Array, b: Array) -> Array:
    quotient = np.zeros_like(a)
    for k in range(len(a)):
        quotient[k] = (a[k] - np.sum(quotient[:k] * b[k:0:-1], axis=0)) / b[0]
    return quotient


def _slope(a: Array) -> Array:
    """The derivative of a series, its last coefficient unknown and zero."""
    slope = np.zeros_like(a)
    slope[:-1] = a[1:] * np.arange(1, len(a))[:, None]
    return slope


def _primitive(start: Array, slope: Array) -> Array:
    series = np.zeros_like(slope)
    series[0] = start
    series[1:] = slope[:-1] / np.arange(1, len(slope))[:, None]
    return series


def _exp(a: Array) -> Array:
    slope, series = _slope(a), np.zeros_like(a)
    series[0] = np.exp(a[0])
    for k in range(1, len(a)):
        series[k] = np.sum(slope[:k] * series[k - 1 :: -1], axis=0) / k
    return series


def _log(a: Array) -> Array:
    return _primitive(np.log(a[0]), _over(_slope(a), a))


def _pair(a: Array, first: Array, second: Array, sign: float) -> tuple[Array, Array]:
    """f and g with f' = g a' and g' = sign f a'."""
    slope, f, g = _slope(a), np.zeros_like(a), np.zeros_like(a)
    f[0], g[0] = first, second
    for k in range(1, len(a)):
        f[k] = np.sum(slope[:k] * g[k - 1 :: -1], axis=0) / k
        g[k] = sign * np.sum(slope[:k] * f[k - 1 :: -1], axis=0) / k
    return f, g


def _sin_cos(a: Array) -> tuple[Array, Array]:
    return _pair(a, np.sin(a[0]), np.cos(a[0]), -1.0)


def _sinh_cosh(a: Array) -> tuple[Array, Array]:
    return _pair(a, np.sinh(a[0]), np.cosh(a[0]), 1.0)


def _real_power(a: Array, exponent: float) -> Array:
    """a**exponent with a_0 > 0, from a (a**r)' = r a' a**r; a constant zero stays zero."""
    series = np.zeros_like(a)
    series[0] = np.where(a[0] > 0, a[0], np.nan) ** exponent
    weights = np.arange(len(a))[:, None]
    for k in range(1, len(a)):
        terms = (
            (exponent * weights[1 : k + 1] - weights[k - 1 :: -1][:k])
            * a[1 : k + 1]
            * series[k - 1 :: -1][:k]
        )
        series[k] = np.sum(terms, axis=0) / (k * a[0])
    return series


def _whole_power(a: Array, exponent: int) -> Array:
    if exponent < 0:
        return _over(_constant(1.0, a), _whole_power(a, -exponent))
    power = _constant(1.0, a)
    for _ in range(exponent):
        power = _times(power, a)
    return power


def _power(a: Array, exponent: Node, values: Mapping[str, Array]) -> Array:
    """a**b: by products where b is a whole constant, by its own recurrence where b is constant."""
    b = _series(exponent, values)
    if b[1:].any() or np.ptp(b[0]) > 0:
        return _exp(_times(b, _log(a)))
    constant = float(b[0, 0])
    if constant.is_integer() and abs(constant) <= 64:
        return _whole_power(a, int(constant))
    return _real_power(a, constant)


def _sqrt(a: Array) -> Array:
    return _real_power(a, 0.5)


def _asin(a: Array) -> Array:
    return _primitive(np.arcsin(a[0]), _over(_slope(a), _sqrt(_constant(1.0, a) - _times(a, a))))


def _acos(a: Array) -> Array:
    arc = -_asin(a)
    arc[0] = np.arccos(a[0])
    return arc


def _atan2(y: Array, x: Array) -> Array:
    turn = _times(x, _slope(y)) - _times(y, _slope(x))
    return _primitive(np.arctan2(y[0], x[0]), _over(turn, _times(x, x) + _times(y, y)))


def _sign(a: Array) -> Array:
    """Defined where a_0 is not zero, there with all its derivatives."""
    series = np.zeros_like(a)
    series[0] = np.where(a[0] == 0, np.where(np.abs(a).max(axis=0) == 0, 0.0, np.nan), np.sign(a[0]))
    return series


def _chosen(first: Array, a: Array, b: Array) -> Array:
    """a where `first` is positive, b where it is negative, neither where they touch without being equal."""
    equal = np.abs(a - b).max(axis=0) == 0
    chosen = np.where(first[0] > 0, a, np.where(first[0] < 0, b, np.nan))
    return np.where(equal, a, chosen)


_BINARY: Mapping[str, Callable[[Array, Array], Array]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": _times,
    "/": _over,
}

_FUNCTIONS: Mapping[str, Callable[..., Array]] = {
    "sin": lambda a: _sin_cos(a)[0],
    "cos": lambda a: _sin_cos(a)[1],
    "tan": lambda a: _over(*_sin_cos(a)),
    "asin": _asin,
    "acos": _acos,
    "atan": lambda a: _atan2(a, _constant(1.0, a)),
    "atan2": _atan2,
    "sinh": lambda a: _sinh_cosh(a)[0],
    "cosh": lambda a: _sinh_cosh(a)[1],
    "tanh": lambda a: _over(*_sinh_cosh(a)),
    "exp": _exp,
    "log": _log,
    "sqrt": _sqrt,
    "abs": lambda a: _times(a, _sign(a)),
    "sign": _sign,
    "min": lambda a, b: _chosen(b - a, a, b),
    "max": lambda a, b: _chosen(a - b, a, b),
}
