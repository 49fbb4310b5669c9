"""Random extremal pairs with curves, by construction, and their derivatives by a route of their own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from modelgen.contact.form_table import eta_layout
from modelgen.model import ContactKind
from tests.curves.specimens import ALL, BENDS, Bend
from tests.laws.configurations import Array, columns, pose_of, rotation_taking, surface, turned
from tests.laws.oracle import moved
from tests.laws.shapes import Specimen


@dataclass(frozen=True)
class Pairs:
    """n extremal pairs; every array has one column per configuration."""

    alpha: Array  # (3,n) chart of o and parameter of f, or (2,n) two parameters
    pose_o: Array
    pose_f: Array
    twist_o: Array
    twist_f: Array
    accel_o: Array
    accel_f: Array
    x_o: Array  # (3,n) shape frame
    d: Array  # (n,)
    sign: Array  # (n,) of N against the cross product of the tangents; 1 with a surface

    @property
    def n(self) -> int:
        return len(self.d)


@cache
def curve(bend: Bend) -> ca.Function:
    """t -> point and unit tangent by differentiation of the independent curve."""
    t = ca.SX.sym("t")
    x = ca.vertcat(*bend.curve(ca, t, bend.parameters))
    tangent = ca.jacobian(x, t)
    return ca.Function("curve", [t], [x, tangent / ca.norm_2(tangent)])


def units(random: np.random.Generator, n: int) -> Array:
    """(3,n) random directions."""
    drawn = random.normal(size=(3, n))
    return drawn / np.linalg.norm(drawn, axis=0)


def across(N: Array, other: Array) -> Array:
    """Unit vectors (3,n) across N, in the plane of N and `other`."""
    side = other - N * np.sum(N * other, axis=0)
    return side / np.linalg.norm(side, axis=0)


def random_pairs(o: str, f: str, n: int, seed: int, parallel: bool = False) -> Pairs:
    """A third of the gaps positive, a third zero, a third negative; all positive for parallel tangents."""
    one, two = ALL[o], BENDS[f]
    random = np.random.default_rng(seed)
    alpha = np.array([random.uniform(*ends, n) for ends in (*one.box, *two.box)])
    x_f, tangent_f = columns(curve(two), alpha[-1:])
    d = np.repeat([0.3, 0.0, -0.15], n)[::3][:n] * random.uniform(0.2, 1.0, n)
    R_o = rotation_taking(units(random, n), units(random, n), random.uniform(-3, 3, n))
    sign = np.ones(n)
    if isinstance(one, Specimen):
        x_o, n_o = columns(surface(one), alpha[:2])
        N = turned(R_o, n_o)
        along = across(N, units(random, n))
    else:
        x_o, tangent_o = columns(curve(one), alpha[:1])
        T_o = turned(R_o, tangent_o)
        N = across(T_o, units(random, n))
        along = T_o if parallel else across(N, units(random, n))
        if parallel:
            d = np.abs(d) + 0.1
        else:
            sign = np.sign(np.sum(N * np.cross(T_o, along, axis=0), axis=0))
    R_f = rotation_taking(tangent_f, along, random.uniform(-3, 3, n))
    p_o = random.normal(size=(3, n))
    p_f = p_o + turned(R_o, x_o) + d * N - turned(R_f, x_f)
    motion = random.normal(size=(4, 6, n))
    return Pairs(alpha, pose_of(p_o, R_o), pose_of(p_f, R_f), *motion, x_o, d, sign)


def eta_of(kind: ContactKind, at: Pairs) -> Array:
    """eta as the form carries it."""
    layout = eta_layout(kind)
    n_o = len(at.alpha) - 1
    first = {
        "none": at.x_o[:0], "point": at.x_o, "chart": at.alpha[:n_o], "curve": at.alpha[:n_o],
        "sign": at.sign[None],
    }[layout[0]]  # fmt: skip
    signs = np.stack([at.sign, np.where(at.d >= 0, 1.0, -1.0)])
    last = {
        "none": at.alpha[:0],
        "curve": at.alpha[-1:],
        "signed_curve": np.concatenate([at.alpha[-1:], signs]),
    }
    return np.concatenate([first, last[layout[1]]])


def lengths(o: str, f: str, n: int) -> Array:
    numbers = (*ALL[o].parameters, *ALL[f].parameters)
    return np.tile(np.array(numbers).reshape(-1, 1), (1, n))


@dataclass(frozen=True)
class Truth:
    """Derivatives along the motion, one column per configuration."""

    d: Array
    d_dot: Array
    d_ddot: Array
    alpha_dot: Array
    x_o_dot: Array  # (3,n) shape frame
    normal: Array
    normal_rate: Array


@cache
def _derivatives(o: str, f: str, parallel: bool) -> ca.Function:
    one, two = ALL[o], BENDS[f]
    size = len(one.box) + 1
    alpha, t, sign = ca.SX.sym("alpha", size), ca.SX.sym("t"), ca.SX.sym("sign")
    sides = [[ca.SX.sym(f"s{i}{k}", width) for k, width in enumerate((12, 6, 6))] for i in range(2)]
    (p_o, R_o), (p_f, R_f) = (moved(*side, t) for side in sides)
    x_f = ca.vertcat(*two.curve(ca, alpha[size - 1], two.parameters))
    E_f = R_f @ ca.jacobian(x_f, alpha[size - 1])
    if isinstance(one, Specimen):
        x_o = ca.vertcat(*one.chart(ca, alpha[0], alpha[1], one.parameters))
    else:
        x_o = ca.vertcat(*one.curve(ca, alpha[0], one.parameters))
    E_o = R_o @ ca.jacobian(x_o, alpha[: size - 1])
    between = p_f + R_f @ x_f - p_o - R_o @ x_o
    if isinstance(one, Specimen):
        normal = one.sign * ca.cross(E_o[:, 0], E_o[:, 1])
    else:
        normal = between if parallel else sign * ca.cross(E_o, E_f)
    N = normal / ca.norm_2(normal)
    g = ca.vertcat(E_o.T @ between, E_f.T @ (N if isinstance(one, Specimen) else between))
    d = N.T @ between
    d_t = ca.jacobian(d, t)
    wanted = [
        ca.jacobian(g, alpha), ca.jacobian(g, t), d, d_t, ca.jacobian(d_t, t), ca.jacobian(d_t, alpha).T,
        ca.hessian(d, alpha)[0], N, ca.jacobian(N, t), ca.jacobian(N, alpha), ca.jacobian(x_o, alpha),
    ]  # fmt: skip
    still = [ca.densify(entry) for entry in ca.substitute(wanted, [t], [ca.SX(0)])]
    return ca.Function("derivatives", [alpha, sign, *sides[0], *sides[1]], still)


def truth(o: str, f: str, at: Pairs, parallel: bool = False) -> Truth:
    """All derivatives on the given extremal pairs by implicit differentiation, as in the laws of surfaces."""
    size = len(at.alpha)
    out = columns(
        _derivatives(o, f, parallel), at.alpha, at.sign[None], at.pose_o, at.twist_o, at.accel_o,
        at.pose_f, at.twist_f, at.accel_f,
    )  # fmt: skip

    def stacked(value: Array) -> Array:
        return value.reshape(value.shape[0], at.n, size).transpose(1, 0, 2)

    g_alpha, d_aa, N_a, x_o_a = (stacked(out[i]) for i in (0, 6, 9, 10))
    rate = -np.linalg.solve(g_alpha, out[1].T[..., None])[..., 0].T

    def applied(matrix: Array) -> Array:
        return np.einsum("nij,jn->in", matrix, rate)

    d_ddot = out[4][0] + 2 * np.sum(out[5] * rate, axis=0) + np.sum(rate * applied(d_aa), axis=0)
    return Truth(out[2][0], out[3][0], d_ddot, rate, applied(x_o_a), out[7], out[8] + applied(N_a))


def eta_dot_of(kind: ContactKind, at: Truth) -> Array:
    """The rate of eta as the form carries it; signs do not change."""
    layout = eta_layout(kind)
    n_o = len(at.alpha_dot) - 1
    none = at.x_o_dot[:0]
    still = np.zeros((2, at.alpha_dot.shape[1]))
    first = {
        "none": none, "point": at.x_o_dot, "chart": at.alpha_dot[:n_o], "curve": at.alpha_dot[:n_o],
        "sign": still[:1],
    }  # fmt: skip
    last: dict[str, Any] = {
        "none": none, "curve": at.alpha_dot[-1:], "signed_curve": np.concatenate([at.alpha_dot[-1:], still])
    }  # fmt: skip
    return np.concatenate([first[layout[0]], last[layout[1]]])
