"""Two straight edges: no chart to follow; eta = the sign of N against E_o x E_f, which does not change.

With E_i the unit vectors along the edges, X_i their origins, t_i the arc lengths from there, c = E_o x E_f
and the dual vectors A_o = E_f x c/|c|^2, A_f = c x E_o/|c|^2,

    N = sign c/|c|,  t_o = b.A_o,  t_f = -b.A_f,  b = X_f - X_o,
    N_dot = (w_o x N).E_o A_o + (w_f x N).E_f A_f   by N.E_o = N.E_f = 0,
    t_o_dot = (dV - d N_dot).A_o,  t_f_dot = -(dV - d N_dot).A_f

Singular where the edges are parallel, at every gap: the margin is the sine of their angle. c is formed as
E_o x (E_f - +-E_o), whose small factor is exact, so that N keeps its digits up to there.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.normal_row import Levers, feet, jacobian_rows, levers, passing
from modelgen.contact.singularity_margin import NO_LENGTH
from modelgen.geometry.curves import STRAIGHT
from modelgen.geometry.frames import cross, dot, zeros


@dataclass(frozen=True)
class Edges:
    """Both edges at their nearest points; vectors in world axes."""

    E_o: ca.SX  # (3,) 1
    E_f: ca.SX  # (3,)
    A_o: ca.SX  # (3,) A_o.E_o = 1, A_o.E_f = 0
    A_f: ca.SX  # (3,) A_f.E_f = 1, A_f.E_o = 0
    sine: ca.SX  # (1,) of their angle
    N: ca.SX  # (3,)
    d: ca.SX  # (1,) m
    levers: Levers


def edges(pair: Pair) -> Edges:
    e_o, e_f = (ca.sparsify(ca.SX(STRAIGHT[side.shape.kind])) for side in (pair.o, pair.f))
    E_o, E_f = ca.mtimes(pair.o.rotation, e_o), ca.mtimes(pair.f.rotation, e_f)
    c = cross(E_o, E_f - ca.sign(dot(E_o, E_f)) * E_o)
    square = dot(c, c)
    length = ca.sqrt(square)
    N = pair.eta * c / length
    A_o, A_f = cross(E_f, c) / square, cross(c, E_o) / square
    b = pair.f.origin - pair.o.origin
    at = levers(pair, e_o * dot(b, A_o), -e_f * dot(b, A_f))
    return Edges(E_o, E_f, A_o, A_f, length, N, dot(N, b), at)


def edge_edge_rates(pair: Pair) -> Rates:
    """Lemma 3.1 and the corrected Corollary 3.2; N.(w x slide) = -N_dot.slide along a straight edge."""
    at = edges(pair)
    w_o, w_f = pair.o.spin_world, pair.f.spin_world
    turn_o, turn_f = cross(w_o, at.N), cross(w_f, at.N)
    tilt_o, tilt_f = dot(turn_o, at.E_o), dot(turn_f, at.E_f)
    N_dot = tilt_o * at.A_o + tilt_f * at.A_f
    V = at.levers.velocity_f - at.levers.velocity_o
    past = V - at.d * N_dot
    t_o, t_f = dot(past, at.A_o), -dot(past, at.A_f)
    gamma = dot(N_dot, V) + t_o * tilt_o - t_f * tilt_f
    gamma += dot(turn_o, cross(w_o, at.levers.r_o)) - dot(turn_f, cross(w_f, at.levers.r_f))
    J_o, J_f = jacobian_rows(pair, at.N, at.levers)
    foot_o, foot_f = feet(pair, at.N, at.levers)
    made = {"E_o": at.E_o, "E_f": at.E_f, "V": V, "slide_o": at.E_o * t_o, "slide_f": at.E_f * t_f}
    steps = {"normal": at.N, **made}
    return Rates(
        d=at.d,
        J_o=J_o,
        J_f=J_f,
        gamma=gamma,
        eta_dot=zeros(1),
        normal=at.N,
        normal_rate=N_dot,
        turning=pair.o.seen(at.N, N_dot),
        foot_o=foot_o,
        foot_f=foot_f,
        passing=passing(pair, at.levers, at.E_o * t_o, at.E_f * t_f),
        steps=steps,
    )


def edge_edge_place(pair: Pair) -> Placement:
    """Gap, points and margin; there is nothing to correct."""
    at = edges(pair)
    return Placement(
        eta_next=pair.eta,
        d=at.d,
        residual=zeros(2),
        margin=ca.vertcat(at.sine, NO_LENGTH),
        normal=at.N,
        point_o=at.levers.point_o,
        point_f=at.levers.point_f,
    )
