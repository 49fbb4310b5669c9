"""Short closed forms of rational functions of sines and cosines, by polynomial arithmetic alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product

import sympy as sp

TERMS = 60  # of a sum; longer ones are left as they are
Sign = Callable[[sp.Expr], int]  # of an expression over the domain: 1, -1, or 0 where it has none


def short(expression: sp.Expr) -> sp.Expr:
    """An equal expression, the shortest found: squares of cosines or of sines eliminated, then factored."""
    swapped, back = _polynomial(expression)
    numerator, denominator = sp.fraction(sp.together(swapped))
    top, bottom = _shortest(numerator, back), _shortest(denominator, back)
    return min((sp.cancel(top / bottom), top / bottom), key=sp.count_ops).xreplace(_names(back))


def square_root(expression: sp.Expr, sign: Sign) -> sp.Expr:
    """sqrt of a polynomial, whole squares taken out with the sign that they have on the domain."""
    swapped, back = _polynomial(expression)
    numerator, denominator = sp.fraction(sp.together(swapped))
    parts = [_root(_shortest(part, back), back, sign) for part in (numerator, denominator)]
    return parts[0] / parts[1]


Pairs = list[tuple[sp.Expr, sp.Symbol, sp.Symbol]]  # argument, its sine, its cosine


def _polynomial(expression: sp.Expr) -> tuple[sp.Expr, Pairs]:
    arguments = {f.args[0] for f in expression.atoms(sp.sin, sp.cos)}
    pairs: Pairs = [(a, sp.Dummy("s"), sp.Dummy("c")) for a in sorted(arguments, key=sp.default_sort_key)]
    known = {sp.sin(a): s for a, s, _ in pairs} | {sp.cos(a): c for a, _, c in pairs}
    return expression.xreplace(known), pairs


def _names(pairs: Pairs) -> dict[sp.Expr, sp.Expr]:
    return {s: sp.sin(a) for a, s, _ in pairs} | {c: sp.cos(a) for a, _, c in pairs}


def _forms(expression: sp.Expr, pairs: Pairs) -> Iterator[sp.Expr]:
    expanded = sp.expand(expression)
    if len(sp.Add.make_args(expanded)) > TERMS:
        yield expression
        return
    for choice in product((0, 1), repeat=len(pairs)):
        reduced = expanded
        for eliminated, (_, s, c) in zip(choice, pairs, strict=True):
            own = (s, c)[eliminated]
            if reduced.is_polynomial(own):
                reduced = sp.rem(reduced, s**2 + c**2 - 1, own)
        yield sp.factor(reduced)
    yield sp.factor(expanded)


def _shortest(expression: sp.Expr, pairs: Pairs) -> sp.Expr:
    return min(_forms(expression, pairs), key=sp.count_ops)


def _root(polynomial: sp.Expr, pairs: Pairs, sign: Sign) -> sp.Expr:
    """The square root of a product of powers."""
    whole, under = sp.Integer(1), sp.Integer(1)
    for factor in sp.Mul.make_args(polynomial):
        base, exponent = factor.as_base_exp()
        known = base.xreplace(_names(pairs))
        if exponent.is_Integer and exponent.is_positive and sign(known):
            whole *= (known * sign(known)) ** (exponent // 2)
            under *= known ** (exponent % 2)
        else:
            under *= factor.xreplace(_names(pairs))
    return whole * sp.sqrt(under)
