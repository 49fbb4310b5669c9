"""Branches of expressions: between jumps and kinks an expression is smooth.

Each call of a function that is not smooth has a switching function, at whose zero it changes its branch. On a
branch the call is a smooth function, which goes on beyond the zero.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import casadi as ca

_DEPTH = 20  # operations deep to which switching functions are compared


class Branches:
    """The branches of expressions that are lowered together.

    `functions` are the switching functions, each of which may depend on the branches of those before it;
    `symbols` are the branches: 1 and -1 where the function is positive and negative, 0 where it stays zero.
    """

    def __init__(self) -> None:
        self.functions: list[ca.SX] = []
        self.symbols: list[ca.SX] = []

    def calls(self) -> Mapping[str, Callable[..., ca.SX]]:
        """The functions of expressions that are not smooth, on their branches."""
        return {
            "abs": self.absolute, "sign": self.of, "atan2": self.angle,
            "min": self.least, "max": self.greatest,
        }  # fmt: skip

    def watched(self, name: str, call: Callable[..., ca.SX]) -> Callable[..., ca.SX]:
        """A function as it is written, whose switching function is one of `functions` all the same."""

        def evaluated(*arguments: ca.SX) -> ca.SX:
            self.calls()[name](*arguments)
            return call(*arguments)

        return evaluated

    def of(self, function: ca.SX) -> ca.SX:
        """The branch of a switching function."""
        if function.is_constant():
            return ca.sign(function)
        for known, symbol in zip(self.functions, self.symbols, strict=True):
            if ca.is_equal(known, function, _DEPTH):
                return symbol
            if ca.is_equal(known, -function, _DEPTH) or ca.is_equal(-known, function, _DEPTH):
                return -symbol
        self.functions.append(function)
        self.symbols.append(ca.SX.sym(f"branch_{len(self.symbols)}"))
        return self.symbols[-1]

    def absolute(self, x: ca.SX) -> ca.SX:
        return self.of(x) * x

    def greatest(self, a: ca.SX, b: ca.SX) -> ca.SX:
        return ca.if_else(self.of(a - b) > 0, a, b)

    def least(self, a: ca.SX, b: ca.SX) -> ca.SX:
        return ca.if_else(self.of(a - b) > 0, b, a)

    def angle(self, y: ca.SX, x: ca.SX) -> ca.SX:
        """atan2: it jumps where y is zero and x negative."""
        side = ca.if_else(self.of(y) >= 0, 1, -1)
        return side * ca.pi / 2 + ca.atan2(-side * x, side * y)
