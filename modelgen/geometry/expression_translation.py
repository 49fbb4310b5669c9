"""Translation of expressions of the scene to CasADi."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca

from modelgen.errors import ExpressionError
from modelgen.geometry.expression_branches import Branches
from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Number, Unary
from modelgen.scene.expression_algebra import derivatives, expression_of, name_cubics

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


_ROOTS = ("sqrt", "log", "asin", "acos")  # have no value beyond the end of their domain
_Calls = Mapping[str, Callable[..., ca.SX]]


def lower(expression: Expression, symbols: Mapping[str, ca.SX], branches: Branches | None = None) -> ca.SX:
    """The scalar SX of `expression`, each name its symbol; ExpressionError for a name without one.

    `branches`: those on which calls of functions that are not smooth are taken; they are added to it. Within
    roots and logarithms, which a branch may not go on beyond its end, calls are taken as they are written, as
    they are where the expression is infinite at a zero of a function of time alone.
    """
    missing = sorted(expression.names - symbols.keys())
    if missing:
        raise ExpressionError(repr(expression.text), f"no symbol for {missing[0]!r}")
    if branches is None or _is_infinite_in_time(expression.tree):
        return _lower(expression.tree, symbols, _FUNCTIONS, _FUNCTIONS)
    written = _FUNCTIONS | {name: branches.watched(name, _FUNCTIONS[name]) for name in branches.calls()}
    return _lower(expression.tree, symbols, _FUNCTIONS | dict(branches.calls()), written)


def lowered_derivative(
    components: Sequence[Expression],
    order: str,
    symbols: Mapping[str, ca.SX],
    splines: Mapping[Cubic, str],
) -> ca.SX:
    """A derivative of components (n,), by the letters of `order`, whose piecewise cubics are symbols of the
    names that they have in `splines`, or are written out."""
    trees = (name_cubics(each.tree, splines) for each in derivatives(components, order))
    return ca.vertcat(*(lower(expression_of(tree), symbols) for tree in trees))


def _lower(node: Node, symbols: Mapping[str, ca.SX], functions: _Calls, written: _Calls) -> ca.SX:
    """`functions` are those of calls, `written` those of calls within roots."""
    match node:
        case Number(value):
            return ca.SX(value)
        case Name(name):
            return symbols[name]
        case Unary(_, x):
            return -_lower(x, symbols, functions, written)
        case Binary("**", a, b) if not _is_whole(b):
            of_base = written if _is_positive(b) else _FUNCTIONS
            return _BINARY["**"](_lower(a, symbols, of_base, of_base), _lower(b, symbols, functions, written))
        case Binary(op, a, b):
            return _BINARY[op](_lower(a, symbols, functions, written), _lower(b, symbols, functions, written))
        case Call(fn, args):
            of_arguments = written if fn in _ROOTS else functions
            return functions[fn](*(_lower(arg, symbols, of_arguments, written) for arg in args))
        case Cubic():
            return _lower(node.tree(), symbols, _FUNCTIONS, _FUNCTIONS)


def _is_infinite_in_time(node: Node) -> bool:
    """Whether it divides by abs, min, max or sign of functions of time alone, or by a power of them."""
    match node:
        case Binary("/", _, b) if _is_of_time_alone(b):
            return True
        case Binary("**", a, Unary()) if _is_of_time_alone(a):
            return True
    return any(map(_is_infinite_in_time, _parts(node)))


def _is_of_time_alone(node: Node) -> bool:
    match node:
        case Call(("abs" | "sign" | "min" | "max"), args):
            return set().union(*map(_names, args)) == {"t"}
        case Binary("**", a, _):
            return _is_of_time_alone(a)
        case Binary("*", a, b):
            return _is_of_time_alone(a) or _is_of_time_alone(b)
    return False


def _names(node: Node) -> set[str]:
    return {node.id} if isinstance(node, Name) else set().union(*map(_names, _parts(node)))


def _parts(node: Node) -> tuple[Node, ...]:
    match node:
        case Unary(_, x) | Cubic(x):
            return (x,)
        case Binary(_, a, b):
            return (a, b)
        case Call(_, args):
            return args
    return ()


def _is_whole(exponent: Node) -> bool:
    """Whether it is a whole number, of which a power goes on where its base is negative."""
    value = exponent.x if isinstance(exponent, Unary) else exponent
    return isinstance(value, Number) and value.value.is_integer()


def _is_positive(exponent: Node) -> bool:
    return isinstance(exponent, Number)
