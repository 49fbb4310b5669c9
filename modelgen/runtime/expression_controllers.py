"""A controller that is given as expressions, as a CasADi function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from modelgen.errors import ExpressionError, SimulationError, nearest
from modelgen.geometry.casadi_expressions import lower
from modelgen.scene.expression import Expression, parse_expression

LETTERS = {3: "xyz", 4: "wxyz"}  # of the components of a sensor


def function_of(
    expressions: Mapping[str, str], inputs: Sequence[str], sensors: Sequence[tuple[str, int]]
) -> ca.Function:
    """The function (t, sensors) -> (inputs) of expressions by input; raises SimulationError."""
    symbols = {name: ca.SX.sym(name, size) for name, size in sensors}
    known = {"t": ca.SX.sym("t")}
    for name, symbol in symbols.items():
        letters = LETTERS.get(symbol.numel(), "")
        names = [f"{name}_{letter}" for letter in letters] or [name]
        known |= dict(zip(names, ca.vertsplit(symbol), strict=True))
    found = {name: lower(_parsed(name, text, inputs, known), known) for name, text in expressions.items()}
    given = {"t": known["t"], **symbols}
    return ca.Function("commands", list(given.values()), list(found.values()), list(given), list(found))


def _parsed(name: str, text: str, inputs: Sequence[str], known: Mapping[str, ca.SX]) -> Expression:
    if name not in inputs:
        allowed = "inputs: " + ", ".join(inputs)
        raise SimulationError("controller", f"a command for {name!r}", allowed, nearest(str(name), inputs))
    try:
        return parse_expression(text, known)
    except ExpressionError as error:
        where = f"controller: {name}: in {error.where}"
        raise SimulationError(where, error.found, error.allowed, error.remedy) from None
