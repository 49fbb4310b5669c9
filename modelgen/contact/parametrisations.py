"""Parametrisations of the contact points of both sides, and the forms that work with any of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import casadi as ca

from modelgen.contact.centre_and_surface import centre_surface_place, centre_surface_rates
from modelgen.contact.contact_symbols import Layout, Pair, Partner
from modelgen.contact.curve_surface import curve_surface_place, curve_surface_rates
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.newton_step import tangent_place
from modelgen.contact.sphere_centres import has_centre
from modelgen.contact.surface_points import SurfacePoint, chart_point, implicit_point, plane_point
from modelgen.contact.tangent_plane_form import tangent_rates
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import ShapeKind

_POINTS: Mapping[str, Callable[[Partner, ca.SX], SurfacePoint]] = {
    "none": lambda partner, eta: plane_point(partner),
    "chart": chart_point,
    "point": implicit_point,
}


def point_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """Points on implicit surfaces; a plane o needs none."""
    return ("none" if o.kind == "plane" else "point", "point")


def chart_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    return ("chart", "chart")


def mixed_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """The chart on the side without an implicit equation; on f if both have one."""
    if surface_of(o).implicit is None:
        return ("chart", "point")
    return (point_layout(o, f)[0], "chart")


def no_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    return ("none", "none")


def curve_point_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """A point of an implicit surface, none of a plane, and a curve's parameter."""
    return (point_layout(o, f)[0], "curve")


def curve_chart_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    return ("chart", "curve")


def curves_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """Two curve parameters, then the signs of N against E_o x E_f and of d."""
    return ("curve", "signed_curve")


def centre_surface_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """The point of the surface, or its chart; none of the centre, which stands on o where f has none."""
    surface = o if has_centre(f) else f
    parametrisation = "chart" if surface_of(surface).implicit is None else "point"
    return (parametrisation, "none") if has_centre(f) else ("none", parametrisation)


def centre_curve_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """The parameter of the curve."""
    return ("curve", "none") if has_centre(f) else ("none", "curve")


def edges_layout(o: ShapeKind, f: ShapeKind) -> Layout:
    """The sign of N against E_o x E_f."""
    return ("sign", "none")


def surface_rates(pair: Pair) -> Rates:
    """The tangent-plane form, with any parametrisation of the points."""
    return tangent_rates(pair, *_surface_points(pair))


def surface_place(pair: Pair) -> Placement:
    return tangent_place(pair, *_surface_points(pair))


def curve_on_surface_rates(pair: Pair) -> Rates:
    """Theorem 4.6 with any parametrisation of the point of the surface."""
    return curve_surface_rates(pair, _POINTS[pair.layout[0]](pair.o, pair.eta_o))


def curve_on_surface_place(pair: Pair) -> Placement:
    return curve_surface_place(pair, _POINTS[pair.layout[0]](pair.o, pair.eta_o))


def centre_on_surface_rates(pair: Pair) -> Rates:
    """A centre with any parametrisation of the point of the surface."""
    return centre_surface_rates(pair, _facing_point(pair))


def centre_on_surface_place(pair: Pair) -> Placement:
    return centre_surface_place(pair, _facing_point(pair))


def _facing_point(pair: Pair) -> SurfacePoint:
    partner = pair.o if has_centre(pair.f.shape) else pair.f
    return _POINTS[pair.layout[0] if partner is pair.o else pair.layout[1]](partner, pair.eta)


def _surface_points(pair: Pair) -> tuple[SurfacePoint, SurfacePoint]:
    return _POINTS[pair.layout[0]](pair.o, pair.eta_o), _POINTS[pair.layout[1]](pair.f, pair.eta_f)
