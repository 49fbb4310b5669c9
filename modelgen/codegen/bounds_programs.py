"""Functions of CasADi as programs for the Taylor models of the core (core/base/taylor_models.c)."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from modelgen.geometry.cell_bound_expressions import COORDINATES, shape_bounds, shape_splines
from modelgen.model import ShapeKind
from modelgen.scene.expression import Cubic, Name

OPERATIONS = {  # operation of CasADi: MG_OP_ ..
    ca.OP_ADD: "ADD", ca.OP_SUB: "SUBTRACT", ca.OP_MUL: "MULTIPLY", ca.OP_DIV: "DIVIDE", ca.OP_NEG: "NEGATE",
    ca.OP_SQ: "SQUARE", ca.OP_TWICE: "TWICE", ca.OP_INV: "INVERT", ca.OP_SQRT: "SQRT", ca.OP_POW: "POWER",
    ca.OP_CONSTPOW: "POWER", ca.OP_EXP: "EXP", ca.OP_LOG: "LOG", ca.OP_SIN: "SIN", ca.OP_COS: "COS",
    ca.OP_TAN: "TAN", ca.OP_ASIN: "ASIN", ca.OP_ACOS: "ACOS", ca.OP_ATAN: "ATAN", ca.OP_ATAN2: "ATAN2",
    ca.OP_SINH: "SINH", ca.OP_COSH: "COSH", ca.OP_TANH: "TANH", ca.OP_FABS: "FABS", ca.OP_SIGN: "SIGN",
    ca.OP_FMIN: "FMIN", ca.OP_FMAX: "FMAX", ca.OP_ASSIGN: "COPY", ca.OP_LT: "LESS", ca.OP_LE: "LESS_EQUAL",
    ca.OP_EQ: "EQUAL", ca.OP_NE: "NOT_EQUAL", ca.OP_NOT: "NOT", ca.OP_AND: "AND", ca.OP_OR: "OR",
    ca.OP_IF_ELSE_ZERO: "IF_ELSE_ZERO",
}  # fmt: skip
SPLINES = 2  # the argument that has the values of splines
CONDITIONS = ("LESS", "LESS_EQUAL", "EQUAL", "NOT_EQUAL", "NOT", "AND", "OR")


def bounds_program(function: ca.Function) -> tuple[list[tuple[str, int, int, int]], list[float]]:
    """Instructions (operation, result, first and second operand) and constants of a function of SX.

    Operands and results are places in the function's memory; of CONSTANT the operand is the number of the
    constant, of INPUT the number of the argument and of its element, of SPLINE its number; the result of
    OUTPUT is the element of the output.
    """
    instructions: list[tuple[str, int, int, int]] = []
    constants: list[float] = []
    conditions: dict[int, int] = {}  # by place: number of conditions whose sum it holds
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        places, results = function.instruction_input(k), function.instruction_output(k)
        if code == ca.OP_CONST:
            value = function.instruction_constant(k)
            if value not in constants:
                constants.append(value)
            conditions[results[0]] = 0
            instructions.append(("CONSTANT", results[0], constants.index(value), 0))
        elif code == ca.OP_INPUT:
            conditions[results[0]] = 0
            if places[0] == SPLINES:
                instructions.append(("SPLINE", results[0], places[1], 0))
            else:
                instructions.append(("INPUT", results[0], places[0], places[1]))
        elif code == ca.OP_OUTPUT:
            instructions.append(("OUTPUT", results[1], places[0], 0))
        else:
            a, b = places[0], places[-1]
            operation = OPERATIONS[code]
            if operation == "DIVIDE" and conditions.get(a) == 1 and conditions.get(b) == 2:
                operation = "SHARE"
            instructions.append((operation, results[0], a, b))
            conditions[results[0]] = _conditions_added(operation, conditions.get(a, 0), conditions.get(b, 0))
    return instructions, constants


def _conditions_added(operation: str, a: int, b: int) -> int:
    """The number of conditions whose sum an operation gives, 0 for another result.

    CasADi's derivatives of min and max divide a condition by such a sum.
    """
    if operation in CONDITIONS:
        return 1
    return a + b if operation == "ADD" and a and b else 0


def spline_row(kind: ShapeKind, spline: Cubic, constants: int) -> tuple[int, ...]:
    """Coordinate, order, pieces, whether its numbers are constants, and places of its knots and coefficients.

    `constants`: those that stand before the parameters of a kind whose parameters are folded.
    """
    assert isinstance(spline.x, Name)
    names, first = kind.parameter_names, 0 if kind.folded is None else constants
    knots, coefficients = names.index("k_0"), names.index(f"{spline.axis}0_0")
    by_piece = [f"{spline.axis}{k}_{i}" for k in range(4) for i in range(spline.pieces)]
    blocks = sum(spline.pieces >> level for level in range(1, spline.pieces.bit_length()))
    by_piece += [f"{spline.axis}{4 + order}_{i}" for order in range(3) for i in range(blocks)]
    assert list(names[knots : knots + spline.pieces + 1]) == [f"k_{i}" for i in range(spline.pieces + 1)]
    assert list(names[coefficients : coefficients + len(by_piece)]) == by_piece
    is_folded = int(kind.folded is not None)
    return (
        COORDINATES[spline.x.id], spline.order, spline.pieces, is_folded, first + knots, first + coefficients,
    )  # fmt: skip


def programs_text(kinds: Sequence[ShapeKind], searched: Sequence[bool]) -> str:
    """The C table of programs of all kinds of shapes; empty for those that no search needs."""
    parts, rows = [], []
    for kind, wanted in zip(kinds, searched, strict=True):
        function = shape_bounds(kind) if wanted else None
        if function is None:
            rows.append(f"  {{0, 0, 0, 0, 0, 0}}, /* {kind.name} */")
            continue
        instructions, constants = bounds_program(function)
        name = f"mg_{kind.name}_bounds"
        lines = [f"  {{MG_OP_{code}, {out}, {a}, {b}}}," for code, out, a, b in instructions]
        rows_of_splines = [spline_row(kind, each, len(constants)) for each in shape_splines(kind)]
        if rows_of_splines and kind.folded is not None:
            constants += kind.folded
        numbers = ", ".join(repr(float(value)) for value in constants or [0.0])
        parts += [
            f"static const mg_instruction {name}[] = {{", *lines, "};",
            f"static const mg_real {name}_constants[] = {{{numbers}}};\n",
        ]  # fmt: skip
        tables = f"{name}, {name}_constants, " + (f"{name}_splines" if rows_of_splines else "0")
        if rows_of_splines:
            entries = [f"  {{{', '.join(map(str, each))}}}," for each in rows_of_splines]
            parts += [f"static const mg_bounds_spline {name}_splines[] = {{", *entries, "};\n"]
        sizes = len(instructions), function.sz_w(), function.numel_in(1)
        rows.append(f"  {{{', '.join(map(str, sizes))}, {tables}}}, /* {kind.name} */")
    table = [
        "static const mg_bounds_program mg_shape_bounds[] = {",
        *(rows or ["  {0, 0, 0, 0, 0, 0}, /* none */"]),
    ]
    return "\n".join([*parts, *table, "};\n"])
