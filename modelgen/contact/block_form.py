"""Two charts without frames: the block form of the extremality system.

With E = R [c_u c_v], I = E_o^T E_o, X = E_o^T E_f, B_o, B_f the second fundamental forms (convex positive)
and dV the relative velocity of the material points,

    [ I + d B_o         -X  ] [alpha_o_dot]   [ E_o^T (dV - d w_o x N) ]
    [ X^T I^-1 B_o      B_f ] [alpha_f_dot] = [ E_f^T ((w_f - w_o) x N) ]

eliminated by X, which is regular on every extremal pair; the Schur complement of I + d B_o is not, at a
focal distance of o.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.normal_row import Levers, levers, rates_of
from modelgen.contact.singularity_margin import margin
from modelgen.contact.surface_points import chart_jet, chart_normal, montana_frame, second_form
from modelgen.geometry.frames import cross, dot, solve2


@dataclass(frozen=True)
class Block:
    """Tangents, normal and fundamental forms of both charts, world axes."""

    E_o: ca.SX  # (3,2) m
    E_f: ca.SX  # (3,2) m
    N: ca.SX  # (3,)
    d: ca.SX  # (1,) m
    B_o: ca.SX  # (2,2) m
    B_f: ca.SX  # (2,2) m
    X: ca.SX  # (2,2) m^2, E_o^T E_f
    shape_o: ca.SX  # (2,2) 1, I^-1 B_o: rate of N per rate of alpha_o, in the basis E_o
    metric: ca.SX  # (2,2) m^2, I
    levers: Levers


def block(pair: Pair) -> Block:
    jet_o, jet_f = chart_jet(pair.o, pair.eta_o), chart_jet(pair.f, pair.eta_f)
    n_o, n_f = chart_normal(pair.o, jet_o), chart_normal(pair.f, jet_f)
    E_o, E_f = ca.mtimes(pair.o.rotation, jet_o.first), ca.mtimes(pair.f.rotation, jet_f.first)
    N = ca.mtimes(pair.o.rotation, n_o)
    at = levers(pair, jet_o.x, jet_f.x)
    mixed = dot(jet_o.first[:, 0], jet_o.first[:, 1])
    metric = ca.vertcat(
        ca.horzcat(dot(jet_o.first[:, 0], jet_o.first[:, 0]), mixed),
        ca.horzcat(mixed, dot(jet_o.first[:, 1], jet_o.first[:, 1])),
    )
    B_o, B_f = second_form(n_o, jet_o), second_form(n_f, jet_f)
    d = dot(N, at.point_f - at.point_o)
    return Block(E_o, E_f, N, d, B_o, B_f, ca.mtimes(E_o.T, E_f), solve2(metric, B_o), metric, at)


def solve_block(at: Block, right_o: ca.SX, right_f: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Rates of the chart coordinates of o and f for given right-hand sides (2,), (2,)."""
    upper = at.metric + at.d * at.B_o
    through = solve2(at.X, ca.horzcat(upper, right_o))
    A = ca.mtimes(at.X.T, at.shape_o) + ca.mtimes(at.B_f, through[:, 0:2])
    rate_o = solve2(A, right_f + ca.mtimes(at.B_f, through[:, 2]))
    return rate_o, ca.mtimes(through[:, 0:2], rate_o) - through[:, 2]


def block_rates(pair: Pair) -> Rates:
    """The block form with Lemma 3.1 and the corrected Corollary 3.2."""
    at = block(pair)
    w_o, w_f = pair.o.spin_world, pair.f.spin_world
    turned = cross(w_o, at.N)
    dV = at.levers.velocity_f - at.levers.velocity_o
    right_o = ca.mtimes(at.E_o.T, dV - at.d * turned)
    rate_o, rate_f = solve_block(at, right_o, ca.mtimes(at.E_f.T, cross(w_f - w_o, at.N)))
    N_dot = turned + ca.mtimes([at.E_o, at.shape_o, rate_o])
    slides = ca.mtimes(at.E_o, rate_o), ca.mtimes(at.E_f, rate_f)
    steps = {"metric": at.metric, "B_o": at.B_o, "B_f": at.B_f, "X": at.X}
    return rates_of(pair, at.N, N_dot, at.levers, *slides, ca.vertcat(rate_o, rate_f), steps)


def block_place(pair: Pair) -> Placement:
    """Newton step eta - g_eta^-1 g with the block matrix in the place of g_eta, equal to it where g = 0."""
    at = block(pair)
    between = at.levers.point_f - at.levers.point_o
    right_o, right_f = ca.mtimes(at.E_o.T, between), -ca.mtimes(at.E_f.T, at.N)
    step = ca.vertcat(*solve_block(at, right_o, right_f))
    return chart_placement(pair, at.N, at.d, at.levers, pair.eta + step)


def chart_placement(pair: Pair, N: ca.SX, d: ca.SX, at: Levers, eta_next: ca.SX) -> Placement:
    """The record of a chart form: residuals in orthonormal frames and of the normals, and the margin."""
    o, f = montana_frame(pair.o, pair.eta_o), montana_frame(pair.f, pair.eta_f)
    T_o = ca.mtimes(pair.o.rotation, o.axes)
    in_f = ca.mtimes(pair.f.rotation.T, T_o)
    turn = ca.mtimes(f.axes.T, in_f)
    e1, e2 = ca.mtimes(T_o.T, at.point_f - at.point_o), N + ca.mtimes(pair.f.rotation, f.normal)
    return Placement(
        eta_next=eta_next,
        d=d,
        residual=ca.vertcat(ca.sqrt(dot(e1, e1)), ca.sqrt(dot(e2, e2))),
        margin=margin(o.K, ca.mtimes([turn.T, f.K, turn]), d),
        normal=N,
        point_o=at.point_o,
        point_f=at.point_f,
    )
