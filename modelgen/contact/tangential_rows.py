"""Tangential rows: slip, spin and rolling, and their second derivatives, once for every form.

V is the velocity of the material point of f at its closest point past that of o at its own, w = w_f - w_o.
Below the normal row N.V stand t1.V, t2.V (slip), and below these N.w (spin), t1.w, t2.w (rolling). With the
levers l of the closest points, s the velocities of these points over their shapes, and the frame's rate,

    t1_dot = -(N_dot.t1) N + sigma t2,   t2_dot = -(N_dot.t2) N - sigma t1,
    gamma of t.V = t.(w_f x (w_f x l_f + s_f) - w_o x (w_o x l_o + s_o)) + t_dot.V,
    gamma of N.w = N_dot.w,   gamma of t.w = t_dot.w,

so that d/dt (J u) = J u_dot + gamma, at any gap and with slip: (3.11), signs corrected, with t for N. These
rows are the conditions of Montana's rolling (t.V = 0) and of rolling without spin (N.w = 0).

The frame is `tangent_frame` of N in the axes of o's shape: it moves with o, rests where N rests in o (a
plane), and jumps where the third component of N in these axes passes SEAM, by a rotation about N that t1, t2,
J and gamma undergo together. The seam is off 0, where normals of cylinders and equators lie and rounding
would choose the frame. A jump, or another frame, changes the components of slip and of friction, never their
lengths nor their power; who keeps a direction across time keeps it in world axes. An axis e fixed in o's
shape has the components (t1.e, t2.e) in the tangent plane.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Foot, Rates
from modelgen.geometry.frames import cross, dot, frame_spin, tangent_frame, zeros


@dataclass(frozen=True)
class SlipFrame:
    """[t1 t2 N] in three axes, and how it turns."""

    T_o: ca.SX  # (3,2) shape axes of o
    T_f: ca.SX  # (3,2) shape axes of f
    T_w: ca.SX  # (3,2) world
    tilt: ca.SX  # (2,) rad/s, N_dot.t
    sigma: ca.SX  # (1,) rad/s, about N

    def rate(self, along_t: ca.SX, along_n: ca.SX) -> ca.SX:
        """(2,) t_dot.x of a vector x with components t.x and N.x."""
        return self.sigma * ca.vertcat(along_t[1], -along_t[0]) - self.tilt * along_n


def slip_frame(pair: Pair, rates: Rates) -> SlipFrame:
    n, spin = rates.foot_o.normal, pair.o.spin
    T_o = tangent_frame(n, pair.o.seam)
    T_w = ca.mtimes(pair.o.rotation, T_o)
    along = ca.mtimes(T_o.T, spin)
    tilt = ca.mtimes(T_o.T, rates.turning) + ca.vertcat(along[1], -along[0])
    sigma = frame_spin(n, rates.turning, pair.o.seam) + dot(n, spin)
    return SlipFrame(T_o, ca.mtimes(pair.f.rotation.T, T_w), T_w, tilt, sigma)


@dataclass(frozen=True)
class Rows:
    """Rows below the normal one, one after the other."""

    J_o: ca.SX
    J_f: ca.SX
    gamma: ca.SX
    steps: Mapping[str, ca.SX]


def with_tangential_rows(pair: Pair, rates: Rates, rows: int) -> Rates:
    """Below the normal row: slip t1.V, t2.V (3 rows); spin N.w, rolling t1.w, t2.w (6 rows).

    gamma of t.V = t.(w_f x (w_f x l_f + s_f) - w_o x (w_o x l_o + s_o)) + t_dot.V,  of N.w = N_dot.w,
    of t.w = t_dot.w;  t1_dot = sigma t2 - (N_dot.t1) N,  t2_dot = -sigma t1 - (N_dot.t2) N.
    """
    if rows == 1:
        return rates
    frame = slip_frame(pair, rates)
    below = [slip_rows(pair, rates, frame), *([spin_rows(pair, rates, frame)] if rows == 6 else [])]
    steps = {name: value for block in below for name, value in block.steps.items()}
    return replace(
        rates,
        J_o=ca.vertcat(rates.J_o, *(block.J_o for block in below)),
        J_f=ca.vertcat(rates.J_f, *(block.J_f for block in below)),
        gamma=ca.vertcat(rates.gamma, *(block.gamma for block in below)),
        tangents=ca.vec(frame.T_w),
        steps={**rates.steps, "tilt": frame.tilt, "sigma": frame.sigma, **steps},
    )


def slip_rows(pair: Pair, rates: Rates, frame: SlipFrame) -> Rows:
    """t1.V and t2.V."""
    past = _past(pair, rates, frame)
    moments_o, moments_f = _moments(rates.foot_o, frame.T_o), _moments(rates.foot_f, frame.T_f)
    t = ca.horzsplit(frame.T_w)
    J_o = ca.vertcat(*(pair.o.row(-t[k], -moments_o[k]) for k in range(2)))
    J_f = ca.vertcat(*(pair.f.row(t[k], moments_f[k]) for k in range(2)))
    return Rows(J_o, J_f, past.pull + frame.rate(past.slip, past.speed), {"slip": past.slip})


def _moments(foot: Foot, T: ca.SX) -> tuple[ca.SX, ca.SX]:
    """l x t1 and l x t2 of l = lever + offset N, shape axes: N x t1 = t2, N x t2 = -t1."""
    t1, t2 = ca.horzsplit(T)
    return cross(foot.lever, t1) + foot.offset * t2, cross(foot.lever, t2) - foot.offset * t1


@dataclass(frozen=True)
class Past:
    """A velocity, of one material point or of one past another, and its rate without accelerations."""

    slip: ca.SX  # (2,) m/s, along t1, t2
    speed: ca.SX  # (1,) m/s, along N
    pull: ca.SX  # (2,) m/s^2, along t1, t2


def _past(pair: Pair, rates: Rates, frame: SlipFrame) -> Past:
    """V and its rate."""
    known, N, to_frame = rates.passing, rates.normal, frame.T_w.T
    if known is not None:
        return Past(ca.mtimes(to_frame, known.V), dot(N, known.V), ca.mtimes(to_frame, known.pull))
    between = pair.f.velocity - pair.o.velocity
    o = _carried(pair.o, rates.foot_o, frame.T_o, frame.tilt)
    f = _carried(pair.f, rates.foot_f, frame.T_f, frame.tilt)
    slip = ca.mtimes(to_frame, between) + f.slip - o.slip
    return Past(slip, dot(N, between) + f.speed - o.speed, f.pull - o.pull)


def _carried(side: Partner, foot: Foot, T: ca.SX, tilt: ca.SX) -> Past:
    """w x l, and w x (w x l + l_dot), whose offset moves by offset N_dot."""
    assert foot.slide is not None
    n, offset, spin = foot.normal, foot.offset, side.spin
    carried = cross(spin, foot.lever)
    along = ca.mtimes(T.T, spin)
    pull = ca.mtimes(T.T, cross(spin, carried + foot.slide))
    return Past(
        slip=ca.mtimes(T.T, carried) + offset * ca.vertcat(along[1], -along[0]),
        speed=dot(n, carried),
        pull=pull + offset * dot(n, spin) * ca.vertcat(-tilt[1], tilt[0]),
    )


def spin_rows(pair: Pair, rates: Rates, frame: SlipFrame) -> Rows:
    """N.w, t1.w and t2.w."""
    o, f = pair.o, pair.f
    axes_o = (rates.foot_o.normal, *ca.horzsplit(frame.T_o))
    axes_f = (rates.foot_f.normal, *ca.horzsplit(frame.T_f))
    spin, *roll = (dot(n_f, f.spin) - dot(n_o, o.spin) for n_o, n_f in zip(axes_o, axes_f, strict=True))
    rolling = ca.vertcat(*roll)
    return Rows(
        ca.vertcat(*(o.row(zeros(3), -n) for n in axes_o)),
        ca.vertcat(*(f.row(zeros(3), n) for n in axes_f)),
        ca.vertcat(dot(frame.tilt, rolling), frame.rate(rolling, spin)),
        {"spin_past": spin, "rolling": rolling},
    )
