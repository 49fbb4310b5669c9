"""Divisions by one denominator as multiplications by its reciprocal: a division takes as long as several
multiplications, and the others wait for it."""

from __future__ import annotations

from collections import Counter

import casadi as ca

SHARED = 2  # divisions by one denominator that make a reciprocal pay


def with_shared_reciprocals(function: ca.Function) -> ca.Function:
    """A function (ca.SX) in which what several divisions share is inverted once; a constant always is.

    Results differ by rounding, one more of each such division.
    """
    simplifies = ca.GlobalOptions.getSimplificationOnTheFly()
    ca.GlobalOptions.setSimplificationOnTheFly(False)  # which makes x/y of x (1/y)
    try:
        return _rewritten(function)
    finally:
        ca.GlobalOptions.setSimplificationOnTheFly(simplifies)


def _rewritten(function: ca.Function) -> ca.Function:
    uses = Counter(_denominators(function))
    inputs = function.sx_in()
    outputs = [ca.SX(function.sparsity_out(k)) for k in range(function.n_out())]
    known: dict[int, ca.SX] = {}  # by the place in the work vector
    numbers: dict[int, int] = {}  # of the values there
    reciprocals: dict[int, ca.SX] = {}
    for k in range(function.n_instructions()):
        operation, given, taken = _instruction(function, k)
        if operation == ca.OP_OUTPUT:
            outputs[taken[0]].nz[taken[1]] = known[given[0]]
            continue
        if operation == ca.OP_INPUT:
            value = inputs[given[0]].nz[given[1]]
        elif operation == ca.OP_CONST:
            value = ca.SX(function.instruction_constant(k))
        elif operation == ca.OP_DIV and (uses[numbers[given[1]]] >= SHARED or known[given[1]].is_constant()):
            below = numbers[given[1]]
            if below not in reciprocals:
                reciprocals[below] = 1 / known[given[1]]
            value = known[given[0]] * reciprocals[below]
        elif len(given) == 1:
            value = ca.SX.unary(operation, known[given[0]])
        else:
            value = ca.SX.binary(operation, known[given[0]], known[given[1]])
        known[taken[0]], numbers[taken[0]] = value, k
    names = function.name_in(), function.name_out()
    return ca.Function(function.name(), inputs, ca.cse(outputs), *names)


def _denominators(function: ca.Function) -> list[int]:
    """The instruction that made the denominator, of each division."""
    numbers: dict[int, int] = {}
    found = []
    for k in range(function.n_instructions()):
        operation, given, taken = _instruction(function, k)
        if operation == ca.OP_DIV:
            found.append(numbers[given[1]])
        if operation != ca.OP_OUTPUT:
            numbers[taken[0]] = k
    return found


def _instruction(function: ca.Function, k: int) -> tuple[int, list[int], list[int]]:
    return function.instruction_id(k), function.instruction_input(k), function.instruction_output(k)
