"""Expressions made of expressions, tree by tree: names replaced, operations put on top. No text is parsed."""

from __future__ import annotations

from collections.abc import Mapping

from modelgen.scene.expression import Binary, Call, Expression, Name, Node, Number, Unary

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


def substitute(node: Node, by: Mapping[str, Node]) -> Node:
    """The tree with every name in `by` replaced by its tree."""
    match node:
        case Name(name):
            return by.get(name, node)
        case Unary(op, x):
            return Unary(op, substitute(x, by))
        case Binary(op, a, b):
            return Binary(op, substitute(a, by), substitute(b, by))
        case Call(fn, args):
            return Call(fn, tuple(substitute(arg, by) for arg in args))
    return node


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


def _within(node: Node, level: int) -> str:
    text, binding = _written(node)
    return text if binding >= level else f"({text})"
