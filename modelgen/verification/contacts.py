"""The formulas of a contact against the time derivatives of random extremal pairs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TypeVar

import casadi as ca
import numpy as np

from modelgen.contact.contact_symbols import Pair
from modelgen.contact.contact_symbols import pair as symbols_of
from modelgen.contact.differentiated_form import pose_rate
from modelgen.contact.form_table import eta_layout
from modelgen.geometry.curves import is_straight
from modelgen.model import ContactKind, Side
from modelgen.verification.extremal_motion import Truth, columns, repeated, truth
from modelgen.verification.findings import AGREE, Finding, compared
from modelgen.verification.random_configurations import Array, Configurations, Partnership, draw
from modelgen.verification.tangential_rows import check_slip, passing, row_products

Record = TypeVar("Record", Configurations, Truth)
MOTION = "time derivatives of the extremal pair by differentiation of the motion"
CONSTRUCTION = "the construction of the pair"
NEAR = 1e-4  # of the size of eta: how far off the Newton step starts
SIGNS = {"sign": 1, "signed_curve": 2}  # entries of eta that are signs, last on their side


@dataclass(frozen=True)
class Sample:
    """Regular configurations of a kind, and what is true of them."""

    pair: Partnership
    at: Configurations
    truth: Truth

    @property
    def n(self) -> int:
        return self.at.n


def sample(pair: Partnership, n: int, seed: int) -> Sample:
    """n configurations away from singularities, from four times as many drawn ones at most.

    Forms that follow a support map reach what is nearest only, and the paper's form of two curves needs
    tangents that cross: the others are left out.
    """
    at = draw(pair, 4 * n, seed)
    known = truth(pair, at)
    good = known.regular & np.isfinite(known.d_ddot)
    if pair.kind.o.shape.kind == "plane" and eta_layout(pair.kind) == ("none", "none"):
        good &= known.nearest
    chosen = np.flatnonzero(good)[:n]
    return Sample(pair, _columns_of(at, chosen), _columns_of(known, chosen))


def sample_of(pair: Partnership, at: Configurations) -> Sample:
    """Given configurations, regular or not."""
    return Sample(pair, at, truth(pair, at))


def _columns_of(record: Record, chosen: Array) -> Record:
    """The chosen configurations: the last axis, or the first of the matrices."""
    fields = {
        name: value[chosen] if value.ndim == 3 else value[..., chosen] for name, value in vars(record).items()
    }
    return type(record)(**fields)


def eta_of(sample: Sample, *, rate: bool = False) -> Array:
    """eta, or its rate, as the form of the kind carries it."""
    at, known, n_o = sample.at, sample.truth, sample.pair.o.dimension
    alpha = known.alpha_dot if rate else at.alpha
    kind = sample.pair.kind
    x_o, x_f = (known.x_o_dot, known.x_f_dot) if rate else (known.x_o, known.x_f)
    x_o, x_f = _unturned(kind.o, at.pose_o, x_o), _unturned(kind.f, at.pose_f, x_f)
    signs = np.stack([at.sign, np.where(at.d >= 0, 1.0, -1.0)]) * (0.0 if rate else 1.0)
    carried = {
        "none": (x_o[:0], x_f[:0]),
        "chart": (alpha[:n_o], alpha[n_o:]),
        "curve": (alpha[:n_o], alpha[n_o:]),
        "point": (x_o, x_f),
        "sign": (signs[:1], signs[:1]),
        "signed_curve": (alpha[:n_o], np.concatenate([alpha[n_o:], signs])),
    }
    layout = eta_layout(kind)
    return np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])


def _unturned(side: Side, pose: Array, x: Array) -> Array:
    """A body that is a point has no axes of its own: its shape frame has those of the world."""
    return np.einsum("jin,jn->in", pose[3:].reshape(3, 3, -1), x) if side.motion == "point" else x


def moving_inputs(sample: Sample) -> tuple[Array, ...]:
    """The arguments of the rates, one column per configuration."""
    at = sample.at
    return (
        at.pose_o,
        at.twist_o,
        at.pose_f,
        at.twist_f,
        eta_of(sample),
        repeated(sample.pair.parameters, at.n),
    )


def check_rates(sample: Sample, rates: ca.Function) -> list[Finding]:
    """d, normal, d_dot = J u, d_ddot = J u_dot + gamma, eta_dot."""
    at, known = sample.at, sample.truth
    d, J_o, J_f, gamma, eta_dot, normal, *tangents = columns(rates, *moving_inputs(sample))
    rows, length = len(gamma), sample.pair.length
    speed = row_products(J_o, at.twist_o, rows) + row_products(J_f, at.twist_f, rows)
    gained = row_products(J_o, at.accel_o, rows) + row_products(J_f, at.accel_f, rows) + gamma
    found = [
        compared("d", CONSTRUCTION, d + length, known.d[None] + length),
        compared("J", f"J u = d_dot; {MOTION}", speed[0], known.d_dot),
        compared("gamma", f"J u_dot + gamma = d_ddot; {MOTION}", gained[0], known.d_ddot),
        compared("eta_dot", MOTION, eta_dot, eta_of(sample, rate=True)),
        compared("normal", CONSTRUCTION, normal, known.normal),
    ]
    if rows == 1:
        return found
    (turned,) = along_motion(sample, rates, ("tangents",))
    return [
        *found,
        *check_slip(passing(sample.pair, at, known), known, tangents[0], turned, speed, gained),
    ]


def check_place(sample: Sample, place: ca.Function) -> list[Finding]:
    """Points, gap and normal; residuals vanish; the Newton step rests there and is quadratic around."""
    at, known, pair = sample.at, sample.truth, sample.pair
    eta, numbers = eta_of(sample), repeated(pair.parameters, at.n)
    eta_next, d, residual, _, normal, point_o, point_f = columns(place, at.pose_o, at.pose_f, eta, numbers)
    one = np.ones_like(residual)
    found = [
        compared("d", CONSTRUCTION, d + pair.length, known.d[None] + pair.length),
        compared("residual", "zero on extremal pairs", one + residual / [[pair.length], [1.0]], one),
        compared("normal", CONSTRUCTION, normal, known.normal),
        compared("point_o", CONSTRUCTION, point_o, known.point_o),
        compared("point_f", CONSTRUCTION, point_f, known.point_f),
    ]
    return [*found, _newton(sample, place, eta, eta_next, numbers)] if eta.size else found


def _newton(sample: Sample, place: ca.Function, eta: Array, eta_next: Array, numbers: Array) -> Finding:
    """Quadratic convergence: from an error e the step leaves at most a multiple of e^2; signs, which it
    renews, are excluded."""
    layout, at = eta_layout(sample.pair.kind), sample.at
    kept = slice(0, len(eta) - SIGNS.get(layout[0], 0) - SIGNS.get(layout[1], 0))
    away = np.zeros_like(eta)
    away[kept] = np.random.default_rng(7).normal(size=eta[kept].shape)
    size = np.maximum(np.abs(eta[kept]).max(axis=0, initial=0.0), sample.pair.length) * NEAR

    def left(share: float) -> float:
        stepped = columns(place, at.pose_o, at.pose_f, eta + share * size * away, numbers)[0]
        return float(np.max(np.linalg.norm((stepped - eta)[kept], axis=0) / size, initial=0.0))

    route = "rests on extremal pairs, converges quadratically around them"
    rests = compared("eta_next", route, eta_next[kept], eta[kept])
    quadratic = left(0.1) < 0.05 * left(1.0) + AGREE
    return rests if quadratic or rests.status == "failed" else replace(rests, status="failed", worst=1.0)


def check_angle(sample: Sample, angle: ca.Function) -> list[Finding]:
    """Compare each angle's rate with the derivative of the angle along the motion of the pair."""
    kind = sample.pair.kind
    values = columns(angle, *moving_inputs(sample))
    rates = dict(zip(angle.name_out(), values, strict=True))
    names = tuple(name for name in angle.name_out() if not name.endswith("_dot"))
    slopes = along_motion(sample, angle, names)
    straight = [f"phi_{side}" for side in "of" if is_straight(getattr(kind, side).shape)]
    return [
        compared(
            f"{name}_dot", f"derivative of {name} along the motion of the pair", rates[f"{name}_dot"], slope
        )
        for name, slope in zip(names, slopes, strict=True)
        if name not in straight
    ]


def along_motion(sample: Sample, function: ca.Function, names: tuple[str, ...]) -> tuple[Array, ...]:
    """The rates of the outputs of that name along the motion of the pairs, by differentiation."""
    slopes = _slopes(sample.pair.kind, function, names)
    return columns(slopes, *moving_inputs(sample), eta_of(sample, rate=True))


@cache
def _slopes(kind: ContactKind, function: ca.Function, names: tuple[str, ...]) -> ca.Function:
    at: Pair = symbols_of(kind, eta_layout(kind))
    numbers = ca.vertcat(at.o.argument, at.f.argument)
    arguments = [at.o.pose, at.o.twist, at.f.pose, at.f.twist, at.eta, numbers]
    eta_dot = ca.SX.sym("eta_dot", at.eta.numel())
    outputs = []
    for name, value in zip(function.name_out(), function.call(arguments), strict=True):
        if name not in names:
            continue
        slope = ca.jtimes(value, at.eta, eta_dot)
        for side in (at.o, at.f):
            if side.pose.numel():
                slope += ca.jtimes(value, side.pose, pose_rate(side))
        outputs.append(ca.densify(slope))
    return ca.Function("slopes", [*arguments, eta_dot], outputs)


def check_contact(role: str, function: ca.Function, sample: Sample) -> list[Finding]:
    """The findings for the formula of one role."""
    if not sample.n:
        return [Finding(name, "failed", "no regular configuration was found") for name in function.name_out()]
    return {"rates": check_rates, "place": check_place, "angle": check_angle}[role](sample, function)
