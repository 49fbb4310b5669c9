"""A curve against a chart without frames: Theorem 4.6 as the block form of the extremality system.

As the block form of two charts, with E_f = R_f c_f', B_f = N.R_f c_f'' and X = E_o^T E_f, a column of two.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.curve_surface import CurveSystem
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.normal_row import Levers, jet_of_curve, levers, rates_of
from modelgen.contact.singularity_margin import curve_margin
from modelgen.contact.surface_points import chart_jet, chart_normal, montana_frame, second_form
from modelgen.geometry.frames import cross, dot, solve2


@dataclass(frozen=True)
class CurveBlock:
    """Tangents, normal and fundamental forms of the chart and the curve, world axes."""

    E_o: ca.SX  # (3,2) m
    E_f: ca.SX  # (3,) m
    N: ca.SX  # (3,)
    d: ca.SX  # (1,) m
    B_o: ca.SX  # (2,2) m
    shape_o: ca.SX  # (2,2) 1, I^-1 B_o
    metric: ca.SX  # (2,2) m^2, I
    system: CurveSystem  # of (alpha_o_dot, t_dot)
    levers: Levers


def curve_block(pair: Pair) -> CurveBlock:
    jet_o, jet_f = chart_jet(pair.o, pair.eta_o), jet_of_curve(pair.f, pair.eta_f)
    n_o = chart_normal(pair.o, jet_o)
    N = ca.mtimes(pair.o.rotation, n_o)
    E_o, E_f = ca.mtimes(pair.o.rotation, jet_o.first), ca.mtimes(pair.f.rotation, jet_f.first)
    at = levers(pair, jet_o.x, jet_f.x)
    d = dot(N, at.point_f - at.point_o)
    metric, B_o = ca.mtimes(jet_o.first.T, jet_o.first), second_form(n_o, jet_o)
    shape_o, X = solve2(metric, B_o), ca.mtimes(E_o.T, E_f)
    beta = dot(N, ca.mtimes(pair.f.rotation, jet_f.second))
    system = CurveSystem(metric + d * B_o, X, ca.mtimes(shape_o.T, X), beta)
    return CurveBlock(E_o, E_f, N, d, B_o, shape_o, metric, system, at)


def curve_block_rates(pair: Pair) -> Rates:
    """The block form with Lemma 3.1 and the corrected Corollary 3.2."""
    at = curve_block(pair)
    w_o, w_f = pair.o.spin_world, pair.f.spin_world
    turned = cross(w_o, at.N)
    dV = at.levers.velocity_f - at.levers.velocity_o
    right = ca.mtimes(at.E_o.T, dV - at.d * turned)
    rate_o, rate_f = at.system.solve(right, dot(at.E_f, cross(w_f - w_o, at.N)))
    N_dot = turned + ca.mtimes([at.E_o, at.shape_o, rate_o])
    slides = ca.mtimes(at.E_o, rate_o), at.E_f * rate_f
    steps = {"metric": at.metric, "B_o": at.B_o, "B_f": at.system.beta, "X": at.system.e}
    return rates_of(pair, at.N, N_dot, at.levers, *slides, ca.vertcat(rate_o, rate_f), steps)


def curve_block_place(pair: Pair) -> Placement:
    """Newton step with the block matrix in the place of g_eta, equal to it where g = 0."""
    at = curve_block(pair)
    right = ca.mtimes(at.E_o.T, at.levers.point_f - at.levers.point_o)
    step = ca.vertcat(*at.system.solve(right, -dot(at.E_f, at.N)))
    return chart_curve_placement(pair, at.N, at.levers, at.E_f, at.system.beta, pair.eta + step)


def chart_curve_placement(
    pair: Pair, N: ca.SX, at: Levers, E_f: ca.SX, beta: ca.SX, eta_next: ca.SX
) -> Placement:
    """The record of a form with a chart and a curve: residuals in orthonormal frames, and the margin."""
    frame = montana_frame(pair.o, pair.eta_o)
    T = ca.mtimes(pair.o.rotation, frame.axes)
    between = at.point_f - at.point_o
    d, e, e1, e2 = dot(N, between), ca.mtimes(T.T, E_f), ca.mtimes(T.T, between), dot(E_f, N)
    system = CurveSystem(ca.SX.eye(2) + d * frame.K, e, ca.mtimes(frame.K, e), beta)
    return Placement(
        eta_next=eta_next,
        d=d,
        residual=ca.vertcat(ca.sqrt(dot(e1, e1)), ca.fabs(e2) / ca.sqrt(dot(E_f, E_f))),
        margin=curve_margin(frame.K, system.matrix, e, beta, d),
        normal=N,
        point_o=at.point_o,
        point_f=at.point_f,
    )
