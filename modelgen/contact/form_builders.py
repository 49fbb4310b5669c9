"""How each form builds its kernels; the table that lists them is in `contact.form_table`."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from modelgen.contact.block_form import block_place, block_rates
from modelgen.contact.centre_and_curve import centre_curve_place, centre_curve_rates
from modelgen.contact.contact_symbols import Layout, Pair, pair
from modelgen.contact.curve_block_form import curve_block_place, curve_block_rates
from modelgen.contact.curve_curve import crossing_place, crossing_rates
from modelgen.contact.curve_differentiated_form import (
    curve_differentiated_place,
    curve_differentiated_rates,
    curves_differentiated_place,
    curves_differentiated_rates,
)
from modelgen.contact.differentiated_form import differentiated_place, differentiated_rates
from modelgen.contact.edge_edge import edge_edge_place, edge_edge_rates
from modelgen.contact.kernels import ContactKernels, Placement, Rates
from modelgen.contact.paper_curves import (
    Theorem,
    angles_function,
    curve_surface_theorem,
    curves_theorem,
    theorem_rates,
)
from modelgen.contact.paper_surfaces import angle_function, paper_rates
from modelgen.contact.parametrisations import (
    centre_curve_layout,
    centre_on_surface_place,
    centre_on_surface_rates,
    centre_surface_layout,
    chart_layout,
    curve_chart_layout,
    curve_on_surface_place,
    curve_on_surface_rates,
    curve_point_layout,
    curves_layout,
    edges_layout,
    mixed_layout,
    no_layout,
    point_layout,
    surface_place,
    surface_rates,
)
from modelgen.contact.plane_support import support_place, support_rates
from modelgen.contact.tangential_rows import with_tangential_rows
from modelgen.contact.two_centres import two_centres_place, two_centres_rates
from modelgen.model import ContactKind, ShapeKind


def _build(
    kind: ContactKind,
    layout: Callable[[ShapeKind, ShapeKind], Layout],
    rates: Callable[[Pair], Rates],
    place: Callable[[Pair], Placement],
) -> ContactKernels:
    symbols = pair(kind, layout(kind.o.shape, kind.f.shape))
    return ContactKernels(
        kind,
        symbols,
        lambda: with_tangential_rows(symbols, rates(symbols), kind.rows),
        lambda: place(symbols),
    )


def build_explicit(kind: ContactKind) -> ContactKernels:
    """Two centres, or a centre and a plane; no eta. A point is a centre with rho = 0.

    N = s (C_f - C_o)/|C_f - C_o|,  d = s |C_f - C_o| - rho_o - rho_f,  rho and s negative for a cavity;
    against a plane N is the plane's normal and d = N.(C_f - p_o) - rho_f.
    """
    if kind.o.shape.kind == "plane":
        return build_support(kind)
    return _build(kind, no_layout, two_centres_rates, two_centres_place)


def build_support(kind: ContactKind) -> ContactKernels:
    """A plane and the support map x_f(n_f) of a convex shape, n_f = -N; no eta.

    d = N.(p_f - p_o) - h(n_f),  gamma = -m.x_f'(n_f) m + centripetal terms of (3.11), signs corrected,
    with m = (w_f - w_o) x N.
    """
    return _build(kind, no_layout, support_rates, support_place)


def build_implicit(kind: ContactKind) -> ContactKernels:
    """Theorem 4.1 in one tangent frame; eta = contact points in the shape frames, on phi(x) = 0.

    n = phi'/|phi'| and K = T^T phi'' T/|phi'|: no chart, no pole, no trigonometry. A plane needs no eta.
    (K_f + K_o + d K_o K_f) b = (I + d K_o) w^t - K_o V,  nu = w^t - K_f b,  a = V + b - d nu.
    """
    return _build(kind, point_layout, surface_rates, surface_place)


def build_mixed(kind: ContactKind) -> ContactKernels:
    """As "implicit", with chart coordinates on one side: alpha_dot = M^-1 [x y]^T (slide over the surface).

    M is upper triangular (Gram-Schmidt), where the paper's diagonal M holds for orthogonal charts only.
    """
    return _build(kind, mixed_layout, surface_rates, surface_place)


def build_block(kind: ContactKind) -> ContactKernels:
    """The block form of the extremality system on two charts: no frames, no orthogonality, no psi.

    [I + d B_o, -X; X^T I^-1 B_o, B_f] (alpha_o_dot, alpha_f_dot)
        = (E_o^T (dV - d w_o x N), E_f^T (w_f - w_o) x N)
    """
    return _build(kind, chart_layout, block_rates, block_place)


def build_paper(kind: ContactKind) -> ContactKernels:
    """Theorem 4.1, (4.1) and (4.2), and Lemma 4.2 as the paper writes them, with M, K and R_psi.

    Departures: M upper triangular, the basis [x_o y_o] of (4.5) written, d_dot = -v_z in (4.4), and the
    centripetal signs of (3.11) reversed.
    """
    return _build(kind, chart_layout, paper_rates, surface_place)


def build_angle(kind: ContactKind) -> ca.Function:
    """`mg_<name>_angle`: the inputs of the rates on two charts -> psi (rad), psi_dot (rad/s) of (4.3).

    psi turns the first tangent of f to that of o about N,
    psi_dot = w_z + T_f M_f alpha_f_dot + T_o M_o alpha_o_dot.
    """
    return angle_function(pair(kind, chart_layout(kind.o.shape, kind.f.shape)), f"mg_{kind.name}_angle")


def build_differentiated(kind: ContactKind) -> ContactKernels:
    """Implicit differentiation of g = (E_o^T (P_f - P_o), E_f^T N) = 0 in the place of (2.1).

    eta_dot = -g_eta^-1 g_q q_dot, gamma = d/dt (J u) with u held.
    """
    return _build(kind, chart_layout, differentiated_rates, differentiated_place)


def build_curve_implicit(kind: ContactKind) -> ContactKernels:
    """Theorem 4.6 in the tangent frame of an implicit surface; eta = its point, and the curve's parameter t.

    (I + d K_o) a - e t_dot = V,  e.K_o a + beta t_dot = e.w^t,  e = T^T c', beta = N.c'': any regular
    parameter, no arc length, no Frenet frame. A plane needs no point.
    """
    return _build(kind, curve_point_layout, curve_on_surface_rates, curve_on_surface_place)


def build_curve_block(kind: ContactKind) -> ContactKernels:
    """The block form of the extremality system on a chart and a curve.

    [I + d B_o, -X; X^T I^-1 B_o, B_f] (alpha_o_dot, t_dot)
        = (E_o^T (dV - d w_o x N), E_f.(w_f - w_o) x N),  E_f = R_f c_f', B_f = N.R_f c_f''
    """
    return _build(kind, curve_chart_layout, curve_block_rates, curve_block_place)


def build_curve_paper(kind: ContactKind) -> ContactKernels:
    """Theorem 4.6, (4.26) and (4.27), and Lemma 4.2 as the paper writes them.

    k sin(phi) = -z.c''/|c'|^2. Departures: any parameter, l_f_dot = |c'| t_dot; d_dot = -v_z in
    (4.28); M_o upper triangular.
    """
    return _build(kind, curve_chart_layout, _stated(curve_surface_theorem), curve_block_place)


def build_curves_paper(kind: ContactKind) -> ContactKernels:
    """Theorem 4.3 as the paper writes it, the two phi_dot eliminated; void where sin(psi) = 0.

    Departures: any parameter, l_dot = |c'| t_dot; the missing minus of (4.11); d_dot = -v_z in (4.12);
    consequently (4.20), (4.22), (4.23) and (4.25) with the opposite signs.
    """
    return _build(kind, curves_layout, _stated(curves_theorem), crossing_place)


def _stated(theorem: Callable[[Pair], Theorem]) -> Callable[[Pair], Rates]:
    return lambda pair: theorem_rates(pair, theorem(pair))


def build_curve_angles(kind: ContactKind) -> ca.Function:
    """`mg_<name>_angle`: psi, psi_dot of (4.29), phi_f, phi_f_dot of (4.27), rad and rad/s.

    psi_dot = w_z + T_o M_o alpha_o_dot + k_f cos(phi_f) l_f_dot; phi_f where the curve is bent.
    """
    symbols = pair(kind, curve_chart_layout(kind.o.shape, kind.f.shape))
    return angles_function(symbols, curve_surface_theorem(symbols), f"mg_{kind.name}_angle")


def build_curves_angles(kind: ContactKind) -> ca.Function:
    """`mg_<name>_angle`: psi, psi_dot of (4.13); phi and phi_dot of o, then of f, (4.11); rad and rad/s.

    psi_dot = w_z + k_o cos(phi_o) l_o_dot + k_f cos(phi_f) l_f_dot; each phi where its curve is bent.
    """
    symbols = pair(kind, curves_layout(kind.o.shape, kind.f.shape))
    return angles_function(symbols, curves_theorem(symbols), f"mg_{kind.name}_angle")


def build_curve_differentiated(kind: ContactKind) -> ContactKernels:
    """Implicit differentiation of g = (E_o^T (P_f - P_o), E_f.N) = 0 on a chart and a curve."""
    return _build(kind, curve_chart_layout, curve_differentiated_rates, curve_differentiated_place)


def build_curves_block(kind: ContactKind) -> ContactKernels:
    """The block form on two curves; eta = (t_o, t_f) and the two signs that make N continuous.

    [|E_o|^2 + d B_o, -E_o.E_f; -E_o.E_f, |E_f|^2 + d B_f] (t_o_dot, t_f_dot)
        = (E_o.(dV - d w_o x N), -E_f.(dV - d w_f x N));  N from the cross product of the tangents, or from
    the difference of the points where |d| (k_o + k_f) > |sin psi|.
    """
    return _build(kind, curves_layout, crossing_rates, crossing_place)


def build_curves_differentiated(kind: ContactKind) -> ContactKernels:
    """Implicit differentiation of g = (E_o.(P_f - P_o), E_f.(P_f - P_o)) = 0 on two curves."""
    return _build(kind, curves_layout, curves_differentiated_rates, curves_differentiated_place)


def build_centre_surface(kind: ContactKind) -> ContactKernels:
    """A sphere or a point against any surface; eta = the point of the surface, or its chart.

    (I + h K) a = V,  h = n.(C - x) = d + rho,  d_dot = n.V: C is the centre, n the surface's normal, rho the
    signed radius, 0 of a point; no curvature of the sphere, no relative rotation.
    """
    return _build(kind, centre_surface_layout, centre_on_surface_rates, centre_on_surface_place)


def build_centre_curve(kind: ContactKind) -> ContactKernels:
    """A sphere or a point against any curve; eta = the curve's parameter.

    (|E|^2 - h N.R c'') t_dot = E.(V - h w x N),  N = (C - X)/h,  h = d + rho = |C - X|, the curve on o.
    """
    return _build(kind, centre_curve_layout, centre_curve_rates, centre_curve_place)


def build_edge_edge(kind: ContactKind) -> ContactKernels:
    """Two straight edges in closed form; eta = the sign of N against E_o x E_f.

    N = sign E_o x E_f/|E_o x E_f|,  d = N.(X_f - X_o),  N_dot from N.E_o = N.E_f = 0.
    """
    return _build(kind, edges_layout, edge_edge_rates, edge_edge_place)
