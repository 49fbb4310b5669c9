"""Curve against surface, Theorem 4.6, without arc length, Frenet frame or angle.

With e = T^T c' in the tangent plane of o, beta = N.c'' (both by the curve's own parameter t), V the velocity
of the curve's material point seen from o and w^t = (w_f - w_o) x N, the first row of (4.27) and (4.26) read

    (I + d K_o) a - e t_dot = V,     e.K_o a + beta t_dot = e.w^t

with a = velocity of the contact point over o. Eliminated along and across e, which needs neither
(I + d K_o)^-1 nor curvature of the curve: the determinant is |e|^4 S,

    S = kappa_f det(I + d K_o) + [K_o adj(I + d K_o)]_ee,     kappa_f = beta/|e|^2.

The row, N_dot and gamma are those of every contact with an exterior normal of o.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Foot, Placement, Rates
from modelgen.contact.normal_row import jet_of_curve
from modelgen.contact.singularity_margin import curve_margin
from modelgen.contact.surface_points import SurfacePoint
from modelgen.contact.tangent_plane_form import ContactFrame, contact_frame, normal_row, reach, spin_along
from modelgen.geometry.curves import CurveJet
from modelgen.geometry.frames import dot, is_zero, solve2, zeros


@dataclass(frozen=True)
class CurveSystem:
    """U a - e t = right_a, w.a + beta t = right_t for a (2,) and the scalar t."""

    U: ca.SX  # (2,2) I + d K_o
    e: ca.SX  # (2,)
    w: ca.SX  # (2,) K_o e
    beta: ca.SX  # (1,)

    @property
    def matrix(self) -> ca.SX:
        """Rows for a alone (2,2): |e|^2 w + beta U^T e, and U^T across e."""
        along = dot(self.e, self.e) * self.w + self.beta * ca.mtimes(self.U.T, self.e)
        return ca.horzcat(along, ca.mtimes(self.U.T, _across(self.e))).T

    def solve(self, right_a: ca.SX, right_t: ca.SX) -> tuple[ca.SX, ca.SX]:
        """(a, t), regular wherever the system is."""
        size = dot(self.e, self.e)
        if is_zero(self.w) and bool(self.U.is_eye()):
            t = right_t / self.beta
            return right_a + self.e * t, t
        along = size * right_t + self.beta * dot(self.e, right_a)
        a = solve2(self.matrix, ca.vertcat(along, dot(_across(self.e), right_a)))
        return a, dot(self.e, ca.mtimes(self.U, a) - right_a) / size


def _across(e: ca.SX) -> ca.SX:
    return ca.vertcat(-e[1], e[0])


@dataclass(frozen=True)
class CurveTouch:
    """Levers from the centres of mass in shape axes, curvature of o, and the system of eta's rates."""

    jet: CurveJet
    d: ca.SX  # (1,) m
    l_o: ca.SX  # (3,) m
    l_f: ca.SX  # (3,) m
    K_o: ca.SX  # (2,2) 1/m
    system: CurveSystem


def curve_touch(pair: Pair, frame: ContactFrame, o: SurfacePoint) -> CurveTouch:
    jet = jet_of_curve(pair.f, pair.eta_f)
    d, l_o, l_f = reach(pair, frame, o, jet.x)
    K_o = o.curvature(frame.T_o)
    e = ca.mtimes(frame.T_f.T, jet.first)
    U = ca.SX.eye(2) + d * K_o
    system = CurveSystem(
        ca.SX.eye(2) if is_zero(K_o) else U, e, ca.mtimes(K_o, e), dot(frame.n_f, jet.second)
    )
    return CurveTouch(jet, d, l_o, l_f, K_o, system)


def curve_surface_rates(pair: Pair, o: SurfacePoint) -> Rates:
    """Theorem 4.6, Lemma 3.1 and the corrected Corollary 3.2 in o's tangent plane."""
    frame = contact_frame(pair, o)
    at = curve_touch(pair, frame, o)
    turn_o, slip_o = spin_along(pair.o, frame.T_o, at.l_o)
    turn_f, slip_f = spin_along(pair.f, frame.T_f, at.l_f)
    turn = turn_f - turn_o
    V = ca.mtimes(frame.T_w.T, pair.f.velocity - pair.o.velocity) + slip_f - slip_o - at.d * turn_o
    a, t_dot = at.system.solve(V, dot(at.system.e, turn))
    nu = ca.mtimes(at.K_o, a)
    gamma = dot(nu, V) - t_dot * dot(at.system.e, turn) - dot(turn_f, slip_f)
    gamma += dot(turn_o, slip_o + at.d * turn_o + 2 * V)
    over_o = ca.mtimes(frame.T_o, a)
    eta_dot = ca.vertcat(o.eta_rate(over_o), t_dot)
    feet = Foot(at.l_o, over_o, frame.n_o), Foot(at.l_f, at.jet.first * t_dot, frame.n_f)
    made = {"K_o": at.K_o, "e": at.system.e, "beta": at.system.beta, "turn": turn, "V": V}
    steps = {**made, "slide_o": a, "nu": nu}
    return normal_row(pair, frame, at.d, feet, gamma, nu, eta_dot, steps)


def curve_surface_place(pair: Pair, o: SurfacePoint) -> Placement:
    """Newton step on e1 = T^T (P_f - P_o), N.c' and the height of o's point over its surface."""
    frame = contact_frame(pair, o)
    at = curve_touch(pair, frame, o)
    point_o = pair.o.centre + ca.mtimes(pair.o.rotation, at.l_o)
    point_f = pair.f.centre + ca.mtimes(pair.f.rotation, at.l_f)
    e1 = zeros(2) if o.x is None else ca.mtimes(frame.T_w.T, point_f - point_o)
    e2 = dot(frame.n_f, at.jet.first)
    bend = ca.mtimes(frame.T_o.T, o.bend) * o.height
    a, step_f = at.system.solve(e1 + at.d * bend, dot(at.system.e, bend) - e2)
    step_o = o.eta_rate(ca.mtimes(frame.T_o, a) - o.height * o.normal)
    speed = ca.sqrt(dot(at.jet.first, at.jet.first))
    return Placement(
        eta_next=pair.eta + ca.vertcat(step_o, step_f),
        d=at.d,
        residual=ca.vertcat(ca.sqrt(dot(e1, e1) + o.height * o.height), ca.fabs(e2) / speed),
        margin=curve_margin(at.K_o, at.system.matrix, at.system.e, at.system.beta, at.d),
        normal=frame.n_w,
        point_o=point_o if o.x is not None else point_f - at.d * frame.n_w,
        point_f=point_f,
    )
