"""A CasADi function as formulas: named temporaries, then the outputs, each a sympy expression.

The function's instructions are walked in order. A value used once is written where it is used; a value used
more often becomes a temporary w1, w2, ... in order of appearance, so that the text reads as it is computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

import casadi as ca
import sympy as sp

from modelgen.errors import ModelgenError

LONGEST = 24  # operations in one line; longer values are cut by a temporary

_AXES = ("x", "y", "z")
_COMPONENTS = {
    "pose": (*(f"p_{i}" for i in _AXES), *(f"R_{i}{j}" for j in _AXES for i in _AXES)),
    "twist": (*(f"v_{i}" for i in _AXES), *(f"omega_{i}" for i in _AXES)),
    "wrench": (*(f"F_{i}" for i in _AXES), *(f"tau_{i}" for i in _AXES)),
    "gravity": tuple(f"g_{i}" for i in _AXES),
    "uv": ("u", "v"),
}

_OPERATIONS: dict[int, Callable[..., Any]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_MUL: lambda a, b: a * b,
    ca.OP_DIV: lambda a, b: a / b,
    ca.OP_NEG: lambda a: -a,
    ca.OP_INV: lambda a: 1 / a,
    ca.OP_SQ: lambda a: a**2,
    ca.OP_TWICE: lambda a: 2 * a,
    ca.OP_POW: lambda a, b: a**b,
    ca.OP_CONSTPOW: lambda a, b: a**b,
    ca.OP_SQRT: sp.sqrt,
    ca.OP_EXP: sp.exp,
    ca.OP_LOG: sp.log,
    ca.OP_LOG1P: lambda a: sp.log(1 + a),
    ca.OP_EXPM1: lambda a: sp.exp(a) - 1,
    ca.OP_SIN: sp.sin,
    ca.OP_COS: sp.cos,
    ca.OP_TAN: sp.tan,
    ca.OP_ASIN: sp.asin,
    ca.OP_ACOS: sp.acos,
    ca.OP_ATAN: sp.atan,
    ca.OP_ATAN2: sp.atan2,
    ca.OP_SINH: sp.sinh,
    ca.OP_COSH: sp.cosh,
    ca.OP_TANH: sp.tanh,
    ca.OP_ASINH: sp.asinh,
    ca.OP_ACOSH: sp.acosh,
    ca.OP_ATANH: sp.atanh,
    ca.OP_FABS: sp.Abs,
    ca.OP_SIGN: sp.sign,
    ca.OP_FLOOR: sp.floor,
    ca.OP_CEIL: sp.ceiling,
    ca.OP_FMIN: sp.Min,
    ca.OP_FMAX: sp.Max,
    ca.OP_FMOD: sp.Function("fmod"),
    ca.OP_HYPOT: lambda a, b: sp.sqrt(a**2 + b**2),
    ca.OP_COPYSIGN: sp.Function("copysign"),
    ca.OP_LT: sp.Function("lt"),
    ca.OP_LE: sp.Function("le"),
    ca.OP_EQ: sp.Function("eq"),
    ca.OP_NE: sp.Function("ne"),
    ca.OP_NOT: sp.Function("not"),
    ca.OP_AND: sp.Function("and"),
    ca.OP_OR: sp.Function("or"),
    ca.OP_IF_ELSE_ZERO: lambda condition, a: condition * a,
}


@dataclass(frozen=True, slots=True)
class Line:
    """`target = value`; the target is a temporary or a component of an output."""

    target: sp.Symbol
    value: sp.Expr


@dataclass(slots=True)
class _Value:
    """One instruction's result: how to compute it, and how often it is used."""

    operation: int
    arguments: tuple[int, ...]
    leaf: sp.Expr | None = None
    uses: int = 0


Names = Mapping[str, Sequence[str]]


def definition(function: ca.Function, names: Names | None = None) -> tuple[Line, ...]:
    """The lines that compute all outputs of an SX function, in order.

    `names` gives the entries of an input or output their own names, such as {"parameters": ("radius",)}.
    """
    values, outputs = _trace(function, names or {})
    for value in values:
        for argument in value.arguments:
            values[argument].uses += 1
    for _, index in outputs:
        values[index].uses += 1
    return tuple(_lines(values, outputs))


def component(name: str, index: int, size: int, names: Names) -> sp.Symbol:
    """The symbol of one entry of an input or output: `p_o_x` of pose_o, `d`, `J_o_3`; counted from 1."""
    if name in names:
        return sp.Symbol(names[name][index], real=True)
    stem, _, side = name.partition("_")
    if stem in _COMPONENTS and index < len(_COMPONENTS[stem]):
        letter, _, axis = _COMPONENTS[stem][index].partition("_")
        return sp.Symbol("_".join(part for part in (letter, side, axis) if part), real=True)
    return sp.Symbol(name if size == 1 else f"{name}_{index + 1}", real=True)


def _trace(function: ca.Function, names: Names) -> tuple[list[_Value], list[tuple[sp.Symbol, int]]]:
    """The instructions as values that refer to earlier ones by position, and the outputs' positions."""
    values: list[_Value] = []
    outputs: list[tuple[sp.Symbol, int]] = []
    at: dict[int, int] = {}  # work-vector slot -> position in `values`
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            outputs.append((_entry(function, target, names, output=True), at[source[0]]))
            continue
        values.append(_instruction(function, k, operation, source, at, names))
        at[target[0]] = len(values) - 1
    return values, outputs


def _instruction(
    function: ca.Function, k: int, operation: int, source: list[int], at: dict[int, int], names: Names
) -> _Value:
    if operation == ca.OP_CONST:
        return _Value(operation, (), leaf=_number(function.instruction_constant(k)))
    if operation == ca.OP_INPUT:
        return _Value(operation, (), leaf=_entry(function, source, names, output=False))
    if operation not in _OPERATIONS:
        raise ModelgenError(
            function.name(), f"operation {operation} has no notation", "", "export the C instead"
        )
    return _Value(operation, tuple(at[slot] for slot in source))


def _entry(function: ca.Function, place: Sequence[int], names: Names, *, output: bool) -> sp.Symbol:
    port, nonzero = place
    name = function.name_out(port) if output else function.name_in(port)
    size = function.nnz_out(port) if output else function.nnz_in(port)
    return component(name, nonzero, size, names)


def _number(value: float) -> sp.Expr:
    return sp.Integer(int(value)) if float(value).is_integer() and abs(value) < 1e9 else sp.Float(value)


def _lines(values: list[_Value], outputs: list[tuple[sp.Symbol, int]]) -> Iterator[Line]:
    numbers = count(1)
    expressions: list[sp.Expr] = []
    lengths: list[int] = []
    for value in values:
        if value.leaf is not None:
            expressions.append(value.leaf)
            lengths.append(0)
            continue
        expression = _OPERATIONS[value.operation](*(expressions[a] for a in value.arguments))
        length = 1 + sum(lengths[a] for a in value.arguments)
        if expression.is_Atom or (-expression).is_Atom:
            length = 0
        elif value.uses > 1 or length > LONGEST:
            temporary = sp.Symbol(f"w{next(numbers)}", real=True)
            yield Line(temporary, expression)
            expression, length = temporary, 0
        expressions.append(expression)
        lengths.append(length)
    for target, index in outputs:
        yield Line(target, expressions[index])
