"""Theorems 4.3 and 4.6 as the paper writes them: contact frames, arc length rates, psi and phi.

The contact frame of a curve has x along its tangent and z = N on body o, z = -N on body f. Then
k sin(phi) = -z.c''/|c'|^2 and k cos(phi) = y.c''/|c'|^2 need no Frenet frame; phi and its rate do, and are
defined where the curve is bent. Corrected signs: (4.11) has a minus on its right side, as (4.27) does, and
d_dot = -v_z in (4.12) and (4.28).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.curve_curve import crossing
from modelgen.contact.curve_surface import CurveSystem
from modelgen.contact.kernels import RATES_INPUTS, Rates
from modelgen.contact.normal_row import Levers, jet_of_curve, levers, rates_of
from modelgen.contact.surface_points import chart_jet, chart_normal, montana_frame
from modelgen.geometry.frames import cross, dot, solve2, zeros


@dataclass(frozen=True)
class Strand:
    """A curve at its contact point: contact frame in world axes, speed |c'|, k sin(phi) and k cos(phi)."""

    axes: ca.SX  # (3,2) x, y
    speed: ca.SX  # (1,) m per parameter
    normal_curvature: ca.SX  # (1,) 1/m, k sin(phi), positive if convex
    geodesic_curvature: ca.SX  # (1,) 1/m, k cos(phi)


def strand(partner: Partner, t: ca.SX, z: ca.SX) -> Strand:
    jet = jet_of_curve(partner, t)
    E, bend = ca.mtimes(partner.rotation, jet.first), ca.mtimes(partner.rotation, jet.second)
    square = dot(E, E)
    speed = ca.sqrt(square)
    x = E / speed
    y = cross(z, x)
    return Strand(ca.horzcat(x, y), speed, -dot(z, bend) / square, dot(y, bend) / square)


@dataclass(frozen=True)
class Relative:
    """Velocity of the contact frame of f relative to that of o at rest, in the axes of f (Appendix E)."""

    v: ca.SX  # (2,) m/s, v_x, v_y
    w: ca.SX  # (3,) rad/s


def relative(pair: Pair, N: ca.SX, at: Levers, axes_f: ca.SX) -> Relative:
    turn = pair.f.spin_world - pair.o.spin_world
    carried = at.velocity_f - at.velocity_o - cross(pair.o.spin_world, at.point_f - at.point_o)
    return Relative(ca.mtimes(axes_f.T, carried), ca.vertcat(ca.mtimes(axes_f.T, turn), -dot(N, turn)))


@dataclass(frozen=True)
class Theorem:
    """What Theorems 4.3 and 4.6 state: rates of the contact points, of N, and of the angles."""

    N: ca.SX  # (3,)
    N_dot: ca.SX  # (3,) 1/s
    levers: Levers
    slide_o: ca.SX  # (3,) m/s, world
    slide_f: ca.SX  # (3,)
    eta_dot: ca.SX
    R_psi: ca.SX  # (2,2)
    psi_dot: ca.SX  # rad/s
    twists: tuple[tuple[Partner, ca.SX, ca.SX, ca.SX, ca.SX], ...]  # side, t, z, tau l_dot + phi_dot, t_dot
    steps: dict[str, ca.SX]


def curve_surface_theorem(pair: Pair) -> Theorem:
    """Theorem 4.6, (4.26), (4.27) and (4.29), and Lemma 4.2."""
    o, t = montana_frame(pair.o, pair.eta_o), pair.eta_f
    N = ca.mtimes(pair.o.rotation, chart_normal(pair.o, chart_jet(pair.o, pair.eta_o)))
    at = levers(pair, o.point, jet_of_curve(pair.f, t).x)
    f, axes_o = strand(pair.f, t, -N), ca.mtimes(pair.o.rotation, o.axes)
    V, R_psi = relative(pair, N, at, f.axes), ca.mtimes(axes_o.T, f.axes)
    d = dot(N, at.point_f - at.point_o)
    K_t = ca.mtimes([R_psi, o.K, R_psi])
    system = CurveSystem(ca.SX.eye(2) + d * K_t, ca.vertcat(1, zeros(1)), K_t[:, 0], f.normal_curvature)
    turned, l_f = system.solve(V.v, -V.w[1])
    slide = ca.mtimes(R_psi, turned)  # M_o alpha_o_dot
    alpha_dot, t_dot = solve2(o.M, slide), l_f / f.speed
    twist = ca.mtimes(K_t, turned)[1] - V.w[0]
    return Theorem(
        N, cross(pair.o.spin_world, N) + ca.mtimes([axes_o, o.K, slide]), at,
        ca.mtimes(axes_o, slide), f.axes[:, 0] * l_f, ca.vertcat(alpha_dot, t_dot), R_psi,
        V.w[2] + ca.mtimes(o.T, slide) + f.geodesic_curvature * l_f,
        ((pair.f, t, -N, twist, t_dot),),
        {"M_o": o.M, "K_o": o.K, "R_psi": R_psi, "V": V.v, "w": V.w},
    )  # fmt: skip


def curves_theorem(pair: Pair) -> Theorem:
    """Theorem 4.3, (4.10) to (4.13), without the two phi_dot, and the normal's rate by (C.2)."""
    at, t_o, t_f = crossing(pair), pair.eta[0], pair.eta[1]
    N, d = at.N, at.d
    o, f = strand(pair.o, t_o, N), strand(pair.f, t_f, -N)
    V, R_psi = relative(pair, N, at.levers, f.axes), ca.mtimes(o.axes.T, f.axes)
    k_o, k_f, c, s = o.normal_curvature, f.normal_curvature, R_psi[0, 0], -R_psi[0, 1]
    rows = ca.vertcat(ca.horzcat(-c, 1 + d * k_f), ca.horzcat(-(s * s + d * k_o), -c * d * k_f))
    right = ca.vertcat(-(V.v[0] + d * V.w[1]), s * V.v[1] + c * d * V.w[1])
    rate = solve2(rows, right)
    l_o, l_f = rate[0], rate[1]
    twist_o = -(k_f * l_f + V.w[1] + c * k_o * l_o) / s
    turned = ca.vertcat(k_o * l_o, -twist_o)
    twist_f = ca.mtimes(R_psi, turned)[1] - V.w[0]
    t_dot = ca.vertcat(l_o / o.speed, l_f / f.speed)
    return Theorem(
        N, cross(pair.o.spin_world, N) + ca.mtimes(o.axes, turned), at.levers,
        o.axes[:, 0] * l_o, f.axes[:, 0] * l_f, ca.vertcat(t_dot, zeros(2)), R_psi,
        V.w[2] + o.geodesic_curvature * l_o + f.geodesic_curvature * l_f,
        ((pair.o, t_o, N, twist_o, t_dot[0]), (pair.f, t_f, -N, twist_f, t_dot[1])),
        {"K_o": k_o, "K_f": k_f, "R_psi": R_psi, "V": V.v, "w": V.w},
    )  # fmt: skip


def theorem_rates(pair: Pair, at: Theorem) -> Rates:
    """With Lemma 3.1 and the corrected Corollary 3.2."""
    return rates_of(pair, at.N, at.N_dot, at.levers, at.slide_o, at.slide_f, at.eta_dot, at.steps)


def angles_function(pair: Pair, at: Theorem, name: str) -> ca.Function:
    """`<name>`: the inputs of `rates` -> psi, psi_dot, then phi and phi_dot of each curve, rad and rad/s."""
    found = {"psi": ca.atan2(-at.R_psi[1, 0], at.R_psi[0, 0]), "psi_dot": at.psi_dot}
    for partner, t, z, twist, t_dot in at.twists:
        side = "o" if partner is pair.o else "f"
        found[f"phi_{side}"], torsion = _frenet(partner, t, z)
        found[f"phi_{side}_dot"] = twist - torsion * t_dot
    o, f = pair.o, pair.f
    inputs = [o.pose, o.twist, f.pose, f.twist, pair.eta, ca.vertcat(o.argument, f.argument)]
    outputs = ca.cse([ca.densify(value) for value in found.values()])
    return ca.Function(name, inputs, outputs, list(RATES_INPUTS), list(found))


def _frenet(partner: Partner, t: ca.SX, z: ca.SX) -> tuple[ca.SX, ca.SX]:
    """phi = atan2(-z.n, z.b), and |c'| tau = |c'| det(c', c'', c''')/|c' x c''|^2."""
    jet = jet_of_curve(partner, t)
    z = ca.mtimes(partner.rotation.T, z)
    binormal = cross(jet.first, jet.second)
    principal, square = cross(binormal, jet.first), dot(binormal, binormal)
    speed = ca.sqrt(dot(jet.first, jet.first))
    third = ca.jacobian(jet.second, t)
    return ca.atan2(-dot(z, principal) / speed, dot(z, binormal)), speed * dot(binormal, third) / square
