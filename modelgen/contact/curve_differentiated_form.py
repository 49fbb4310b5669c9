"""The differentiated forms with a curve: extremality systems, by implicit differentiation.

    curve and chart: g = [ E_o^T (P_f - P_o) ; E_f.N ]
    two curves:      g = [ E_o.(P_f - P_o) ; E_f.(P_f - P_o) ]

eta_dot = -g_eta^-1 g_q q_dot and gamma = d/dt (J u) with u held, by algorithmic differentiation of g and J.
"""

from __future__ import annotations

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.curve_block_form import chart_curve_placement, curve_block
from modelgen.contact.curve_curve import crossing, crossing_place
from modelgen.contact.curve_surface import CurveSystem
from modelgen.contact.differentiated_form import along, rates_by_differentiation
from modelgen.contact.kernels import Placement, Rates
from modelgen.geometry.frames import dot, solve2, zeros


def curve_differentiated_rates(pair: Pair) -> Rates:
    """A curve on a chart."""
    at, g = curve_block(pair), _on_surface(pair)
    moved = along(pair, g, ca.SX(3, 1))
    return rates_by_differentiation(pair, at.N, at.levers, -_solve_on_surface(pair, g, moved), {"g": g})


def curve_differentiated_place(pair: Pair) -> Placement:
    """Newton step with the exact g_eta."""
    at, g = curve_block(pair), _on_surface(pair)
    eta_next = pair.eta - _solve_on_surface(pair, g, g)
    return chart_curve_placement(pair, at.N, at.levers, at.E_f, at.system.beta, eta_next)


def _on_surface(pair: Pair) -> ca.SX:
    at = curve_block(pair)
    return ca.vertcat(ca.mtimes(at.E_o.T, at.levers.point_f - at.levers.point_o), dot(at.E_f, at.N))


def _solve_on_surface(pair: Pair, g: ca.SX, right: ca.SX) -> ca.SX:
    """g_eta^-1 right."""
    G = ca.jacobian(g, pair.eta)
    system = CurveSystem(G[0:2, 0:2], -G[0:2, 2], G[2, 0:2].T, G[2, 2])
    return ca.vertcat(*system.solve(right[0:2], right[2]))


def curves_differentiated_rates(pair: Pair) -> Rates:
    """Two curves; N from the expression that eta's signs are for."""
    at = crossing(pair)
    g = ca.vertcat(dot(at.E_o, at.between), dot(at.E_f, at.between))
    rate = -solve2(ca.jacobian(g, pair.eta)[:, 0:2], along(pair, g, ca.SX(4, 1)))
    return rates_by_differentiation(pair, at.N, at.levers, ca.vertcat(rate, zeros(2)), {"g": g})


curves_differentiated_place = crossing_place  # its Newton step has the exact derivatives
