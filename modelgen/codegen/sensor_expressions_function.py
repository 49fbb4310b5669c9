"""Expressions of time, sensors and inputs as CasADi functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from modelgen.errors import ExpressionError, SimulationError
from modelgen.geometry.expression_translation import lower
from modelgen.notation import component_names
from modelgen.scene.expression import Expression, parse_expression


def expressions_function(
    expressions: Mapping[str, str], slots: Sequence[tuple[str, int]], where: str
) -> ca.Function:
    """The function (t, one argument a slot) -> (one number an expression), all by name.

    Expressions are of t and of the components of the slots, such as sensors: `lean`, `tip_x`, `turn_w`.
    Raises SimulationError, whose place begins with `where`, if one is none.
    """
    symbols = {name: ca.SX.sym(name, size) for name, size in slots}
    known = {"t": ca.SX.sym("t")}
    for name, symbol in symbols.items():
        names = component_names([(name, symbol.numel())])
        known |= dict(zip(names, ca.vertsplit(symbol), strict=True))
    found = {
        name: lower(_parsed(text, known, f"{where}: {name}"), known) for name, text in expressions.items()
    }
    given = {"t": known["t"], **symbols}
    return ca.Function("expressions", list(given.values()), list(found.values()), list(given), list(found))


def _parsed(text: object, known: Mapping[str, ca.SX], where: str) -> Expression:
    if not isinstance(text, str):
        raise SimulationError(where, f"a {type(text).__name__}", "an expression, as text", 'write "2*t"')
    try:
        return parse_expression(text, known)
    except ExpressionError as error:
        place = f"{where}: in {error.where}"
        raise SimulationError(place, error.found, error.allowed, error.remedy) from None
