"""Curve against curve: Theorem 4.3, Lemma 4.4 and Corollary 4.5 as two scalar equations.

With E_i = R_i c_i' and B_o = -N.R_o c_o'', B_f = N.R_f c_f''

    [ |E_o|^2 + d B_o        -E_o.E_f      ] [t_o_dot]   [  E_o.(dV - d w_o x N) ]
    [     -E_o.E_f       |E_f|^2 + d B_f   ] [t_f_dot] = [ -E_f.(dV - d w_f x N) ]

N has two expressions, sign E_o x E_f/|E_o x E_f| and side (P_f - P_o)/|P_f - P_o|, side the sign of d. An
error of t turns the first by curvature/sin(psi), the second by 1/d: the second is taken where
|d| (k_o + k_f) > |sin psi|. Each sign is constant where its expression is taken; the Newton step renews the
other, so that N is continuous through parallel tangents at a gap and through d = 0 of crossing tangents.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.normal_row import Levers, jet_of_curve, levers, rates_of
from modelgen.contact.singularity_margin import crossing_margin
from modelgen.geometry.frames import cross, dot, solve2, zeros


@dataclass(frozen=True)
class Crossing:
    """Both curves at their points, world axes."""

    E_o: ca.SX  # (3,) m per parameter
    E_f: ca.SX  # (3,)
    bend_o: ca.SX  # (3,) R_o c_o''
    bend_f: ca.SX  # (3,)
    between: ca.SX  # (3,) m, P_f - P_o
    apart: ca.SX  # (1,) whether N is taken from the difference of the points
    sign: ca.SX  # (1,) of N against E_o x E_f, as eta carries it
    side: ca.SX  # (1,) of d, as eta carries it
    N: ca.SX  # (3,)
    d: ca.SX  # (1,) m
    levers: Levers


def crossing(pair: Pair) -> Crossing:
    t_o, t_f, sign, side = ca.vertsplit(pair.eta)
    jet_o, jet_f = jet_of_curve(pair.o, t_o), jet_of_curve(pair.f, t_f)
    E_o, E_f = ca.mtimes(pair.o.rotation, jet_o.first), ca.mtimes(pair.f.rotation, jet_f.first)
    at = levers(pair, jet_o.x, jet_f.x)
    between, across = at.point_f - at.point_o, cross(E_o, E_f)
    speed_o, speed_f = ca.sqrt(dot(E_o, E_o)), ca.sqrt(dot(E_f, E_f))
    curvature = _curvature(jet_o.first, jet_o.second) / speed_o**3
    curvature += _curvature(jet_f.first, jet_f.second) / speed_f**3
    distance, sine = ca.sqrt(dot(between, between)), ca.sqrt(dot(across, across)) / (speed_o * speed_f)
    apart = distance * curvature > sine
    direction = ca.if_else(apart, side * between, sign * across)
    N = direction / ca.sqrt(dot(direction, direction))
    bends = ca.mtimes(pair.o.rotation, jet_o.second), ca.mtimes(pair.f.rotation, jet_f.second)
    return Crossing(E_o, E_f, *bends, between, apart, sign, side, N, dot(N, between), at)


def _curvature(first: ca.SX, second: ca.SX) -> ca.SX:
    """|c' x c''|, the curvature times |c'|^3."""
    area = cross(first, second)
    return ca.sqrt(dot(area, area))


def crossing_rates(pair: Pair) -> Rates:
    """The block form with Lemma 3.1 and the corrected Corollary 3.2."""
    at = crossing(pair)
    E_o, E_f, N, d, w_o, w_f = at.E_o, at.E_f, at.N, at.d, pair.o.spin_world, pair.f.spin_world
    B_o, B_f, X = -dot(N, at.bend_o), dot(N, at.bend_f), dot(E_o, E_f)
    dV = at.levers.velocity_f - at.levers.velocity_o
    right = ca.vertcat(dot(E_o, dV - d * cross(w_o, N)), -dot(E_f, dV - d * cross(w_f, N)))
    rate = solve2(_rows(dot(E_o, E_o) + d * B_o, dot(E_f, E_f) + d * B_f, X), right)
    slide_o, slide_f = E_o * rate[0], E_f * rate[1]
    turn_o, turn_f = dot(cross(w_o, N), E_o) + B_o * rate[0], dot(cross(w_f, N), E_f) - B_f * rate[1]
    crossed = turn_o * cross(E_f, N) + turn_f * cross(N, E_o)
    moved = dV + slide_f - slide_o
    numerator = ca.if_else(at.apart, moved - dot(N, moved) * N, crossed)
    N_dot = numerator / ca.if_else(at.apart, d, dot(cross(E_o, E_f), N))
    steps = {"E_o": E_o, "E_f": E_f, "B_o": B_o, "B_f": B_f, "X": X}
    eta_dot = ca.vertcat(rate, zeros(2))
    return rates_of(pair, N, N_dot, at.levers, slide_o, slide_f, eta_dot, steps)


def crossing_place(pair: Pair) -> Placement:
    """Newton step on E_o.(P_f - P_o) = E_f.(P_f - P_o) = 0 with their exact derivatives; renewed signs."""
    at = crossing(pair)
    E_o, E_f, between = at.E_o, at.E_f, at.between
    size_o, size_f, X = dot(E_o, E_o), dot(E_f, E_f), dot(E_o, E_f)
    e_o, e_f = dot(E_o, between), dot(E_f, between)
    bent_o, bent_f = size_o - dot(at.bend_o, between), size_f + dot(at.bend_f, between)
    step = solve2(_rows(bent_o, bent_f, X), ca.vertcat(e_o, -e_f))
    aligned = _sign(dot(at.N, cross(E_o, E_f)))
    signs = ca.vertcat(ca.if_else(at.apart, aligned, at.sign), ca.if_else(at.apart, at.side, _sign(at.d)))
    return Placement(
        eta_next=ca.vertcat(pair.eta[0:2] + step, signs),
        d=at.d,
        residual=ca.vertcat(ca.sqrt(e_o * e_o / size_o + e_f * e_f / size_f), zeros(1)),
        margin=crossing_margin(bent_o / size_o, bent_f / size_f, X / ca.sqrt(size_o * size_f)),
        normal=at.N,
        point_o=at.levers.point_o,
        point_f=at.levers.point_f,
    )


def _rows(first: ca.SX, last: ca.SX, X: ca.SX) -> ca.SX:
    return ca.vertcat(ca.horzcat(first, -X), ca.horzcat(-X, last))


def _sign(x: ca.SX) -> ca.SX:
    return 2 * (x >= 0) - 1
