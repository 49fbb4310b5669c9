"""The normal row of a contact in world axes: Lemma 3.1 and the corrected Corollary 3.2."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Foot, Passing, Rates
from modelgen.geometry.curves import CurveJet, curve_of
from modelgen.geometry.frames import cross, dot


@dataclass(frozen=True)
class Levers:
    """Contact points as levers from the centres of mass and as points; world axes but for l."""

    l_o: ca.SX  # (3,) m, shape axes of o
    l_f: ca.SX  # (3,) m, shape axes of f
    r_o: ca.SX  # (3,) m
    r_f: ca.SX  # (3,) m
    point_o: ca.SX  # (3,) m
    point_f: ca.SX  # (3,) m
    velocity_o: ca.SX  # (3,) m/s, of the material point
    velocity_f: ca.SX  # (3,) m/s


def jet_of_curve(partner: Partner, t: ca.SX) -> CurveJet:
    """Point of a curve and its derivatives, shape frame."""
    return curve_of(partner.shape).jet(t, partner.parameters)


def levers(pair: Pair, x_o: ca.SX, x_f: ca.SX) -> Levers:
    """From points of the two shapes, each in its shape frame."""
    l_o, l_f = x_o + pair.o.arm, x_f + pair.f.arm
    r_o, r_f = ca.mtimes(pair.o.rotation, l_o), ca.mtimes(pair.f.rotation, l_f)
    return Levers(
        l_o,
        l_f,
        r_o,
        r_f,
        pair.o.centre + r_o,
        pair.f.centre + r_f,
        pair.o.velocity + cross(pair.o.spin_world, r_o),
        pair.f.velocity + cross(pair.f.spin_world, r_f),
    )


def jacobian_rows(pair: Pair, N: ca.SX, at: Levers) -> tuple[ca.SX, ca.SX]:
    """Lemma 3.1 (3.3) by side: (-N, -(r_o x N)) and (N, r_f x N), the angular part in body axes."""
    moment_o = ca.mtimes(pair.o.rotation.T, cross(at.r_o, N))
    moment_f = ca.mtimes(pair.f.rotation.T, cross(at.r_f, N))
    return pair.o.row(-N, -moment_o), pair.f.row(N, moment_f)


def feet(pair: Pair, N: ca.SX, at: Levers) -> tuple[Foot, Foot]:
    """The contact points on both bodies."""
    return (
        Foot(at.l_o, None, ca.mtimes(pair.o.rotation.T, N)),
        Foot(at.l_f, None, ca.mtimes(pair.f.rotation.T, N)),
    )


def passing(pair: Pair, at: Levers, slide_o: ca.SX, slide_f: ca.SX) -> Passing:
    """V_f - V_o, and w_f x (w_f x r_f + slide_f) - w_o x (w_o x r_o + slide_o)."""
    w_o, w_f = pair.o.spin_world, pair.f.spin_world
    pull = cross(w_f, cross(w_f, at.r_f) + slide_f) - cross(w_o, cross(w_o, at.r_o) + slide_o)
    return Passing(at.velocity_f - at.velocity_o, pull)


def gap_bias(N: ca.SX, N_dot: ca.SX, past: Passing) -> ca.SX:
    """Corollary 3.2 (3.11) in compact form, with the two centripetal signs of the print reversed.

    gamma = N.(w_f x (w_f x r_f) - w_o x (w_o x r_o)) + N_dot.(V_f - V_o) + N.(w_f x slide_f - w_o x slide_o),
    slide = velocity (3,) of the contact point over its surface, world axes.
    """
    return dot(N, past.pull) + dot(N_dot, past.V)


def rates_of(
    pair: Pair,
    N: ca.SX,
    N_dot: ca.SX,
    at: Levers,
    slide_o: ca.SX,
    slide_f: ca.SX,
    eta_dot: ca.SX,
    steps: Mapping[str, ca.SX],
) -> Rates:
    """All rates from N, the levers, and the motion of the contact points over the surfaces."""
    J_o, J_f = jacobian_rows(pair, N, at)
    foot_o, foot_f = feet(pair, N, at)
    past = passing(pair, at, slide_o, slide_f)
    return Rates(
        d=dot(N, at.point_f - at.point_o),
        J_o=J_o,
        J_f=J_f,
        gamma=gap_bias(N, N_dot, past),
        eta_dot=eta_dot,
        normal=N,
        normal_rate=N_dot,
        turning=pair.o.seen(N, N_dot),
        foot_o=foot_o,
        foot_f=foot_f,
        passing=past,
        steps={
            "normal": N,
            "point_o": at.point_o,
            "point_f": at.point_f,
            "velocity_o": at.velocity_o,
            "velocity_f": at.velocity_f,
            **steps,
            "slide_o": slide_o,
            "slide_f": slide_f,
        },
    )
