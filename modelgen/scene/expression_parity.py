"""Parity of expressions: what becomes of their values where some names change their signs together."""

from __future__ import annotations

from collections.abc import Collection

from modelgen.scene.expression import Binary, Call, Cubic, Name, Node, Number, Unary

ODD = ("sin", "tan", "asin", "atan", "sinh", "tanh", "sign")
EVEN = ("cos", "cosh", "abs")


def parity(node: Node, names: Collection[str]) -> int | None:
    """1 if the value stays where all `names` change their signs, -1 if it changes its own, None if neither is
    seen."""
    match node:
        case Number():
            return 1
        case Name(name):
            return -1 if name in names else 1
        case Unary(_, x):
            return parity(x, names)
        case Binary("**", a, Number(exponent)) if exponent == int(exponent):
            of_base = parity(a, names)
            return 1 if exponent % 2 == 0 and of_base else of_base
        case Binary(op, a, b):
            return _of_operation(op, parity(a, names), parity(b, names))
        case Call(fn, args):
            return _of_call(fn, [parity(arg, names) for arg in args])
        case Cubic(x=x):
            return 1 if parity(x, names) == 1 else None


def _of_operation(op: str, a: int | None, b: int | None) -> int | None:
    if a is None or b is None:
        return None
    if op in "*/":
        return a * b
    return a if a == b and (op in "+-" or a == 1) else None


def _of_call(fn: str, arguments: list[int | None]) -> int | None:
    if set(arguments) == {1}:
        return 1
    if arguments == [-1]:
        return -1 if fn in ODD else 1 if fn in EVEN else None
    return None
