"""Divisions by one denominator as multiplications by its reciprocal: a division takes as long as several
multiplications, and the others wait for it."""

from __future__ import annotations

from collections import Counter

import casadi as ca

from modelgen.composition.casadi_instructions import Instruction, instructions, rebuilt, unsimplified

SHARED = 2  # divisions by one denominator that make a reciprocal pay


def with_shared_reciprocals(function: ca.Function) -> ca.Function:
    """A function (ca.SX) in which what several divisions share is inverted once; a constant always is.

    Results differ by rounding, one more of each such division.
    """
    steps = tuple(instructions(function))
    divisions = Counter(each.operands[1] for each in steps if each.operation == ca.OP_DIV)
    reciprocals: dict[int, ca.SX] = {}

    def product(each: Instruction, operands: tuple[ca.SX, ...]) -> ca.SX | None:
        if each.operation != ca.OP_DIV:
            return None
        above, below = operands
        if divisions[each.operands[1]] < SHARED and not below.is_constant():
            return None
        if each.operands[1] not in reciprocals:
            reciprocals[each.operands[1]] = 1 / below
        return above * reciprocals[each.operands[1]]

    inputs = function.sx_in()
    names = function.name_in(), function.name_out()
    with unsimplified():
        outputs = ca.cse(rebuilt(function, steps, inputs, product))
        return ca.Function(function.name(), inputs, outputs, *names)
