"""Boundaries and parameter lines of surfaces as curves: one coordinate held, the other is t.

The equations of the catalogue are trees like those of the user's charts, so that the curve is composed of
the surface's own components and parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

from modelgen.scene.expression import Name, number, parse_expression
from modelgen.scene.expression_algebra import expression_of, substitute
from modelgen.scene.scalar_types import NUMBER
from modelgen.scene.scene_types import Chart, Curve
from modelgen.scene.shape_catalogue import CHART_FIELDS, SHAPES
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Sequence, Table, Tagged
from modelgen.scene.user_chart import check_curve, check_interval, read_chart

Interval = tuple[float, float]
Ends = tuple[Interval | None, Interval | None]

_TURN = (-pi, pi)
_POLE_TO_POLE = (-pi / 2, pi / 2)

# The charts of `geometry.charts`: components, and the domains of u and v where they have ends.
CHARTS: Mapping[str, tuple[tuple[str, str, str], Ends]] = {
    "plane": (("u", "v", "0"), (None, None)),
    "sphere": (
        ("radius*cos(v)*cos(u)", "radius*cos(v)*sin(u)", "radius*sin(v)"),
        (_TURN, _POLE_TO_POLE),
    ),
    "ellipsoid": (("a*cos(v)*cos(u)", "b*cos(v)*sin(u)", "c*sin(v)"), (_TURN, _POLE_TO_POLE)),
    "torus": (
        ("(major + minor*cos(v))*cos(u)", "(major + minor*cos(v))*sin(u)", "minor*sin(v)"),
        (_TURN, _TURN),
    ),
    "cylinder": (("radius*cos(u)", "radius*sin(u)", "v"), (_TURN, None)),
    "cone": (("-v*tan(half_angle)*cos(u)", "-v*tan(half_angle)*sin(u)", "v"), (_TURN, None)),
    "paraboloid": (("u", "v", "u*u/(2*rho_x) + v*v/(2*rho_y)"), (None, None)),
}

_SURFACE = Tagged(
    "kind",
    "the surface: one of the catalogue, or chart",
    {kind: Table(SHAPES[kind].fields) for kind in CHARTS} | {"chart": Table(CHART_FIELDS)},
)

LINE_FIELDS = (
    Field(
        "surface", _SURFACE, "the surface that the line lies on, in the frame of this shape", required=True
    ),
    Field("u", NUMBER, "u of the line, which then runs along v"),
    Field("v", NUMBER, "v of the line, which then runs along u"),
    Field("domain", Sequence(NUMBER, 2), "[t_min, t_max] of the other coordinate; all of it if absent"),
)


def read_surface_line(values: Mapping[str, Any], place: Place) -> tuple[Curve, tuple[tuple[str, float], ...]]:
    """The curve and its parameters; raises SceneError."""
    held = [name for name in "uv" if values[name] is not None]
    if not held:
        raise place.error("neither u nor v", "one of u, v is held", "add u = ... or v = ...")
    chart, parameters, bounded = _chart(values["surface"], place.key("surface"))
    fixed, running = ("u", "v") if held == ["u"] else ("v", "u")
    if "t" in dict(parameters):
        raise place.key("surface").error(
            "a parameter named 't'", "t runs along the line", "give it another name"
        )
    domain = values["domain"] or bounded["uv".index(running)]
    if domain is None:
        raise place.error(f"no domain, while {running} has no ends", "", "add domain = [t_min, t_max]")
    check_interval(domain, place.key("domain"))
    by = {fixed: number(values[fixed]), running: Name("t")}
    x, y, z = (expression_of(substitute(component.tree, by)) for component in chart.components)
    curve = Curve((x, y, z), domain, values["domain"] is None and chart.periodic["uv".index(running)])
    if "t" not in x.names | y.names | z.names:
        raise place.key(fixed).error(
            f"a pole of the surface at {values[fixed]:g}", "", "choose a line with length"
        )
    check_curve(curve, dict(parameters), place.key("surface"))
    return curve, parameters


def _chart(values: Mapping[str, Any], place: Place) -> tuple[Chart, tuple[tuple[str, float], ...], Ends]:
    """The surface's chart, parameters, and the ends of u and of v where they have any."""
    if values["kind"] == "chart":
        chart = read_chart(values, place)
        return chart, values["parameters"], chart.domain
    spec = SHAPES[values["kind"]]
    numbers = spec.values(values)
    broken = spec.constraint(numbers)
    if broken:
        raise place.error(broken, spec.rule)
    texts, bounded = CHARTS[spec.kind]
    x, y, z = (parse_expression(text, ("u", "v", *spec.parameters)) for text in texts)
    u, v = bounded
    chart = Chart((x, y, z), (u or _TURN, v or _TURN), (u == _TURN, v == _TURN))
    return chart, tuple(zip(spec.parameters, numbers, strict=True)), bounded
