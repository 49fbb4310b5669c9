"""Surfaces as charts c(u, v), ordered so that c_u x c_v points to the exterior, with two derivatives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from modelgen.geometry.frames import dot, zeros
from modelgen.geometry.implicit_surfaces import superellipsoid as superellipsoid_gauge


@dataclass(frozen=True)
class Jet:
    """A chart and its partial derivatives at (u, v)."""

    x: ca.SX  # (3,) m
    first: ca.SX  # (3,2) c_u, c_v
    second: ca.SX  # (3,3) c_uu, c_uv, c_vv


def jet_of(components: Callable[[ca.SX, ca.SX, ca.SX], ca.SX]) -> Callable[[ca.SX, ca.SX], Jet]:
    """The jet of a chart given by its three components as functions of u, v and the parameters."""

    def jet(uv: ca.SX, p: ca.SX) -> Jet:
        symbols = ca.SX.sym("uv", 2)
        x = components(symbols[0], symbols[1], p)
        first = ca.jacobian(x, symbols)
        u_row = ca.jacobian(first[:, 0], symbols)
        second = ca.horzcat(u_row, ca.jacobian(first[:, 1], symbols)[:, 1])
        values = ca.substitute([x, first, second], [symbols], [uv])
        return Jet(*values)

    return jet


def plane(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(u, v, zeros(1))


def sphere(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Longitude u, latitude v."""
    return p[0] * direction(u, v)


def ellipsoid(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Longitude u, latitude v; not orthogonal unless a = b."""
    return p * direction(u, v)


def torus(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Azimuth u around the axis, v around the tube."""
    out = p[0] + p[1] * ca.cos(v)
    return ca.vertcat(out * ca.cos(u), out * ca.sin(u), p[1] * ca.sin(v))


def cylinder(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Azimuth u, height v."""
    return ca.vertcat(p[0] * ca.cos(u), p[0] * ca.sin(u), v)


def cone(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Azimuth u, height v < 0; the apex v = 0 is singular."""
    radius = -v * ca.tan(p[0])
    return ca.vertcat(radius * ca.cos(u), radius * ca.sin(u), v)


def conical_side(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    """Azimuth u, height v; radius p[0] at v = 0, smaller by p[1] for each metre up."""
    radius = p[0] - v * p[1]
    return ca.vertcat(radius * ca.cos(u), radius * ca.sin(u), v)


def paraboloid(u: ca.SX, v: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(u, v, u * u / (2 * p[0]) + v * v / (2 * p[1]))


def direction(u: ca.SX, v: ca.SX) -> ca.SX:
    """The unit vector of longitude u and latitude v."""
    return ca.vertcat(ca.cos(v) * ca.cos(u), ca.cos(v) * ca.sin(u), ca.sin(v))


def superellipsoid(uv: ca.SX, p: ca.SX) -> Jet:
    """The radial projection e -> s e, s = exp(h), of the sphere e(u, v) onto the superellipsoid.

    F(s e) = 1 gives by implicit differentiation, with x = s e, g = F' and H = F'' at x,
    h_a = -s g.e_a/(g.x) and h_ab = -(x_a.H x_b + g.(s (e_ab + h_a e_b + h_b e_a + h_a h_b e)))/(g.x).
    """
    e = jet_of(lambda u, v, p: direction(u, v))(uv, p)
    s = _radial_scale(e.x, p)
    x = s * e.x
    F = superellipsoid_gauge(x, p)
    g, radial = F.gradient, dot(F.gradient, x)
    h = [-s * dot(g, e.first[:, a]) / radial for a in range(2)]
    first = [s * (e.first[:, a] + h[a] * e.x) for a in range(2)]
    second = []
    for k, (a, b) in enumerate(((0, 0), (0, 1), (1, 1))):
        bent = s * (e.second[:, k] + h[a] * e.first[:, b] + h[b] * e.first[:, a] + h[a] * h[b] * e.x)
        h_ab = -(dot(first[a], F.hessian_times(first[b])) + dot(g, bent)) / radial
        second.append(bent + h_ab * x)
    return Jet(x, ca.horzcat(*first), ca.horzcat(*second))


def _radial_scale(e: ca.SX, p: ca.SX) -> ca.SX:
    """s with F(s e) = 1 where F + 1 is homogeneous: degree q in all of x."""
    return (superellipsoid_gauge(e, p).value + 1) ** (-1 / p[4])
