"""A centre beside a curve: Theorem 4.6 for a sphere, in closed form but for the curve's parameter.

The centre C lies across the curve's point X, E.(C - X) = 0 with E = R c'; its radius rho is negative for a
cavity and 0 for a point. With h = s |C - X|, s = -1 for a cavity, M = (C - X)/h, which is N or -N as the
curve stands for o or f, V the velocity of C seen from the curve's material point, w the spin of its body,

    d = h - rho,   (|E|^2 - h M.R c'') t_dot = E.(V - h w x M),   M_dot = (V - E t_dot - M M.V)/h,
    gamma = M_dot.V - t_dot M.(w x E) + M.(w_c x (w_c x l_c)) - M.(w x (w x l))

It is singular where C meets the curve, where a sphere has lost all sides and a point no longer has a gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Foot, Placement, Rates
from modelgen.contact.normal_row import jet_of_curve
from modelgen.contact.singularity_margin import NO_LENGTH
from modelgen.contact.sphere_centres import Centre, centre_of, has_centre
from modelgen.geometry.frames import cross, dot, zeros
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import exterior_sign


@dataclass(frozen=True)
class Beside:
    """The two sides as curve and centre; vectors in world axes unless said otherwise."""

    curve: Partner
    centre: Centre
    side: int  # of N against M: 1 with the curve on o, -1 on f
    lever: ca.SX  # (3,) m, of the curve's point from its centre of mass
    E: ca.SX  # (3,) m per parameter
    bend: ca.SX  # (3,) R c''
    offset: ca.SX  # (3,) m, from the curve's point to the centre
    h: ca.SX  # (1,) m
    M: ca.SX  # (3,)

    @property
    def d(self) -> ca.SX:
        return self.h - self.centre.radius


def beside(pair: Pair) -> Beside:
    swapped = not has_centre(pair.f.shape)
    curve, centre = (pair.f, centre_of(pair.o)) if swapped else (pair.o, centre_of(pair.f))
    jet = jet_of_curve(curve, pair.eta)
    lever = ca.mtimes(curve.rotation, jet.x + curve.arm)
    offset = centre.position - curve.centre - lever
    h = exterior_sign(centre.partner.shape) * ca.sqrt(dot(offset, offset))
    E, bend = ca.mtimes(curve.rotation, jet.first), ca.mtimes(curve.rotation, jet.second)
    return Beside(curve, centre, -1 if swapped else 1, lever, E, bend, offset, h, offset / h)


def centre_curve_rates(pair: Pair) -> Rates:
    """Lemma 3.1, corrected Corollary 3.2 and Theorem 4.6 with the centre in the place of a point."""
    at = beside(pair)
    curve, M, w = at.curve, at.M, at.curve.spin_world
    slip = cross(w, at.lever)
    V = at.centre.velocity - curve.velocity - slip
    turn = cross(w, M)
    t_dot = dot(at.E, V - at.h * turn) / (dot(at.E, at.E) - dot(at.offset, at.bend))
    M_dot = (V - at.E * t_dot - M * dot(M, V)) / at.h
    gamma = dot(M_dot, V) + dot(turn, at.E * t_dot + slip) + at.centre.pull(M)
    moment = ca.mtimes(curve.rotation.T, cross(at.lever, M))
    row = curve.row(-M, -moment), at.centre.row(M)
    N, N_dot = at.side * M, at.side * M_dot
    feet = _foot_of_curve(at, t_dot), at.centre.foot(N, -at.side)
    steps = {"normal": N, "l": at.lever, "h": at.h, "E": at.E, "V": V, "slide": at.E * t_dot}
    return Rates(
        d=at.d,
        J_o=row[0 if at.side == 1 else 1],
        J_f=row[1 if at.side == 1 else 0],
        gamma=gamma,
        eta_dot=t_dot,
        normal=N,
        normal_rate=N_dot,
        turning=pair.o.seen(N, N_dot),
        foot_o=feet[0 if at.side == 1 else 1],
        foot_f=feet[1 if at.side == 1 else 0],
        steps=steps,
    )


def _foot_of_curve(at: Beside, t_dot: ca.SX) -> Foot:
    to_shape = at.curve.rotation.T
    normal = ca.mtimes(to_shape, at.side * at.M)
    return Foot(ca.mtimes(to_shape, at.lever), ca.mtimes(to_shape, at.E) * t_dot, normal)


def centre_curve_place(pair: Pair) -> Placement:
    """Newton step on E.(C - X) with its exact derivative."""
    at = beside(pair)
    size, bent = dot(at.E, at.E), dot(at.offset, at.bend)
    e = dot(at.E, at.offset)
    points = (at.curve.centre + at.lever, at.centre.position - at.centre.radius * at.M)[:: at.side]
    return Placement(
        eta_next=pair.eta + e / (size - bent),
        d=at.d,
        residual=ca.vertcat(ca.fabs(e) / ca.sqrt(size), zeros(1)),
        margin=_margin(at, size, bent),
        normal=at.side * at.M,
        point_o=points[0],
        point_f=points[1],
    )


def _margin(at: Beside, size: ca.SX, bent: ca.SX) -> ca.SX:
    """(mu, flatness) of a curve on a sphere, `curve_margin` with K = I/rho; with D = 1 + kappa h

        mu = h/(|rho| + |d|) D/(1 + |kappa| (|rho| + |d|)),  flatness h D/(|rho| + |d|)^2

    negative where the distance is not least; h < 0 within a cavity, where |C - X| is to be largest. A point
    has no radius to measure h by: the lever of the curve's point is taken, and nothing is flat.
    """
    D = (size - bent) / size
    away = ca.fabs(at.h)
    if is_point(at.centre.partner.shape):
        lever = ca.sqrt(dot(at.lever, at.lever))
        return ca.vertcat(away / (away + lever) * D / (1 + ca.fabs(bent) / size), NO_LENGTH)
    reach = ca.fabs(at.centre.radius) + ca.fabs(at.d)
    bow = ca.fabs(bent) / (size * away) * reach
    return ca.vertcat(at.h / reach * D / (1 + bow), at.h * D / (reach * reach))
