"""Plane against a convex shape with a support map: no eta at all.

The contact point of f is the support point at its exterior normal n_f = -n, the plane's normal turned into
f's shape axes. With m = n_f_dot = (w_f - w_o) x n, in f's axes, (3.11) corrected and K_o = 0 give

    d = N.(p_f - p_o) - h(n_f),   J = (-N, -l_o x n | N, l_f x n),   b = x'(n_f) m
    gamma = -b.m - (w_f x n).(w_f x l_f) + (w_o x n).(w_o x l_o) + 2 (w_o x n).V
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Foot, Placement, Rates
from modelgen.contact.singularity_margin import FLOOR, NO_LENGTH, singular_values
from modelgen.contact.surface_points import implicit_point
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.frames import cross, dot, tangent_frame, zeros
from modelgen.geometry.points import is_point
from modelgen.geometry.support_maps import Support, point
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.model import ShapeKind

STRICTLY_CONVEX = ("sphere", "ellipsoid", "superellipsoid")


@dataclass(frozen=True)
class SupportTouch:
    """Plane o and support point of f; vectors in f's shape axes unless said otherwise."""

    N: ca.SX  # (3,) world
    n_o: ca.SX  # (3,) N in o's shape axes, where it is an axis
    n: ca.SX  # (3,)
    support: Support
    between: ca.SX  # (3,) m, world, from o's to f's centre of mass
    l_f: ca.SX  # (3,) m, from f's centre of mass to the core point
    d: ca.SX  # (1,) m


def support_of(shape: ShapeKind) -> Callable[[ca.SX, ca.SX], Support] | None:
    """The support map of a shape that has one."""
    if is_point(shape):
        return point
    return (curve_of(shape) if is_curve(shape) else surface_of(shape)).support


def support_touch(pair: Pair) -> SupportTouch:
    plane_normal = ca.vertcat(zeros(2), exterior_sign(pair.o.shape))
    N = ca.mtimes(pair.o.rotation, plane_normal)
    n = ca.mtimes(pair.f.rotation.T, N)
    support_map = support_of(pair.f.shape)
    assert support_map is not None
    support = support_map(-n, pair.f.parameters)
    between = pair.f.centre - pair.o.centre
    d = dot(N, between) + dot(n, pair.f.arm) - dot(plane_normal, pair.o.arm) - support.height - support.offset
    return SupportTouch(N, plane_normal, n, support, between, pair.f.arm + support.core, d)


def support_rates(pair: Pair) -> Rates:
    """Lemma 3.1 and Corollary 3.2 (signs corrected) for a plane and a support point.

    o's lever and turning stay in o's axes, where the plane's normal is an axis.
    """
    at = support_touch(pair)
    to_o, to_f = pair.o.rotation.T, pair.f.rotation.T
    l_o = ca.mtimes(to_o, at.between + ca.mtimes(pair.f.rotation, at.l_f))
    turn_o, slip_o = cross(pair.o.spin, at.n_o), cross(pair.o.spin, l_o)
    turn_f, slip_f = cross(pair.f.spin, at.n), cross(pair.f.spin, at.l_f)
    turn_o_world = ca.mtimes(pair.o.rotation, turn_o)
    turn_o_f = ca.mtimes(to_f, turn_o_world)
    m = turn_f - turn_o_f
    gamma = -at.support.form(m) - dot(turn_f, slip_f) - dot(turn_o, slip_o)
    gamma += 2 * (dot(turn_o_world, pair.f.velocity - pair.o.velocity) + dot(turn_o_f, slip_f))
    slide = at.support.slope(m)
    past = pair.f.velocity - pair.o.velocity + ca.mtimes(pair.f.rotation, slip_f + slide)
    return Rates(
        d=at.d,
        J_o=pair.o.row(-at.N, -cross(l_o, at.n_o)),
        J_f=pair.f.row(at.N, cross(at.l_f, at.n)),
        gamma=gamma,
        eta_dot=ca.SX(0, 1),
        normal=at.N,
        normal_rate=turn_o_world,
        turning=zeros(3),
        foot_o=_foot_of_plane(pair.o.arm, l_o, ca.mtimes(to_o, past) - slip_o, at.n_o),
        foot_f=Foot(at.l_f, slide, at.n, -at.support.offset),
        steps={"normal": at.N, "n_f": -at.n, "l_f": at.l_f, "m": m},
    )


def _foot_of_plane(arm: ca.SX, above: ca.SX, past: ca.SX, normal: ca.SX) -> Foot:
    """The foot of the core point that is `above` the plane and moves `past` it, shape axes of o."""
    return Foot(ca.vertcat(above[0:2], arm[2]), ca.vertcat(past[0:2], zeros(1)), normal)


def _margin(pair: Pair, at: SupportTouch, x_f: ca.SX) -> ca.SX:
    """(mu, sigma_min(K_f)): nothing is solved for, so that curvatures of very different size cost no digits.

    mu = 1 where f meets every plane in one point, flat there or not; it is sigma_min times the size of f
    where f may lie along a circle. Of a curve x_f'(n_f) is e e^T/kappa_f, and S = kappa_f against a plane.
    """
    if is_point(pair.f.shape):
        return ca.SX([1, NO_LENGTH])
    T = tangent_frame(at.n)
    if is_curve(pair.f.shape):
        sigma = 1 / ca.fmax(at.support.form(T[:, 0]) + at.support.form(T[:, 1]), FLOOR)
    else:
        sigma = singular_values(implicit_point(pair.f, x_f).curvature(T))[1]
    if pair.f.shape.kind in STRICTLY_CONVEX:
        return ca.vertcat(1, sigma)
    return ca.vertcat(ca.fmin(1, ca.sum1(pair.f.parameters) * sigma), sigma)


def support_place(pair: Pair) -> Placement:
    """Gap, points and margin; there is nothing to correct."""
    at = support_touch(pair)
    x_f = at.support.core - at.support.offset * at.n
    point_f = pair.f.centre + ca.mtimes(pair.f.rotation, pair.f.arm + x_f)
    return Placement(
        eta_next=ca.SX(0, 1),
        d=at.d,
        residual=zeros(2),
        margin=_margin(pair, at, x_f),
        normal=at.N,
        point_o=point_f - at.d * at.N,
        point_f=point_f,
    )
