"""Sphere against sphere: no eta, closed form from the two centres.

With signed radii rho (negative for a cavity) P_f - P_o = d N means C_f - C_o = (d + rho_o + rho_f) N, so
d = s |C_f - C_o| - rho_o - rho_f and N = s (C_f - C_o)/|C_f - C_o| with s = -1 where one is a cavity.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.kernels import Placement, Rates
from modelgen.contact.margin import margin
from modelgen.contact.sides import Pair, Partner
from modelgen.geometry.catalogue import exterior_sign
from modelgen.geometry.frames import cross, dot, zeros


@dataclass(frozen=True)
class Centres:
    distance: ca.SX  # (1,) m, s |C_f - C_o|
    N: ca.SX  # (3,) world
    d: ca.SX  # (1,) m


def signed_radius(partner: Partner) -> ca.SX:
    return exterior_sign(partner.shape) * partner.parameters[0]


def centres(pair: Pair) -> Centres:
    between = pair.f.origin - pair.o.origin
    sign = min(exterior_sign(pair.o.shape), exterior_sign(pair.f.shape))
    distance = sign * ca.sqrt(dot(between, between))
    N = between / distance
    return Centres(distance, N, distance - signed_radius(pair.o) - signed_radius(pair.f))


def sphere_rates(pair: Pair) -> Rates:
    """d_dot = N.(C_f_dot - C_o_dot); gamma from the turning of N and the centripetal terms of the centres."""
    at = centres(pair)
    V = _centre_velocity(pair.f) - _centre_velocity(pair.o)
    N_dot = (V - at.N * dot(at.N, V)) / at.distance
    pull_o, n_o = _centripetal(pair.o, at.N)
    pull_f, n_f = _centripetal(pair.f, at.N)
    return Rates(
        d=at.d,
        J_o=pair.o.row(-at.N, -cross(pair.o.arm, n_o)),
        J_f=pair.f.row(at.N, cross(pair.f.arm, n_f)),
        gamma=dot(N_dot, V) + pull_f - pull_o,
        eta_dot=ca.SX(0, 1),
        normal=at.N,
        normal_rate=N_dot,
        steps={"distance": at.distance, "normal": at.N, "V": V},
    )


def _centre_velocity(partner: Partner) -> ca.SX:
    return partner.velocity + ca.mtimes(partner.rotation, cross(partner.spin, partner.arm))


def _centripetal(partner: Partner, N: ca.SX) -> tuple[ca.SX, ca.SX]:
    """N.(w x (w x l)) of the sphere's centre, and N in shape axes."""
    n = ca.mtimes(partner.rotation.T, N)
    return -dot(cross(partner.spin, n), cross(partner.spin, partner.arm)), n


def sphere_place(pair: Pair) -> Placement:
    """Gap, points and margin; there is nothing to correct."""
    at = centres(pair)
    K_o, K_f = (ca.SX.eye(2) / signed_radius(side) for side in (pair.o, pair.f))
    return Placement(
        eta_next=ca.SX(0, 1),
        d=at.d,
        residual=zeros(2),
        margin=margin(K_o, K_f, at.d),
        normal=at.N,
        point_o=pair.o.origin + signed_radius(pair.o) * at.N,
        point_f=pair.f.origin - signed_radius(pair.f) * at.N,
    )
