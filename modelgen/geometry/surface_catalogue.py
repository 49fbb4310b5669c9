"""The one table of surfaces: every fact about a shape of the catalogue, and the user's chart beside it.

Frames and parameters are those of `scene.shape_catalogue`. A cavity turns every normal round.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, pi

import casadi as ca
import numpy as np

from modelgen.geometry import charts, polynomial_pieces
from modelgen.geometry import implicit_surfaces as implicit
from modelgen.geometry import support_maps as supports
from modelgen.geometry.charts import Jet, jet_of
from modelgen.geometry.expression_translation import lower, lowered_derivative
from modelgen.geometry.implicit_surfaces import Implicit
from modelgen.geometry.support_maps import Support
from modelgen.model import ShapeKind
from modelgen.scene.expression import Cubic
from modelgen.scene.expression_algebra import has_cubic
from modelgen.scene.scene_types import Chart, Shape

SAMPLES = 33  # per direction of a user's chart, for its bounding radius

Domain = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Surface:
    """Description of one kind of surface; every callable takes the parameters last."""

    jet: Callable[[ca.SX, ca.SX], Jet]
    domain: Domain  # of (u, v)
    periodic: tuple[bool, bool]
    chart_regular: bool  # the chart has no poles
    implicit: Callable[[ca.SX, ca.SX], Implicit] | None = None
    support: Callable[[ca.SX, ca.SX], Support] | None = None
    bounding: Callable[[Sequence[float]], float] = lambda p: inf  # m, radius about the shape's origin


_GLOBE: Domain = ((-pi, pi), (-pi / 2, pi / 2))
_RING: Domain = ((-pi, pi), (-pi, pi))
_DISC: Domain = ((-1.0, 1.0), (-1.0, 1.0))
_CELL: Domain = ((0.0, 1.0), (0.0, 1.0))
_SHEET: Domain = ((-inf, inf), (-inf, inf))

SURFACES: Mapping[str, Surface] = {
    "plane": Surface(jet_of(charts.plane), _SHEET, (False, False), True, implicit.plane),
    "sphere": Surface(
        jet_of(charts.sphere), _GLOBE, (True, False), False,
        implicit.sphere, supports.sphere, lambda p: p[0],
    ),
    "ellipsoid": Surface(
        jet_of(charts.ellipsoid), _GLOBE, (True, False), False,
        implicit.ellipsoid, supports.ellipsoid, lambda p: max(p[0:3]),
    ),
    "torus": Surface(
        jet_of(charts.torus), _RING, (True, True), True,
        implicit.torus, supports.torus, lambda p: p[0] + p[1],
    ),
    "cylinder": Surface(
        jet_of(charts.cylinder), ((-pi, pi), (-inf, inf)), (True, False), True, implicit.cylinder
    ),
    "cone": Surface(jet_of(charts.cone), ((-pi, pi), (-inf, 0.0)), (True, False), True, implicit.cone),
    "conical_side": Surface(
        jet_of(charts.conical_side), ((-pi, pi), (-inf, inf)), (True, False), True, implicit.conical_side
    ),
    "paraboloid": Surface(
        jet_of(charts.paraboloid), _SHEET, (False, False), True, implicit.paraboloid
    ),
    "superellipsoid": Surface(
        charts.superellipsoid, _GLOBE, (True, False), False,
        implicit.superellipsoid, supports.superellipsoid,
        lambda p: (p[0] ** 2 + p[1] ** 2 + p[2] ** 2) ** 0.5,
    ),
    "bezier": Surface(
        polynomial_pieces.bezier, _CELL, (False, False), True, bounding=polynomial_pieces.bezier_radius
    ),
    "bezier_graph": Surface(
        polynomial_pieces.bezier_graph, _CELL, (False, False), True,
        polynomial_pieces.bezier_graph_equation, bounding=polynomial_pieces.bezier_graph_radius,
    ),
    "cap": Surface(polynomial_pieces.cap, _DISC, (False, False), True, bounding=polynomial_pieces.cap_radius),
    "round_cap": Surface(
        polynomial_pieces.round_cap, _DISC, (False, False), True, bounding=polynomial_pieces.round_cap_radius
    ),
}  # fmt: skip


def surface_of(shape: ShapeKind | Shape) -> Surface:
    """The surface of a kind of the catalogue or of the user's own chart."""
    if shape.chart is None:
        return SURFACES[shape.kind]
    names = (
        shape.parameter_names if isinstance(shape, ShapeKind) else tuple(name for name, _ in shape.parameters)
    )
    return _user_surface(shape.chart, names)


@lru_cache(maxsize=512)
def _user_surface(chart: Chart, names: tuple[str, ...]) -> Surface:
    """A user's chart: the exterior is the side that c_u x c_v points to."""

    def components(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
        symbols = {"u": u, "v": v} | {name: p[i] for i, name in enumerate(names)}
        return ca.vertcat(*(lower(expression, symbols) for expression in chart.components))

    def jet_of_splines(uv: ca.SX, p: ca.SX) -> Jet:
        columns = ca.horzsplit(_spline_jet(chart, names)(uv, p))
        return Jet(columns[0], ca.horzcat(*columns[1:3]), ca.horzcat(*columns[3:]))

    has_spline = any(has_cubic(each.tree) for each in chart.components)
    return Surface(
        jet_of_splines if has_spline else jet_of(components),
        chart.domain,
        chart.periodic,
        chart_regular=True,
        bounding=lambda p: _sampled_radius(chart, names, p),
    )


@lru_cache(maxsize=64)
def _spline_jet(chart: Chart, names: tuple[str, ...]) -> ca.Function:
    """uv (2), parameters -> (3,6) c, c_u, c_v, c_uu, c_uv, c_vv, by the derivatives of its splines."""
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(names))
    symbols = {"u": uv[0], "v": uv[1]} | {name: p[i] for i, name in enumerate(names)}
    return ca.Function("jet", [uv, p], ca.cse([ca.densify(spline_columns(chart, symbols, {}))]))


def spline_columns(chart: Chart, symbols: Mapping[str, ca.SX], splines: Mapping[Cubic, str]) -> ca.SX:
    """(3,6) c, c_u, c_v, c_uu, c_uv, c_vv of a chart; `splines` as of lowered_derivative."""
    orders = ("", "u", "v", "uu", "uv", "vv")
    return ca.horzcat(*(lowered_derivative(chart.components, order, symbols, splines) for order in orders))


@lru_cache(maxsize=64)
def _point(chart: Chart, names: tuple[str, ...]) -> ca.Function:
    """uv (2), parameters -> point (3)."""
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(names))
    symbols = {"u": uv[0], "v": uv[1]} | {name: p[i] for i, name in enumerate(names)}
    x = ca.vertcat(*(lower(expression, symbols) for expression in chart.components))
    return ca.Function("point", [uv, p], [ca.densify(x)])


def _sampled_radius(chart: Chart, names: tuple[str, ...], p: Sequence[float]) -> float:
    """Largest distance from the origin on a grid, plus the largest step of the grid."""
    u, v = (np.linspace(*ends, SAMPLES) for ends in chart.domain)
    grid = np.array([entry.ravel() for entry in np.meshgrid(u, v, indexing="ij")])
    x = np.asarray(_point(chart, names)(grid, ca.DM(list(p)))).reshape(3, SAMPLES, SAMPLES)
    steps = (np.linalg.norm(np.diff(x, axis=axis), axis=0).max() for axis in (1, 2))
    return float(np.linalg.norm(x, axis=0).max() + max(steps))


def exterior_sign(shape: ShapeKind | Shape) -> float:
    """+1, or -1 for a cavity, whose material lies on the other side."""
    return -1.0 if shape.cavity else 1.0
