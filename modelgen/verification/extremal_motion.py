"""The independent route of contacts: exact time derivatives of an extremal pair, accelerations included.

Bodies move by p + v t + a t^2/2 and R (I + h + h^2/2), h = hat(w t + w_dot t^2/2): exact to second order.
g(alpha, t) = 0 gives alpha_dot by a dense numerical solve; d_ddot = d_tt + 2 d_ta alpha_dot + alpha_dot.d_aa
alpha_dot, since d_a = 0 on extremal pairs. No formula of the forms is used: no J, no Gamma, no curvature.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from modelgen.verification.contact_sides import Feature
from modelgen.verification.random_configurations import Configurations, Partnership

Array = np.ndarray[Any, Any]
CONDITION = 1e3  # of g_alpha with rows and columns of equal length: worse pairs are near a singularity


@dataclass(frozen=True)
class Truth:
    """Derivatives along the motion, one column per configuration."""

    d: Array  # (n,) m
    d_dot: Array  # (n,) m/s
    d_ddot: Array  # (n,) m/s^2
    alpha_dot: Array  # (k,n)
    x_o: Array  # (3,n) m, shape frame
    x_f: Array
    x_o_dot: Array  # (3,n) m/s
    x_f_dot: Array
    point_o: Array  # (3,n) m, world
    point_f: Array
    normal: Array  # (3,n)
    normal_rate: Array  # (3,n) 1/s
    g_alpha: Array  # (n,k,k) Jacobian of extremality
    regular: Array  # (n,) whether g_alpha is well conditioned
    nearest: (
        Array  # (n,) whether the point of f is a strict minimum of its distance to the tangent plane of o
    )


def columns(f: ca.Function, *arrays: Array) -> tuple[Array, ...]:
    """f on every column; an array of more rows than f takes is cut."""
    n = arrays[0].shape[1]
    cut = [array[: f.size1_in(k)] for k, array in enumerate(arrays)]
    return tuple(np.asarray(out) for out in f.map(n).call(cut))


def repeated(values: Array, n: int) -> Array:
    """(k,n) of (k,)."""
    return np.tile(values.reshape(-1, 1), (1, n))


def moved(pose: ca.SX, twist: ca.SX, accel: ca.SX, t: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Position and rotation at time t."""
    h = ca.skew(twist[3:] * t + accel[3:] * t**2 / 2)
    R = ca.reshape(pose[3:], 3, 3)
    return pose[:3] + twist[:3] * t + accel[:3] * t**2 / 2, R @ (ca.SX.eye(3) + h + h @ h / 2)


def placed(feature: Feature, alpha: ca.SX, p: ca.SX, placement: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Point in the shape frame; point and tangents in body axes."""
    x = feature.point(alpha, p)
    R = ca.reshape(placement[3:], 3, 3)
    return x, placement[:3] + R @ x, R @ ca.jacobian(x, alpha)


@cache
def _derivatives(o: Feature, f: Feature) -> ca.Function:
    n_o, n_f = o.dimension, f.dimension
    alpha, t, sign = ca.SX.sym("alpha", n_o + n_f), ca.SX.sym("t"), ca.SX.sym("sign")
    sides = [[ca.SX.sym(f"s{i}{k}", size) for k, size in enumerate((12, 6, 6))] for i in range(2)]
    numbers = [ca.SX.sym("n", len(side.shape.parameter_names)) for side in (o, f)]
    places = [ca.SX.sym("place", 12) for _ in range(2)]
    x_o, b_o, e_o = placed(o, alpha[:n_o], numbers[0], places[0])
    x_f, b_f, e_f = placed(f, alpha[n_o:], numbers[1], places[1])
    (p_o, R_o), (p_f, R_f) = (moved(side[0], side[1], side[2], t) for side in sides)
    point_o, point_f, E_o, E_f = p_o + R_o @ b_o, p_f + R_f @ b_f, R_o @ e_o, R_f @ e_f
    between = point_f - point_o
    if n_o == 2:
        N = o.normal(E_o)
    elif n_f == 1:
        N = sign * ca.cross(E_o, E_f) / ca.norm_2(ca.cross(E_o, E_f))
    else:
        N = between / ca.norm_2(between)
    g = ca.vertcat(E_o.T @ between, E_f.T @ (N if n_o == 2 else between))
    d = N.T @ between
    d_t = ca.jacobian(d, t)
    wanted = [
        ca.jacobian(g, alpha), ca.jacobian(g, t), d, d_t, ca.jacobian(d_t, t), ca.jacobian(d_t, alpha).T,
        ca.hessian(d, alpha)[0], N, ca.jacobian(N, t), ca.jacobian(N, alpha), x_o, x_f,
        ca.jacobian(x_o, alpha), ca.jacobian(x_f, alpha), point_o, point_f,
    ]  # fmt: skip
    still = [ca.densify(entry) for entry in ca.substitute(wanted, [t], [ca.SX(0)])]
    return ca.Function("derivatives", [alpha, sign, *sides[0], *sides[1], *numbers, *places], still)


def truth(pair: Partnership, at: Configurations) -> Truth:
    """All derivatives on the given extremal pairs."""
    n, k = at.n, len(at.alpha)
    given = [repeated(entry, n) for entry in (*pair.numbers, *pair.placements)]
    out = columns(
        _derivatives(pair.o, pair.f), at.alpha, at.sign[None], at.pose_o, at.twist_o, at.accel_o,
        at.pose_f, at.twist_f, at.accel_f, *given,
    )  # fmt: skip

    def stacked(value: Array) -> Array:
        return value.reshape(value.shape[0], n, k).transpose(1, 0, 2)

    g_alpha, d_aa, N_a, x_o_a, x_f_a = (stacked(out[i]) for i in (0, 6, 9, 12, 13))
    conditions = np.array([_condition(matrix) for matrix in g_alpha])
    solvable = np.where((conditions < CONDITION)[:, None, None], g_alpha, np.eye(k))
    rate = -np.linalg.solve(solvable, out[1].T[..., None])[..., 0].T

    def applied(matrix: Array) -> Array:
        return np.asarray(np.einsum("nij,jn->in", matrix, rate))

    second = out[4][0] + 2 * np.sum(out[5] * rate, axis=0) + np.sum(rate * applied(d_aa), axis=0)
    return Truth(
        d=out[2][0], d_dot=out[3][0], d_ddot=second, alpha_dot=rate, x_o=out[10], x_f=out[11],
        x_o_dot=applied(x_o_a), x_f_dot=applied(x_f_a), point_o=out[14], point_f=out[15], normal=out[7],
        normal_rate=out[8] + applied(N_a), g_alpha=g_alpha, regular=conditions < CONDITION,
        nearest=_definite(d_aa[:, pair.o.dimension :, pair.o.dimension :]),
    )  # fmt: skip


def _condition(matrix: Any) -> float:
    rows = matrix / np.maximum(np.linalg.norm(matrix, axis=1, keepdims=True), 1e-300)
    scaled = rows / np.maximum(np.linalg.norm(rows, axis=0, keepdims=True), 1e-300)
    return float(np.linalg.cond(scaled)) if np.isfinite(scaled).all() else np.inf


def _definite(matrices: Array) -> Array:
    if matrices.shape[1] == 0:
        return np.ones(len(matrices), dtype=bool)
    return np.asarray((np.linalg.eigvalsh(matrices) > 0).all(axis=1))
