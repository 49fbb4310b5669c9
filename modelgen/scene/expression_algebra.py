"""Expressions made of expressions, tree by tree: names replaced, operations put on top. No text is parsed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Number, Unary

_LEVELS: Mapping[str, int] = {"+": 1, "-": 1, "*": 2, "/": 2, "**": 4}
_UNARY, _ATOM = 3, 5


def plus(a: Node, b: Node) -> Node:
    return Binary("+", a, b)


def minus(a: Node, b: Node) -> Node:
    return Binary("-", a, b)


def times(a: Node, b: Node) -> Node:
    return Binary("*", a, b)


def over(a: Node, b: Node) -> Node:
    return Binary("/", a, b)


def cos(x: Node) -> Node:
    return Call("cos", (x,))


def sin(x: Node) -> Node:
    return Call("sin", (x,))


def _with_leaves(node: Node, changed: Callable[[Name | Cubic], Node]) -> Node:
    """The tree with its names and piecewise cubics changed."""
    match node:
        case Name() | Cubic():
            return changed(node)
        case Unary(op, x):
            return Unary(op, _with_leaves(x, changed))
        case Binary(op, a, b):
            return Binary(op, _with_leaves(a, changed), _with_leaves(b, changed))
        case Call(fn, args):
            return Call(fn, tuple(_with_leaves(arg, changed) for arg in args))
    return node


def substitute(node: Node, by: Mapping[str, Node]) -> Node:
    """The tree with every name in `by` replaced by its tree."""

    def changed(leaf: Name | Cubic) -> Node:
        if isinstance(leaf, Name):
            return by.get(leaf.id, leaf)
        return replace(leaf, x=substitute(leaf.x, by))

    return _with_leaves(node, changed)


def has_cubic(node: Node) -> bool:
    """Whether a piecewise cubic is part of the tree."""
    return bool(cubics_in(node))


def cubics_in(node: Node) -> tuple[Cubic, ...]:
    """The piecewise cubics of a tree, one for each place."""
    match node:
        case Unary(_, x):
            return cubics_in(x)
        case Binary(_, a, b):
            return cubics_in(a) + cubics_in(b)
        case Call(_, args):
            return tuple(each for arg in args for each in cubics_in(arg))
        case Cubic():
            return (node,)
    return ()


def name_cubics(node: Node, names: Mapping[Cubic, str]) -> Node:
    """The tree with a name for each of the piecewise cubics that have one in `names`."""

    def changed(leaf: Name | Cubic) -> Node:
        return Name(names[leaf]) if isinstance(leaf, Cubic) and leaf in names else leaf

    return _with_leaves(node, changed)


def knots_along(components: Sequence[Expression], name: str, values: Mapping[str, float]) -> list[float]:
    """The knots of the piecewise cubics of a name, in order; `values` are those of the parameters."""
    cubics = [cubic for each in components for cubic in cubics_in(each.tree) if cubic.x == Name(name)]
    pieces = max((cubic.pieces for cubic in cubics), default=0)
    return [values[f"k_{i}"] for i in range(pieces + 1)] if pieces else []


def derivative(node: Node, name: str) -> Node:
    """The derivative by a name of a tree of sums, products, sines, cosines and piecewise cubics of names.

    Raises ValueError for another operation on the name.
    """
    if name not in _names(node):
        return Number(0.0)
    match node:
        case Name():
            return Number(1.0)
        case Unary(op, x):
            return Unary(op, derivative(x, name))
        case Binary("+" | "-" as op, a, b):
            return Binary(op, derivative(a, name), derivative(b, name))
        case Binary("*", a, b):
            return plus(times(derivative(a, name), b), times(a, derivative(b, name)))
        case Call("sin", (x,)):
            return times(cos(x), derivative(x, name))
        case Call("cos", (x,)):
            return times(Unary("-", sin(x)), derivative(x, name))
        case Cubic(x, order=order):
            return times(replace(node, order=order + 1), derivative(x, name))
    raise ValueError(f"{text_of(node)} is not differentiated by {name}")


def derivatives(components: Sequence[Expression], names: str) -> tuple[Expression, ...]:
    """The components differentiated by one-letter names, one after the other."""
    trees = [each.tree for each in components]
    for name in names:
        trees = [derivative(tree, name) for tree in trees]
    return tuple(expression_of(tree) for tree in trees)


def expression_of(tree: Node) -> Expression:
    """The expression of a tree, with a text that reads back as the same tree."""
    return Expression(text_of(tree), tree, frozenset(_names(tree)))


def text_of(tree: Node) -> str:
    """The tree in the language of expressions, with as few parentheses as its structure allows."""
    return _written(tree)[0]


def _names(node: Node) -> set[str]:
    match node:
        case Name(name):
            return {name}
        case Unary(_, x):
            return _names(x)
        case Binary(_, a, b):
            return _names(a) | _names(b)
        case Call(_, args):
            return set().union(*(_names(arg) for arg in args))
        case Cubic():
            return _names(node.tree())
    return set()


def _written(node: Node) -> tuple[str, int]:
    """The text and how tightly its outermost operation binds."""
    match node:
        case Number(value):
            return f"{value:.17g}" if float(f"{value:.15g}") != value else f"{value:.15g}", _ATOM
        case Name(name):
            return name, _ATOM
        case Unary(op, x):
            return op + _within(x, _UNARY), _UNARY
        case Binary(op, a, b):
            level = _LEVELS[op]
            if op == "**":
                return f"{_within(a, _ATOM)}**{_within(b, _UNARY)}", level
            gap = " " if level == 1 else ""
            return f"{_within(a, level)}{gap}{op}{gap}{_within(b, level + 1)}", level
        case Call(fn, args):
            return f"{fn}({', '.join(text_of(arg) for arg in args)})", _ATOM
        case Cubic():
            return _written(node.tree())


def _within(node: Node, level: int) -> str:
    text, binding = _written(node)
    return text if binding >= level else f"({text})"
