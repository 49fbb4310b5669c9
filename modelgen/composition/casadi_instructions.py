"""Functions of CasADi as lists of elementary operations, and functions rebuilt from them."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Instruction:
    """One elementary operation of a function of `ca.SX`."""

    number: int
    operation: int  # ca.OP_..
    operands: tuple[int, ...]  # numbers of the instructions whose results it takes
    place: tuple[int, int] = (0, 0)  # of OP_INPUT and OP_OUTPUT: the argument or output, and its entry


def instructions(function: ca.Function) -> Iterator[Instruction]:
    """The operations in their order."""
    makers: dict[int, int] = {}  # by the place in the work vector
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        given, taken = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            yield Instruction(k, operation, (makers[given[0]],), (taken[0], taken[1]))
            continue
        if operation == ca.OP_INPUT:
            yield Instruction(k, operation, (), (given[0], given[1]))
        elif operation == ca.OP_CONST:
            yield Instruction(k, operation, ())
        else:
            yield Instruction(k, operation, tuple(makers[place] for place in given))
        makers[taken[0]] = k


@contextmanager
def unsimplified() -> Iterator[None]:
    """Expressions made here hold the operations that are written, and round as these: CasADi else makes
    x/y of x (1/y)."""
    simplifies = ca.GlobalOptions.getSimplificationOnTheFly()
    ca.GlobalOptions.setSimplificationOnTheFly(False)
    try:
        yield
    finally:
        ca.GlobalOptions.setSimplificationOnTheFly(simplifies)


def rebuilt(
    function: ca.Function,
    steps: Sequence[Instruction],
    inputs: list[ca.SX],
    replacement: Callable[[Instruction, tuple[ca.SX, ...]], ca.SX | None] = lambda *_: None,
    known: Mapping[int, ca.SX] | None = None,
) -> list[ca.SX]:
    """The outputs of a function as expressions of other inputs; to be called where `unsimplified` holds.

    Args:
        function: of `ca.SX`.
        steps: its `instructions`.
        inputs: take the place of its inputs.
        replacement: given an operation and the values of its operands, what takes the place of its result;
            None: nothing does.
        known: results by the numbers of their instructions; what only they need is not made.
    """
    outputs = [ca.SX(function.sparsity_out(k)) for k in range(function.n_out())]
    values = dict(known or {})
    for each in _needed(steps, values):
        operands = tuple(values[number] for number in each.operands)
        if each.operation == ca.OP_OUTPUT:
            outputs[each.place[0]].nz[each.place[1]] = operands[0]
        elif each.operation == ca.OP_INPUT:
            values[each.number] = inputs[each.place[0]].nz[each.place[1]]
        elif each.operation == ca.OP_CONST:
            values[each.number] = ca.SX(function.instruction_constant(each.number))
        else:
            other = replacement(each, operands)
            values[each.number] = _result(each.operation, operands) if other is None else other
    return outputs


def _needed(steps: Sequence[Instruction], known: Container[int]) -> list[Instruction]:
    """The instructions that the outputs need beside known results."""
    needed: set[int] = set()
    found = []
    for each in reversed(steps):
        if each.number not in known and (each.operation == ca.OP_OUTPUT or each.number in needed):
            needed.update(each.operands)
            found.append(each)
    return found[::-1]


def _result(operation: int, operands: tuple[ca.SX, ...]) -> ca.SX:
    if len(operands) == 1:
        return ca.SX.unary(operation, *operands)
    return ca.SX.binary(operation, *operands)
