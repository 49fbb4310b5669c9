"""Theorem 4.1 and Lemma 4.2 on two charts, as the paper writes them.

Departures: M is upper triangular (Gram-Schmidt), so that charts need not be orthogonal; the basis [x_o y_o]
that (4.5) leaves out is written; d_dot = -v_z in (4.4), hence d_dot = J u. V is the velocity of the contact
frame l_f relative to l_o in the axes of l_f (Appendix E).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import RATES_INPUTS, Rates
from modelgen.contact.normal_row import Levers, levers, rates_of
from modelgen.contact.surface_points import MontanaFrame, montana_frame
from modelgen.geometry.frames import cross, dot, solve2


@dataclass(frozen=True)
class Montana:
    """Both contact frames and the relative velocity, ready for Theorem 4.1."""

    o: MontanaFrame
    f: MontanaFrame
    axes_o: ca.SX  # (3,2) x_o, y_o in world axes
    axes_f: ca.SX  # (3,2)
    N: ca.SX  # (3,) world
    R_psi: ca.SX  # (2,2) a reflection, [x_o y_o]^T [x_f y_f]
    d: ca.SX  # (1,) m
    v: ca.SX  # (2,) m/s, v_x, v_y
    w: ca.SX  # (3,) rad/s
    levers: Levers


def montana(pair: Pair) -> Montana:
    o, f = montana_frame(pair.o, pair.eta_o), montana_frame(pair.f, pair.eta_f)
    axes_o, axes_f = ca.mtimes(pair.o.rotation, o.axes), ca.mtimes(pair.f.rotation, f.axes)
    N = ca.mtimes(pair.o.rotation, o.normal)
    at = levers(pair, o.point, f.point)
    relative = pair.f.spin_world - pair.o.spin_world
    between = at.point_f - at.point_o
    carried = at.velocity_f - at.velocity_o - cross(pair.o.spin_world, between)
    w = ca.vertcat(ca.mtimes(axes_f.T, relative), -dot(N, relative))
    R_psi = ca.mtimes(axes_o.T, axes_f)
    return Montana(o, f, axes_o, axes_f, N, R_psi, dot(N, between), ca.mtimes(axes_f.T, carried), w, at)


def chart_rates(at: Montana) -> tuple[ca.SX, ca.SX]:
    """(4.1) and (4.2): rates of the chart coordinates of o and f."""
    K_t = ca.mtimes([at.R_psi, at.o.K, at.R_psi])
    K_f = at.f.K
    w_J = ca.vertcat(-at.w[1], at.w[0])
    right_f = w_J + ca.mtimes(K_t, at.d * w_J - at.v)
    right_o = w_J + ca.mtimes(K_f, at.v)
    slip_f = solve2(K_f + K_t + at.d * ca.mtimes(K_t, K_f), right_f)
    slip_o = solve2(K_f + K_t + at.d * ca.mtimes(K_f, K_t), right_o)
    return solve2(at.o.M, ca.mtimes(at.R_psi, slip_o)), solve2(at.f.M, slip_f)


def paper_rates(pair: Pair) -> Rates:
    """Theorem 4.1 with Lemma 4.2 (4.5), Lemma 3.1 and the corrected Corollary 3.2."""
    at = montana(pair)
    rate_o, rate_f = chart_rates(at)
    slide_o, slide_f = ca.mtimes(at.o.M, rate_o), ca.mtimes(at.f.M, rate_f)
    N_dot = cross(pair.o.spin_world, at.N) + ca.mtimes([at.axes_o, at.o.K, slide_o])
    slides = ca.mtimes(at.axes_o, slide_o), ca.mtimes(at.axes_f, slide_f)
    steps = {
        "M_o": at.o.M,
        "M_f": at.f.M,
        "K_o": at.o.K,
        "K_f": at.f.K,
        "R_psi": at.R_psi,
        "V": at.v,
        "w": at.w,
    }
    return rates_of(pair, at.N, N_dot, at.levers, *slides, ca.vertcat(rate_o, rate_f), steps)


def contact_angle(pair: Pair) -> tuple[ca.SX, ca.SX]:
    """psi from dot products of the tangents, and psi_dot by (4.3), in rad and rad/s."""
    at = montana(pair)
    rate_o, rate_f = chart_rates(at)
    psi = ca.atan2(-at.R_psi[1, 0], at.R_psi[0, 0])
    return psi, at.w[2] + ca.mtimes([at.f.T, at.f.M, rate_f]) + ca.mtimes([at.o.T, at.o.M, rate_o])


def angle_function(pair: Pair, name: str) -> ca.Function:
    """`<name>`: the inputs of `rates` -> (psi, psi_dot), for users; the core needs neither."""
    o, f = pair.o, pair.f
    inputs = [o.pose, o.twist, f.pose, f.twist, pair.eta, ca.vertcat(o.argument, f.argument)]
    outputs = ca.cse(list(contact_angle(pair)))
    return ca.Function(name, inputs, outputs, list(RATES_INPUTS), ["psi", "psi_dot"])
