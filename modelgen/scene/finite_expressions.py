"""Expressions of a scene: parsed at their place, and finite where they must be."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from modelgen.errors import ExpressionError
from modelgen.scene.expression import Expression, evaluate
from modelgen.scene.source_location import Place


def triple(
    texts: tuple[str, str, str], names: Collection[str], place: Place
) -> tuple[Expression, Expression, Expression]:
    """Three expressions over `names`."""
    x, y, z = (place.item(index).expression(text, names) for index, text in enumerate(texts))
    return x, y, z


def finite(expression: Expression, values: Mapping[str, float], place: Place) -> float:
    """The value of the expression, which must be finite."""
    try:
        return evaluate(expression, values)
    except ExpressionError:
        at = ", ".join(f"{name} = {value:g}" for name, value in values.items())
        found = f"{expression.text[:60]!r} has no finite value at {at}"
        raise place.error(
            found, "a finite value is required", "change the expression or its domain"
        ) from None
