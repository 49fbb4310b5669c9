"""Random settings of inputs, and expressions with the inputs replaced by what these settings say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from modelgen.model import InputKind
from modelgen.notation import SETTING_SIZE
from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Unary, number

Array = np.ndarray[Any, Any]


def drawn_settings(kinds: Sequence[InputKind], n: int, random: np.random.Generator) -> Array:
    """(3 k, n) settings of k inputs."""
    return random.normal(size=(SETTING_SIZE * len(kinds), n))


def with_settings(expression: Expression, kinds: Sequence[InputKind], settings: Array) -> Expression:
    """The expression with each input replaced by its value at time t under settings (3 k,)."""
    lines: dict[str, Node] = {}
    for kind, (value, rate, since) in zip(kinds, settings.reshape(-1, SETTING_SIZE).tolist(), strict=True):
        passed = Binary("-", Name("t"), number(since))
        grown = Binary("+", number(value), Binary("*", number(rate), passed))
        lines[kind.name] = grown if kind.hold == "linear" else number(value)
    names = (expression.names - lines.keys()) | {"t"}
    return Expression(expression.text, _replaced(expression.tree, lines), names)


def _replaced(node: Node, lines: Mapping[str, Node]) -> Node:
    match node:
        case Name(name):
            return lines.get(name, node)
        case Unary(op, x):
            return Unary(op, _replaced(x, lines))
        case Binary(op, a, b):
            return Binary(op, _replaced(a, lines), _replaced(b, lines))
        case Call(fn, args):
            return Call(fn, tuple(_replaced(each, lines) for each in args))
        case Cubic():
            return replace(node, x=_replaced(node.x, lines))
    return node
