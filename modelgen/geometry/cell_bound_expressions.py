"""What bounds of a part of a shape are made of: position, derivatives, normal or tangent, and curvature.

The core evaluates these expressions in Taylor models over cells of the coordinates (core/closest/cells.c).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import casadi as ca

from modelgen.geometry.charts import Jet
from modelgen.geometry.curves import CurveJet, curve_of, is_curve
from modelgen.geometry.expression_translation import lowered_derivative
from modelgen.geometry.frames import cross, dot
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import exterior_sign, spline_columns, surface_of
from modelgen.geometry.surface_kernel import shape_parameters
from modelgen.model import ShapeKind
from modelgen.scene.expression import Cubic, Name
from modelgen.scene.expression_algebra import cubics_in

ORDERS = range(3)  # of the derivatives of a spline
COORDINATES = {"t": 0, "u": 0, "v": 1}


@cache
def shape_bounds(kind: ShapeKind) -> ca.Function | None:
    """The function of (coordinates, parameters, splines) that the core bounds over cells; None for a point.

    The third argument has the values of shape_splines.
    Of a surface (12 numbers): x (m), unit exterior normal n, and W (1/m) with dn = W dx, as xx, yy, zz, xy,
    xz, yz.
    Of a curve (9 numbers): x (m), unit tangent, curvature vector (1/m). Axes of the shape.
    """
    if is_point(kind):
        return None
    argument, parameters = shape_parameters(kind)
    names = {spline: f"spline_{k}" for k, spline in enumerate(shape_splines(kind))}
    splines = ca.SX.sym("splines", len(names))
    symbols = {name: parameters[k] for k, name in enumerate(kind.parameter_names)}
    symbols |= {name: splines[k] for k, name in enumerate(names.values())}
    if is_curve(kind):
        coordinates = ca.SX.sym("t")
        bounded = _of_curve(_curve_jet(kind, coordinates, parameters, symbols, names))
    else:
        coordinates = ca.SX.sym("uv", 2)
        bounded = _of_surface(kind, _surface_jet(kind, coordinates, parameters, symbols, names), parameters)
    outputs = ca.cse([ca.densify(ca.simplify(bounded))])
    return ca.Function(f"mg_{kind.name}_bounds", [coordinates, argument, splines], outputs)


@cache
def shape_splines(kind: ShapeKind) -> tuple[Cubic, ...]:
    """The splines of the coordinates in a chart or a curve, and their derivatives."""
    own = kind.curve or kind.chart
    found = [each for component in own.components for each in cubics_in(component.tree)] if own else []
    of_coordinates = [
        each for each in dict.fromkeys(found) if isinstance(each.x, Name) and each.x.id in COORDINATES
    ]
    return tuple(replace(each, order=order) for each in of_coordinates for order in ORDERS)


def _curve_jet(
    kind: ShapeKind, t: ca.SX, parameters: ca.SX, symbols: Mapping[str, ca.SX], names: Mapping[Cubic, str]
) -> CurveJet:
    if kind.curve is None or not names:
        return curve_of(kind).jet(t, parameters)
    at = {**symbols, "t": t}
    return CurveJet(*(lowered_derivative(kind.curve.components, "t" * order, at, names) for order in ORDERS))


def _surface_jet(
    kind: ShapeKind, uv: ca.SX, parameters: ca.SX, symbols: Mapping[str, ca.SX], names: Mapping[Cubic, str]
) -> Jet:
    if kind.chart is None or not names:
        return surface_of(kind).jet(uv, parameters)
    columns = ca.horzsplit(spline_columns(kind.chart, {**symbols, "u": uv[0], "v": uv[1]}, names))
    return Jet(columns[0], ca.horzcat(*columns[1:3]), ca.horzcat(*columns[3:]))


def _of_curve(jet: CurveJet) -> ca.SX:
    speed = ca.sqrt(dot(jet.first, jet.first))
    tangent = jet.first / speed
    bend = jet.second / (speed * speed)
    return ca.vertcat(jet.x, tangent, bend - tangent * dot(tangent, bend))


def _of_surface(kind: ShapeKind, jet: Jet, parameters: ca.SX) -> ca.SX:
    surface = surface_of(kind)
    if surface.implicit is None:
        normal, bend = _curvature_of_chart(jet)
    else:
        equation = surface.implicit(jet.x, parameters)
        size = ca.sqrt(dot(equation.gradient, equation.gradient))
        normal = equation.gradient / size
        across = ca.SX.eye(3) - ca.mtimes(normal, normal.T)
        hessian = equation.isotropic * ca.SX.eye(3) + equation.matrix
        bend = ca.mtimes([across, hessian, across]) / size
    sign = exterior_sign(kind)
    entries = [bend[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return ca.vertcat(jet.x, sign * normal, sign * ca.vertcat(*entries))


def _size_and_direction(vector: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Length and unit vector, which is constant where the vector is along one axis, as of a plane."""
    axes = [k for k in range(3) if not vector[k].is_zero()]
    if len(axes) == 1:
        direction = ca.SX(3, 1)
        direction[axes[0]] = ca.sign(vector[axes[0]])
        return ca.fabs(vector[axes[0]]), direction
    size = ca.sqrt(dot(vector, vector))
    return size, vector / size


def _curvature_of_chart(jet: Jet) -> tuple[ca.SX, ca.SX]:
    """Unit normal and W of a chart: W = -D' II D, with the rows of D dual to c_u and c_v."""
    c_u, c_v = jet.first[:, 0], jet.first[:, 1]
    size, normal = _size_and_direction(ca.simplify(cross(c_u, c_v)))
    dual = ca.horzcat(cross(c_v, normal), cross(normal, c_u)).T / size
    bends = [dot(normal, jet.second[:, k]) for k in range(3)]
    second = ca.vertcat(ca.horzcat(bends[0], bends[1]), ca.horzcat(bends[1], bends[2]))
    return normal, -ca.mtimes([dual.T, second, dual])
