"""Translation of expressions of the scene to CasADi."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import casadi as ca

from modelgen.errors import ExpressionError
from modelgen.geometry.expression_branches import Branches
from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Number, Unary

_BINARY: Mapping[str, Callable[[ca.SX, ca.SX], ca.SX]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "**": lambda a, b: a**b,
}

_FUNCTIONS: dict[str, Callable[..., ca.SX]] = {
    "sin": ca.sin,
    "cos": ca.cos,
    "tan": ca.tan,
    "asin": ca.asin,
    "acos": ca.acos,
    "atan": ca.atan,
    "atan2": ca.atan2,
    "sinh": ca.sinh,
    "cosh": ca.cosh,
    "tanh": ca.tanh,
    "exp": ca.exp,
    "log": ca.log,
    "sqrt": ca.sqrt,
    "abs": ca.fabs,
    "sign": ca.sign,
    "min": ca.fmin,
    "max": ca.fmax,
}


def lower(
    expression: Expression, symbols: Mapping[str, ca.SX], branches: Branches | None = None
) -> ca.SX:
    """The scalar SX of `expression`, each name its symbol; ExpressionError for a name without one.

    `branches`: those on which calls of functions that are not smooth are taken; they are added to it.
    """
    missing = sorted(expression.names - symbols.keys())
    if missing:
        raise ExpressionError(repr(expression.text), f"no symbol for {missing[0]!r}")
    return _lower(expression.tree, symbols, _FUNCTIONS | (branches.calls() if branches else {}))


def _lower(node: Node, symbols: Mapping[str, ca.SX], functions: Mapping[str, Callable[..., ca.SX]]) -> ca.SX:
    match node:
        case Number(value):
            return ca.SX(value)
        case Name(name):
            return symbols[name]
        case Unary(_, x):
            return -_lower(x, symbols, functions)
        case Binary(op, a, b):
            return _BINARY[op](_lower(a, symbols, functions), _lower(b, symbols, functions))
        case Call(fn, args):
            return functions[fn](*(_lower(arg, symbols, functions) for arg in args))
        case Cubic():
            return _lower(node.tree(), symbols, _FUNCTIONS)
