"""A generated function evaluated with mpmath numbers, instruction by instruction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import mpmath as mp

_OPERATIONS: Mapping[int, Callable[..., Any]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_MUL: lambda a, b: a * b,
    ca.OP_DIV: lambda a, b: a / b,
    ca.OP_NEG: lambda a: -a,
    ca.OP_TWICE: lambda a: 2 * a,
    ca.OP_SQ: lambda a: a * a,
    ca.OP_INV: lambda a: 1 / a,
    ca.OP_SQRT: mp.sqrt,
    ca.OP_SIN: mp.sin,
    ca.OP_COS: mp.cos,
    ca.OP_TAN: mp.tan,
    ca.OP_ATAN2: mp.atan2,
    ca.OP_FABS: abs,
    ca.OP_POW: mp.power,
    ca.OP_CONSTPOW: mp.power,
    ca.OP_SIGN: mp.sign,
    ca.OP_FMAX: max,
    ca.OP_FMIN: min,
    ca.OP_LE: lambda a, b: mp.mpf(a <= b),
    ca.OP_LT: lambda a, b: mp.mpf(a < b),
    ca.OP_IF_ELSE_ZERO: lambda c, a: a if c else mp.mpf(0),
    ca.OP_NOT: lambda a: mp.mpf(not a),
}


def evaluate(f: ca.Function, *arguments: Sequence[Any]) -> list[list[Any]]:
    """The outputs of an SX function at mpmath (or exact double) arguments, in the working precision."""
    work: dict[int, Any] = {}
    outputs = [[mp.mpf(0)] * f.nnz_out(i) for i in range(f.n_out())]
    for op, out, into, constant in _program(f):
        if op == ca.OP_INPUT:
            work[out[0]] = mp.mpf(arguments[into[0]][into[1]])
        elif op == ca.OP_OUTPUT:
            outputs[out[0]][out[1]] = work[into[0]]
        elif op == ca.OP_CONST:
            work[out[0]] = mp.mpf(constant)
        else:
            work[out[0]] = _OPERATIONS[op](*(work[i] for i in into))
    return outputs


_PROGRAMS: dict[int, tuple[ca.Function, list[tuple[int, list[int], list[int], float]]]] = {}


def _program(f: ca.Function) -> list[tuple[int, list[int], list[int], float]]:
    """Operation, outputs, inputs and constant of each instruction; read once for each function."""
    key = hash(f)
    if key not in _PROGRAMS:
        _PROGRAMS[key] = (
            f,
            [
                (
                    f.instruction_id(k),
                    f.instruction_output(k),
                    f.instruction_input(k),
                    f.instruction_constant(k) if f.instruction_id(k) == ca.OP_CONST else 0.0,
                )
                for k in range(f.n_instructions())
            ],
        )
    return _PROGRAMS[key][1]
