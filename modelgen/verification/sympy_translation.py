"""A CasADi function as formulas: lines in the order in which they are computed, each a sympy expression.

The function's instructions are walked in order. A value that is an output has the output's name from there
on; another value used once is written where it is used, and used more often becomes a temporary s1, s2, ...
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any

import casadi as ca
import sympy as sp

from modelgen.errors import ModelgenError

LONGEST = 24  # operations in one line; longer values are cut by a temporary

_AXES = ("x", "y", "z")
_AXIAL = ("normal", "point", "velocity", "slide", "l", "n", "t1", "t2", "m", "w", "momentum", "spin")
_SQUARE = ("A", "X", "metric", "R_psi", "K", "M", "B")


def _along(*letters: str) -> tuple[str, ...]:
    return tuple(f"{letter}_{axis}" for letter in letters for axis in _AXES)


_COMPONENTS: Mapping[tuple[str, int], tuple[str, ...]] = {
    ("pose", 12): (*_along("p"), *(f"R_{i}{j}" for j in _AXES for i in _AXES)),
    ("twist", 6): _along("v", "omega"),
    ("accel", 6): _along("vdot", "omegadot"),
    ("wrench", 6): _along("F", "tau"),
    ("wrench", 3): _along("F"),
    ("gravity", 3): _along("g"),
    ("uv", 2): ("u", "v"),
    ("q", 7): (*_along("p"), "q_w", *_along("q")),
    ("q", 3): _along("p"),
    ("u", 6): _along("v", "omega"),
    ("u", 3): _along("v"),
    ("qdot", 7): (*_along("pdot"), "qdot_w", *_along("qdot")),
    ("qdot", 3): _along("pdot"),
    ("udot", 6): _along("vdot", "omegadot"),
    ("udot", 3): _along("vdot"),
    **{(name, 3): _along(name) for name in _AXIAL},
    **{(name, 4): tuple(f"{name}_{i}{j}" for j in "12" for i in "12") for name in _SQUARE},
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
    output: str = ""  # the output that the target is a component of; empty for a temporary


@dataclass(slots=True)
class _Value:
    """Result of one instruction: its expression, and the number of its uses."""

    operation: int
    arguments: tuple[int, ...]
    leaf: sp.Expr | None = None
    uses: int = 0


Names = Mapping[str, Sequence[str]]


def definition(
    function: ca.Function,
    names: Names | None = None,
    steps: Collection[str] = (),
    longest: int = LONGEST,
) -> tuple[Line, ...]:
    """The lines that compute all outputs of an SX function, in order.

    `names` gives the entries of an input or output their own names, such as {"parameters": ("radius",)}.
    `steps` are outputs that are there to name what the others are made of: not written where they are a
    number or another name for something. A value of more than `longest` operations is cut.
    """
    values, outputs = _trace(function, names or {})
    for value in values:
        for argument in value.arguments:
            values[argument].uses += 1
    return tuple(_lines(values, outputs, steps, longest))


def leading_to(lines: Sequence[Line], output: str) -> tuple[Line, ...]:
    """The lines of one output, and those before that they need."""
    needed: set[sp.Basic] = set()
    kept = []
    for line in reversed(lines):
        if line.output == output or line.target in needed:
            needed |= line.value.free_symbols
            kept.append(line)
    return tuple(reversed(kept))


def component(name: str, index: int, size: int, names: Names) -> sp.Symbol:
    """The symbol of one entry of an input or output: `p_o_x` of pose_o, `d`, `J_o_3`; counted from 1."""
    if name in names:
        return sp.Symbol(names[name][index], real=True)
    if (name, size) in _COMPONENTS:
        return sp.Symbol(_COMPONENTS[name, size][index], real=True)
    stem, _, side = name.partition("_")
    if (stem, size) in _COMPONENTS:
        letter, _, axis = _COMPONENTS[stem, size][index].partition("_")
        return sp.Symbol(f"{letter}_{side}_{axis}", real=True)
    return sp.Symbol(name if size == 1 else f"{name}_{index + 1}", real=True)


@dataclass(frozen=True, slots=True)
class _Output:
    """One entry of an output: its symbol, and the position of its value."""

    name: str
    symbol: sp.Symbol
    index: int


def _trace(function: ca.Function, names: Names) -> tuple[list[_Value], list[_Output]]:
    """The instructions as values that refer to earlier ones by position, and the outputs' positions."""
    values: list[_Value] = []
    outputs: list[_Output] = []
    at: dict[int, int] = {}  # work-vector slot -> position in `values`
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            symbol = _entry(function, target, names, output=True)
            outputs.append(_Output(function.name_out(target[0]), symbol, at[source[0]]))
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


def _lines(
    values: list[_Value], outputs: list[_Output], steps: Collection[str], longest: int
) -> Iterator[Line]:
    numbers = count(1)
    named = {output.index: output for output in reversed(outputs) if values[output.index].leaf is None}
    expressions: list[sp.Expr] = []
    lengths: list[int] = []
    for index, value in enumerate(values):
        if value.leaf is not None:
            expressions.append(value.leaf)
            lengths.append(0)
            continue
        expression = _OPERATIONS[value.operation](*(expressions[a] for a in value.arguments))
        length = 1 + sum(lengths[a] for a in value.arguments)
        if index in named and not expression.is_Atom:
            yield Line(named[index].symbol, expression, named[index].name)
            expression, length = named[index].symbol, 0
        elif expression.is_Atom or (-expression).is_Atom:
            length = 0
        elif value.uses > 1 or length > longest:
            temporary = sp.Symbol(f"s{next(numbers)}", real=True)
            yield Line(temporary, expression)
            expression, length = temporary, 0
        expressions.append(expression)
        lengths.append(length)
    for output in outputs:
        if expressions[output.index] != output.symbol and output.name not in steps:
            yield Line(output.symbol, expressions[output.index], output.name)
