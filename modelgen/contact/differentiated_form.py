"""The differentiated form: the extremality system of two charts, by implicit differentiation.

    g(eta, q) = [ E_o^T (P_f - P_o) ; E_f^T N ] = 0,   eta_dot = -g_eta^-1 g_q q_dot

instead of (2.1), which is void at P_f = P_o; gamma is the derivative of J u along (q_dot, eta_dot)
with u held. Everything after g and J is algorithmic differentiation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from modelgen.contact.block_form import chart_placement
from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.normal_row import Levers, feet, jacobian_rows, levers, passing
from modelgen.contact.surface_points import chart_jet, chart_normal
from modelgen.geometry.frames import cross, dot, solve2


@dataclass(frozen=True)
class Extremality:
    """g and what it is made of."""

    g_o: ca.SX  # (2,) m^2, E_o^T (P_f - P_o)
    g_f: ca.SX  # (2,) m, E_f^T N
    N: ca.SX  # (3,) world
    levers: Levers


def extremality(pair: Pair) -> Extremality:
    """The four equations whose root is the pair of extremal points."""
    jet_o, jet_f = chart_jet(pair.o, pair.eta_o), chart_jet(pair.f, pair.eta_f)
    N = ca.mtimes(pair.o.rotation, chart_normal(pair.o, jet_o))
    at = levers(pair, jet_o.x, jet_f.x)
    E_o, E_f = ca.mtimes(pair.o.rotation, jet_o.first), ca.mtimes(pair.f.rotation, jet_f.first)
    return Extremality(ca.mtimes(E_o.T, at.point_f - at.point_o), ca.mtimes(E_f.T, N), N, at)


def solve_extremality(pair: Pair, system: Extremality, right_o: ca.SX, right_f: ca.SX) -> ca.SX:
    """g_eta^-1 (right_o, right_f), eliminated by the block d g_o/d alpha_f = E_o^T E_f, always regular."""
    G_oo, X = ca.jacobian(system.g_o, pair.eta)[:, 0:2], ca.jacobian(system.g_o, pair.eta)[:, 2:4]
    G_fo, G_ff = ca.jacobian(system.g_f, pair.eta)[:, 0:2], ca.jacobian(system.g_f, pair.eta)[:, 2:4]
    through = solve2(X, ca.horzcat(G_oo, right_o))
    A = G_fo - ca.mtimes(G_ff, through[:, 0:2])
    step_o = solve2(A, right_f - ca.mtimes(G_ff, through[:, 2]))
    return ca.vertcat(step_o, through[:, 2] - ca.mtimes(through[:, 0:2], step_o))


def pose_rate(partner: Partner) -> ca.SX:
    """Time derivative of the pose argument: p_dot = v, R_dot = R hat(w) with w in body axes."""
    if partner.columns == 0:
        return ca.SX(partner.pose.shape[0], 1)
    if partner.columns == 3:
        return ca.vertcat(partner.velocity, ca.SX(9, 1))
    R, w = ca.reshape(partner.pose[3:12], 3, 3), partner.twist[3:6]
    columns = [cross(ca.mtimes(R, w), R[:, k]) for k in range(3)]
    return ca.vertcat(partner.velocity, *columns)


def along(pair: Pair, x: ca.SX, eta_dot: ca.SX) -> ca.SX:
    """Time derivative of x(q, eta) along the motion, twists held."""
    rate = ca.jtimes(x, pair.eta, eta_dot)
    for side in (pair.o, pair.f):
        if side.pose.shape[0]:
            rate += ca.jtimes(x, side.pose, pose_rate(side))
    return rate


def slides(pair: Pair, at: Levers, eta_dot: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Velocities of the contact points over both shapes, world axes."""
    over_o, over_f = ca.jtimes(at.l_o, pair.eta, eta_dot), ca.jtimes(at.l_f, pair.eta, eta_dot)
    return ca.mtimes(pair.o.rotation, over_o), ca.mtimes(pair.f.rotation, over_f)


def differentiated_rates(pair: Pair) -> Rates:
    """Two surfaces: eta_dot by implicit differentiation of g."""
    system = extremality(pair)
    still = ca.SX(4, 1)
    moved_o, moved_f = (along(pair, g, still) for g in (system.g_o, system.g_f))
    eta_dot = -solve_extremality(pair, system, moved_o, moved_f)
    equations = {"g_o": system.g_o, "g_f": system.g_f}
    return rates_by_differentiation(pair, system.N, system.levers, eta_dot, equations)


def rates_by_differentiation(
    pair: Pair, N: ca.SX, at: Levers, eta_dot: ca.SX, equations: Mapping[str, ca.SX]
) -> Rates:
    """N_dot and gamma by differentiation of N and of J u along the motion."""
    J_o, J_f = jacobian_rows(pair, N, at)
    u_o, u_f = pair.o.twist[: pair.o.columns], pair.f.twist[: pair.f.columns]
    speed = ca.mtimes(J_o.T, u_o) + ca.mtimes(J_f.T, u_f)
    N_dot = along(pair, N, eta_dot)
    foot_o, foot_f = feet(pair, N, at)
    return Rates(
        d=dot(N, at.point_f - at.point_o),
        J_o=J_o,
        J_f=J_f,
        gamma=along(pair, speed, eta_dot),
        eta_dot=eta_dot,
        normal=N,
        normal_rate=N_dot,
        turning=pair.o.seen(N, N_dot),
        foot_o=foot_o,
        foot_f=foot_f,
        passing=passing(pair, at, *slides(pair, at, eta_dot)),
        steps={"normal": N, "point_o": at.point_o, "point_f": at.point_f, **equations},
    )


def differentiated_place(pair: Pair) -> Placement:
    """Newton step with the exact g_eta."""
    system = extremality(pair)
    step = solve_extremality(pair, system, system.g_o, system.g_f)
    return chart_placement(pair, system.N, _gap(system), system.levers, pair.eta - step)


def _gap(system: Extremality) -> ca.SX:
    return dot(system.N, system.levers.point_f - system.levers.point_o)
