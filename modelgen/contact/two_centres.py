"""Two centres: no eta, closed form.

With signed radii rho (negative for a cavity, 0 for a point) P_f - P_o = d N means
C_f - C_o = (d + rho_o + rho_f) N, so d = s |C_f - C_o| - rho_o - rho_f and N = s (C_f - C_o)/|C_f - C_o| with
s = -1 where one is a cavity.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.singularity_margin import centre_margin
from modelgen.contact.sphere_centres import Centre, centre_of
from modelgen.geometry.frames import dot, zeros
from modelgen.geometry.surface_catalogue import exterior_sign


@dataclass(frozen=True)
class Centres:
    o: Centre
    f: Centre
    distance: ca.SX  # (1,) m, s |C_f - C_o|
    N: ca.SX  # (3,) world
    d: ca.SX  # (1,) m


def centres(pair: Pair) -> Centres:
    o, f = centre_of(pair.o), centre_of(pair.f)
    between = f.position - o.position
    sign = min(exterior_sign(pair.o.shape), exterior_sign(pair.f.shape))
    distance = sign * ca.sqrt(dot(between, between))
    return Centres(o, f, distance, between / distance, distance - o.radius - f.radius)


def two_centres_rates(pair: Pair) -> Rates:
    """d_dot = N.(C_f_dot - C_o_dot); gamma from the turning of N and the centripetal terms of the centres."""
    at = centres(pair)
    V = at.f.velocity - at.o.velocity
    N_dot = (V - at.N * dot(at.N, V)) / at.distance
    return Rates(
        d=at.d,
        J_o=at.o.row(-at.N),
        J_f=at.f.row(at.N),
        gamma=dot(N_dot, V) + at.f.pull(at.N) - at.o.pull(at.N),
        eta_dot=ca.SX(0, 1),
        normal=at.N,
        normal_rate=N_dot,
        turning=pair.o.seen(at.N, N_dot),
        foot_o=at.o.foot(at.N, 1),
        foot_f=at.f.foot(at.N, -1),
        steps={"distance": at.distance, "normal": at.N, "V": V},
    )


def two_centres_place(pair: Pair) -> Placement:
    """Gap, points and margin; there is nothing to correct."""
    at = centres(pair)
    return Placement(
        eta_next=ca.SX(0, 1),
        d=at.d,
        residual=zeros(2),
        margin=centre_margin(ca.SX.eye(2) / at.o.radius, at.f.radius, at.d),
        normal=at.N,
        point_o=at.o.position + at.o.radius * at.N,
        point_f=at.f.position - at.f.radius * at.N,
    )
