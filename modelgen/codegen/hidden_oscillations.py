"""Functions of time that may oscillate between the samples that a step takes of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import casadi as ca

from modelgen.composition.casadi_instructions import instructions

SEEN = 3  # the degree of a polynomial that samples of a step show whole

_KEPT = (ca.OP_ASSIGN, ca.OP_NEG, ca.OP_TWICE)
_SUMS = (ca.OP_ADD, ca.OP_SUB)


def may_oscillate(f: ca.Function, *of: str) -> bool:
    """Whether an output of an SX function is no polynomial of degree `SEEN` in entries of the inputs `of`."""
    return degree(f, [f.index_in(name) for name in of]) > SEEN


def degree(f: ca.Function, of: Sequence[int]) -> float:
    """Degree of the outputs of an SX function as polynomials in the inputs `of`; infinite if one is no
    polynomial."""
    at: dict[int, float] = {}  # by the number of the instruction
    most = 0.0
    for each in instructions(f):
        if each.operation == ca.OP_OUTPUT:
            most = max(most, at[each.operands[0]])
        elif each.operation == ca.OP_INPUT:
            at[each.number] = float(each.place[0] in of)
        else:
            at[each.number] = _of(each.operation, [at[number] for number in each.operands])
    return most


def _of(operation: int, degrees: list[float]) -> float:
    """Degree of the result of an operation, from the degrees of its operands."""
    if not any(degrees):
        return 0.0
    if operation in _KEPT:
        return degrees[0]
    if operation in _SUMS:
        return max(degrees)
    if operation == ca.OP_MUL:
        return sum(degrees)
    if operation == ca.OP_SQ:
        return 2 * degrees[0]
    return degrees[0] if operation == ca.OP_DIV and not degrees[1] else inf
