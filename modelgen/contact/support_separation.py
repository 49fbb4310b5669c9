"""The separation function of two convex shapes, whose maximum over the sphere is the signed distance.

    s(n) = n.(p_f - p_o) - h_o(n) - h_f(-n),   d = max s(n) over unit n

s is concave and positively homogeneous in n; with h - rho |n| in the place of h, which is the support
function of the shape eroded by its smallest radius of curvature rho, s + (rho_o + rho_f)|n| is so too. A
critical point with d > -(rho_o + rho_f) therefore is the one maximum: the signed distance itself, with
N = n (Boyd and Vandenberghe, Convex Optimization, 2004, 8.2; Schneider, Convex Bodies, 2014, 3.2).
On the sphere, with T the tangents at n and R = T^T h'' T the radii of curvature,

    slope = T^T (P_f - P_o),   bend = R_o + R_f + s I,   Newton: bend delta = slope
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner, pair
from modelgen.contact.plane_support import support_of
from modelgen.geometry.curves import is_curve
from modelgen.geometry.frames import dot, solve2, tangent_frame
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import ContactKind, ShapeKind

AIM_INPUTS = ("pose_o", "pose_f", "eta", "parameters")
AIM_OUTPUTS = ("normal", "rounding")
SEEK_INPUTS = ("pose_o", "pose_f", "normal", "parameters")
SEEK_OUTPUTS = ("d", "slope", "bend", "tangents", "eta")

_POINTS = ("point", "point")
_SMALLEST_RADIUS: dict[str, Callable[[ca.SX], ca.SX]] = {
    "sphere": lambda p: p[0],
    "ellipsoid": lambda p: ca.mmin(p) ** 2 / ca.mmax(p),
    "superellipsoid": lambda p: ca.SX(0),
}


def has_separation(o: ShapeKind, f: ShapeKind) -> bool:
    """Both shapes are convex bodies with support maps whose points eta can be."""
    return all(
        not is_curve(shape)
        and not shape.cavity
        and shape.kind in _SMALLEST_RADIUS
        and surface_of(shape).support is not None
        for shape in (o, f)
    )


@dataclass(frozen=True)
class _Extreme:
    """The support point of a shape for a world normal of its own exterior."""

    x: ca.SX  # (3,) m, shape frame
    point: ca.SX  # (3,) m, world
    reach: ca.SX  # (1,) m, h(n)
    radii: Callable[[ca.SX], ca.SX]  # tangents (3,2), world -> R (2,2) m


def _extreme(partner: Partner, n: ca.SX) -> _Extreme:
    support_map = support_of(partner.shape)
    assert support_map is not None
    local = ca.mtimes(partner.rotation.T, n)
    support = support_map(local, partner.parameters)
    x = support.core + support.offset * local

    def radii(T: ca.SX) -> ca.SX:
        turned = ca.mtimes(partner.rotation.T, T)
        first, second = support.form(turned[:, 0]), support.form(turned[:, 1])
        mixed = (support.form(turned[:, 0] + turned[:, 1]) - first - second) / 2
        bent = ca.vertcat(ca.horzcat(first, mixed), ca.horzcat(mixed, second))
        return bent + support.offset * ca.SX.eye(2)

    return _Extreme(
        x, partner.origin + ca.mtimes(partner.rotation, x), support.height + support.offset, radii
    )


@cache
def seek_kernel(kind: ContactKind) -> ca.Function:
    """`mg_<name>_seek`: s, its slope and minus its second derivative on the sphere at a world normal.

    (pose_o, pose_f, normal(3), parameters) -> (d(1) m, slope(2) m, bend(3) m as 11 12 22,
    tangents(6) by columns, eta(6) m: both support points in their shape frames).
    """
    at = pair(kind, _POINTS)
    n = ca.SX.sym("normal", 3)
    T = tangent_frame(n)
    o, f = _extreme(at.o, n), _extreme(at.f, -n)
    between = f.point - o.point
    s = dot(n, at.f.origin - at.o.origin) - o.reach - f.reach
    bend = o.radii(T) + f.radii(T) + s * ca.SX.eye(2)
    values = (
        s,
        ca.mtimes(T.T, between),
        ca.vertcat(bend[0, 0], bend[0, 1], bend[1, 1]),
        ca.vec(T),
        ca.vertcat(o.x, f.x),
    )
    arguments = [at.o.pose, at.f.pose, n, ca.vertcat(at.o.argument, at.f.argument)]
    return _function(f"mg_{kind.name}_seek", arguments, SEEK_INPUTS, values, SEEK_OUTPUTS)


@cache
def aim_kernel(kind: ContactKind) -> ca.Function:
    """`mg_<name>_aim`: the normal to start from near known contact points; how far below 0 s has one maximum.

    (pose_o, pose_f, eta, parameters) -> (normal(3) world, of any length, rounding(1) = rho_o + rho_f, m).
    The points bring two normals n and n + m; one Newton step from both:
    (R_o + R_f + d I) delta = T^T (P_f - P_o) + R_f T^T m.
    """
    at = pair(kind, _POINTS)
    n, n_f = _normal(at.o, at.eta_o), -_normal(at.f, at.eta_f)
    T = tangent_frame(n)
    o, f = _extreme(at.o, n), _extreme(at.f, -n_f)
    between = f.point - o.point
    R_f = f.radii(T)
    bend = o.radii(T) + R_f + dot(n, between) * ca.SX.eye(2)
    delta = solve2(bend, ca.mtimes(T.T, between) + ca.mtimes([R_f, T.T, n_f - n]))
    values = (n + ca.mtimes(T, delta), _rounding(at))
    arguments = [at.o.pose, at.f.pose, at.eta, ca.vertcat(at.o.argument, at.f.argument)]
    return _function(f"mg_{kind.name}_aim", arguments, AIM_INPUTS, values, AIM_OUTPUTS)


def _normal(partner: Partner, x: ca.SX) -> ca.SX:
    """Exterior unit normal (3,), world, at a point of the shape frame."""
    equation = surface_of(partner.shape).implicit
    assert equation is not None
    gradient = equation(x, partner.parameters).gradient
    return ca.mtimes(partner.rotation, gradient / ca.sqrt(dot(gradient, gradient)))


def _rounding(at: Pair) -> ca.SX:
    radii = [_SMALLEST_RADIUS[side.shape.kind](side.parameters) for side in (at.o, at.f)]
    return radii[0] + radii[1]


def _function(
    name: str,
    arguments: list[ca.SX],
    in_names: tuple[str, ...],
    values: tuple[ca.SX, ...],
    out_names: tuple[str, ...],
) -> ca.Function:
    outputs = ca.cse([ca.densify(value) for value in values])
    return ca.Function(name, arguments, outputs, list(in_names), list(out_names))
