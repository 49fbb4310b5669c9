"""Charts that are surfaces of revolution about z, by their expressions: r(v) cos u, +-r(v) sin u, z(v)."""

from __future__ import annotations

from modelgen.scene.expression import Binary, Expression, Name, Node, Number, Unary
from modelgen.scene.expression_algebra import cos, expression_of, sin, substitute, times
from modelgen.scene.scene_types import Chart, Curve

U, T, ZERO = Name("u"), Name("t"), Number(0.0)


def meridian_of_chart(chart: Chart) -> tuple[Curve, bool] | None:
    """The meridian (r(t), 0, z(t)) of a chart of revolution, and whether y is -r(v) sin u; None of others."""
    x, y, z = (each.tree for each in chart.components)
    turned = isinstance(y, Unary)
    y = y.x if isinstance(y, Unary) else y
    if not (isinstance(x, Binary) and isinstance(y, Binary) and chart.periodic[0]):
        return None
    if (x, y) != (times(x.a, cos(U)), times(x.a, sin(U))):
        return None
    if "u" in expression_of(x.a).names | expression_of(z).names:
        return None
    return Curve((_by_t(x.a), expression_of(ZERO), _by_t(z)), chart.domain[1], chart.periodic[1]), turned


def _by_t(tree: Node) -> Expression:
    return expression_of(substitute(tree, {"v": T}))
