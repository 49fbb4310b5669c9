"""Expressions as presentation MathML that browsers render by themselves (MathML Core)."""

from __future__ import annotations

import re
from html import escape
from typing import Any

import sympy as sp

WIDTH = 68  # characters of a line, about; longer sums are broken at their signs
GREEK = {
    "rho": "ρ", "omega": "ω", "tau": "τ", "eta": "η", "gamma": "Γ", "psi": "ψ", "phi": "φ", "nu": "ν",
    "beta": "β", "mu": "μ", "sigma": "σ", "lambda": "λ",
}  # fmt: skip
FUNCTIONS = {"Max": "max", "Min": "min", "sign": "sgn"}
RELATIONS = {"lt": "<", "le": "≤", "eq": "=", "ne": "≠", "and": "∧", "or": "∨"}  # 1 where it holds, else 0
APPLY = '<mo>&#x2061;</mo><mspace width="0.17em"/>'
NAMES = {
    "normal": "N",
    "force": "λ",
    "gamma": "Γ₂",
    "gamma1": "Γ₁",
    "kinetic": "T",
    "potential": "U",
    "uv": "α",
}


def row(*parts: str) -> str:
    return f"<mrow>{''.join(parts)}</mrow>"


def operator(sign: str) -> str:
    return f"<mo>{escape(sign)}</mo>"


def identifier(text: str) -> str:
    upright = ' mathvariant="normal"' if len(text) > 1 else ""
    return f"<mi{upright}>{escape(text)}</mi>"


def symbol(name: str) -> str:
    """`omega_f_z` with its indices below, `eta_dot` with its dot above."""
    stem, *indices = name.split("_")
    dotted = stem.endswith("dot") and len(stem) > 3
    stem = stem.removesuffix("dot") if dotted else stem
    while indices and indices[0] in ("dot", "rate"):
        indices.pop(0)
        dotted = True
    if "dot" in indices:
        indices.remove("dot")
        dotted = True
    found = re.fullmatch(r"(.*?)(\d*)", stem)
    letters, digits = (found[1], found[2]) if found else (stem, "")
    if stem in NAMES:
        letters, digits = stem, ""
    base = identifier(NAMES.get(letters, GREEK.get(letters, letters)))
    if dotted:
        base = f"<mover>{base}<mo>˙</mo></mover>"
    below = ",".join(part for part in (digits, *indices) if part)
    return f'<msub>{base}<mrow><mi mathvariant="normal">{escape(below)}</mi></mrow></msub>' if below else base


def number(value: sp.Expr) -> str:
    if not value.is_Float:
        return f"<mn>{escape(str(value))}</mn>"
    mantissa, _, exponent = f"{float(value):.6g}".partition("e")
    if not exponent:
        return f"<mn>{mantissa}</mn>"
    power = f"<msup><mn>10</mn><mn>{int(exponent)}</mn></msup>".replace("<mn>-", "<mn>−")
    return power if mantissa == "1" else row(f"<mn>{mantissa}</mn>", operator("·"), power)


def expression(value: Any, level: int = 0) -> str:
    """MathML of an expression; `level` 0 in a sum, 1 in a product, 2 under a power."""
    if value.is_Symbol:
        return symbol(str(value))
    if value.is_Rational and not value.is_Integer:
        return _wrapped(_fraction(sp.Integer(value.p), sp.Integer(value.q)), value.is_negative and level > 0)
    if value.is_Number or value.is_NumberSymbol:
        return _wrapped(
            "<mi>π</mi>" if value == sp.pi else number(value), bool(value.is_negative) and level > 0
        )
    if value.is_Add:
        return _wrapped(row(*(_term(term, first=not k) for k, term in enumerate(_terms(value)))), level > 0)
    if value.is_Mul:
        return _wrapped(_product(value), level > 1 or (level > 0 and value.could_extract_minus_sign()))
    if value.is_Pow:
        return _power(value)
    return _call(value)


def _wrapped(inner: str, brackets: bool) -> str:
    return row(operator("("), inner, operator(")")) if brackets else inner


def _terms(value: sp.Add) -> list[sp.Expr]:
    """Positive terms first."""
    return sorted(value.as_ordered_terms(), key=lambda term: bool(term.could_extract_minus_sign()))


def _term(term: sp.Expr, *, first: bool) -> str:
    if term.could_extract_minus_sign():
        return operator("−") + expression(-term, 1)
    return ("" if first else operator("+")) + expression(term, 0 if not term.is_Add else 1)


def _fraction(top: sp.Expr, bottom: sp.Expr) -> str:
    return f"<mfrac>{row(expression(top))}{row(expression(bottom))}</mfrac>"


def _product(value: sp.Mul) -> str:
    if value.could_extract_minus_sign():
        return operator("−") + expression(-value, 1)
    top, bottom = sp.fraction(value)
    if bottom != 1:
        return _fraction(top, bottom)
    factors = [expression(factor, 1) for factor in value.as_ordered_factors()]
    return row('<mo>&#x2062;</mo><mspace width="0.12em"/>'.join(factors))


def _power(value: sp.Pow) -> str:
    base, exponent = value.as_base_exp()
    if exponent.is_negative:
        return _fraction(sp.Integer(1), base**-exponent)
    if exponent == sp.Rational(1, 2):
        return f"<msqrt>{expression(base)}</msqrt>"
    named = base.is_Function and isinstance(base, sp.sin | sp.cos | sp.tan)
    if named and exponent.is_Integer:
        head = f'<msup><mi mathvariant="normal">{base.func.__name__}</mi>{row(expression(exponent))}</msup>'
        return row(head, APPLY, _argument(base.args[0]))
    return f"<msup>{row(expression(base, 2))}{row(expression(exponent))}</msup>"


def _argument(value: sp.Expr) -> str:
    return expression(value) if value.is_Symbol else row(operator("("), expression(value), operator(")"))


def _call(value: sp.Expr) -> str:
    if isinstance(value, sp.Abs):
        return row(operator("|"), expression(value.args[0]), operator("|"))
    arguments = [expression(argument) for argument in value.args]
    named = value.func.__name__
    if named in RELATIONS:
        return row(operator("["), arguments[0], operator(RELATIONS[named]), arguments[1], operator("]"))
    if named == "not":
        return row(operator("["), operator("¬"), arguments[0], operator("]"))
    name = f'<mi mathvariant="normal">{escape(FUNCTIONS.get(named, named))}</mi>'
    if len(arguments) == 1:
        return row(name, APPLY, _argument(value.args[0]))
    return row(name, operator("("), operator(",").join(arguments), operator(")"))


def form(name: str, value: sp.MatrixBase) -> list[str]:
    """`name = matrix`; entry by entry where the rows would be too long."""
    left = symbol(name)
    lengths = [sum(len(sp.sstr(entry)) for entry in value.row(i)) for i in range(value.rows)]
    if max(lengths) <= 2 * WIDTH or value.shape == (1, 1):
        return (
            [block(row(left, operator("="), matrix(value)))]
            if value.shape != (1, 1)
            else [equation(left, value[0])]
        )
    return [
        equation(symbol(f"{name}_{i + 1}{j + 1}"), value[i, j])
        for i in range(value.rows)
        for j in range(value.cols)
        if i <= j or value[i, j] != value[j, i]
    ]


def matrix(value: sp.MatrixBase) -> str:
    """With brackets; one entry alone without."""
    if value.shape == (1, 1):
        return expression(value[0])
    rows = (
        "<mtr>" + "".join(f"<mtd>{expression(value[i, j])}</mtd>" for j in range(value.cols)) + "</mtr>"
        for i in range(value.rows)
    )
    return row(operator("("), f'<mtable displaystyle="true">{"".join(rows)}</mtable>', operator(")"))


def equation(left: str, value: sp.Expr) -> str:
    """`left = value`, a long sum in several rows."""
    parts = _broken(value)
    if len(parts) == 1:
        return block(row(left, operator("="), parts[0]))
    lines = [f"<mtr><mtd>{left}</mtd><mtd>{row(operator('='), parts[0])}</mtd></mtr>"]
    lines += [f"<mtr><mtd></mtd><mtd>{part}</mtd></mtr>" for part in parts[1:]]
    return block(f'<mtable displaystyle="true" class="lines">{"".join(lines)}</mtable>')


def _broken(value: sp.Expr) -> list[str]:
    if not value.is_Add:
        return [expression(value)]
    lines: list[list[str]] = [[]]
    length = 0
    for k, term in enumerate(_terms(value)):
        own = len(sp.sstr(term))
        if length and length + own > WIDTH:
            lines.append([])
            length = 0
        lines[-1].append(_term(term, first=not k))
        length += own
    return [row(*line) for line in lines]


def block(inner: str) -> str:
    return f'<math displaystyle="true">{inner}</math>'
