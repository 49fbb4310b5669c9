"""The tangent-plane form: Theorem 4.1 in one orthonormal frame [t1 t2 n] shared by both surfaces.

The frame belongs to o's point; columns are written in the axes where they are needed (shape o, shape f,
world), so that no relative rotation is formed. With K_o, K_f in this frame (convex positive),
a = velocity of the contact point over o, b = that over f, V = tangential velocity of f's material point
relative to o's material frame, w_i^t = w_i x n, w^t = w_f^t - w_o^t, Theorem 4.1 reads

    (K_f + K_o + d K_o K_f) b = (I + d K_o) w^t - K_o V                              (4.1)
    nu = w^t - K_f b                       rate of the normal seen from o             (B.5)
    a = V + b - d nu                                                                  (4.2)
    gamma = nu.V - b.w^t - w_f^t.(w_f x l_f) + w_o^t.(w_o x l_o) + 2 w_o^t.V          (3.11)

(3.11) with the centripetal signs corrected: the print has them reversed. n.(w x (w x l)) is
written -(w x n).(w x l). eta needs neither psi nor an orthogonal chart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Foot, Rates
from modelgen.contact.singularity_margin import relative_curvature
from modelgen.contact.surface_points import SurfacePoint
from modelgen.geometry.frames import cross, dot, is_zero, solve2, zeros


@dataclass(frozen=True)
class ContactFrame:
    """[t1 t2 n] of o's point in the axes of both shapes and of the world."""

    T_o: ca.SX  # (3,2)
    T_f: ca.SX  # (3,2)
    T_w: ca.SX  # (3,2)
    n_o: ca.SX  # (3,)
    n_f: ca.SX  # (3,) minus f's exterior normal on extremal pairs
    n_w: ca.SX  # (3,) N


def contact_frame(pair: Pair, o: SurfacePoint) -> ContactFrame:
    T_w, n_w = _turn(pair.o.rotation, o.tangents, o.normal)
    T_f, n_f = _turn(pair.f.rotation.T, T_w, n_w)
    return ContactFrame(o.tangents, T_f, T_w, o.normal, n_f, n_w)


def _turn(rotation: ca.SX, T: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The frame in other axes; its third vector by the cheaper of two ways."""
    turned = ca.mtimes(rotation, T)
    sparse = bool(rotation.is_eye()) or n.nnz() == 1
    return turned, ca.mtimes(rotation, n) if sparse else cross(turned[:, 0], turned[:, 1])


@dataclass(frozen=True)
class Touch:
    """The contact in tangent coordinates (t1, t2); levers from the centres of mass, each in shape axes."""

    d: ca.SX  # (1,) m
    l_o: ca.SX  # (3,) m
    l_f: ca.SX  # (3,) m
    K_o: ca.SX  # (2,2) 1/m
    K_f: ca.SX  # (2,2) 1/m


def touch(pair: Pair, frame: ContactFrame, o: SurfacePoint, f: SurfacePoint) -> Touch:
    """Gap, levers and curvatures at the points that eta carries."""
    assert f.x is not None
    d, l_o, l_f = reach(pair, frame, o, f.x)
    return Touch(d, l_o, l_f, o.curvature(frame.T_o), f.curvature(frame.T_f))


def reach(pair: Pair, frame: ContactFrame, o: SurfacePoint, x_f: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """d, and the levers of both points; a plane's point is the foot of the partner's."""
    between = pair.f.centre - pair.o.centre
    l_f = x_f + pair.f.arm
    if o.x is None:
        foot = ca.mtimes(frame.T_w.T, between) + ca.mtimes(frame.T_f.T, l_f)
        foot -= ca.mtimes(frame.T_o.T, pair.o.arm)
        l_o = ca.mtimes(frame.T_o, foot) + pair.o.arm
    else:
        l_o = o.x + pair.o.arm
    return dot(frame.n_w, between) + dot(frame.n_f, l_f) - dot(frame.n_o, l_o), l_o, l_f


def tangent_rates(pair: Pair, o: SurfacePoint, f: SurfacePoint) -> Rates:
    """Lemma 3.1, corrected Corollary 3.2 and Theorem 4.1 with d_dot = J u."""
    frame = contact_frame(pair, o)
    at = touch(pair, frame, o, f)
    turn_o, slip_o = spin_along(pair.o, frame.T_o, at.l_o)
    turn_f, slip_f = spin_along(pair.f, frame.T_f, at.l_f)
    turn = turn_f - turn_o
    V = ca.mtimes(frame.T_w.T, pair.f.velocity - pair.o.velocity) + slip_f - slip_o - at.d * turn_o
    A = relative_curvature(at.K_o, at.K_f, at.d)
    b = solve2(A, turn + ca.mtimes(at.K_o, at.d * turn - V))
    nu = zeros(2) if is_zero(at.K_o) else turn - ca.mtimes(at.K_f, b)
    a = V + b - at.d * nu
    gamma = dot(nu, V) - dot(b, turn) - dot(turn_f, slip_f)
    gamma += dot(turn_o, slip_o + at.d * turn_o + 2 * V)
    over_o, over_f = ca.mtimes(frame.T_o, a), ca.mtimes(frame.T_f, b)
    eta_dot = ca.vertcat(o.eta_rate(over_o), f.eta_rate(over_f))
    feet = Foot(at.l_o, over_o, frame.n_o), Foot(at.l_f, over_f, frame.n_f)
    steps = {"K_o": at.K_o, "K_f": at.K_f, "A": A, "turn": turn, "V": V, "slide_f": b, "nu": nu, "slide_o": a}
    return normal_row(pair, frame, at.d, feet, gamma, nu, eta_dot, steps)


def normal_row(
    pair: Pair,
    frame: ContactFrame,
    d: ca.SX,
    feet: tuple[Foot, Foot],
    gamma: ca.SX,
    nu: ca.SX,
    eta_dot: ca.SX,
    steps: Mapping[str, ca.SX],
) -> Rates:
    """The rates from the frame, the contact points on o and f, and the rate nu of the normal seen from o."""
    t1, t2 = ca.horzsplit(frame.T_w)
    known = {"normal": frame.n_w, "t1": t1, "t2": t2, "l_o": feet[0].lever, "l_f": feet[1].lever}
    return Rates(
        d=d,
        J_o=pair.o.row(-frame.n_w, -cross(feet[0].lever, frame.n_o)),
        J_f=pair.f.row(frame.n_w, cross(feet[1].lever, frame.n_f)),
        gamma=gamma,
        eta_dot=eta_dot,
        normal=frame.n_w,
        normal_rate=ca.mtimes(frame.T_w, nu) + cross(pair.o.spin_world, frame.n_w),
        turning=ca.mtimes(frame.T_o, nu),
        foot_o=feet[0],
        foot_f=feet[1],
        steps={**known, **steps},
    )


def spin_along(partner: Partner, T: ca.SX, lever: ca.SX) -> tuple[ca.SX, ca.SX]:
    """w x n and w x l in tangent coordinates: t1 x n = -t2, t2 x n = t1."""
    along = ca.mtimes(T.T, partner.spin)
    return ca.vertcat(along[1], -along[0]), ca.mtimes(T.T, cross(partner.spin, lever))
