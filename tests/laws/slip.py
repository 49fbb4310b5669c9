"""What the rows of slip, spin and rolling are, from positions of material points and from rotations alone."""

from __future__ import annotations

from functools import cache
from typing import Protocol

import casadi as ca
import numpy as np

from tests.laws.configurations import Array, columns, rotation_of, turned
from tests.laws.oracle import moved


class Motion(Protocol):
    """Extremal pairs that move, one column per configuration."""

    pose_o: Array
    pose_f: Array
    twist_o: Array
    twist_f: Array
    accel_o: Array
    accel_f: Array
    x_o: Array


class Derivatives(Protocol):
    """Of the extremal pairs, by implicit differentiation."""

    d: Array
    d_dot: Array
    x_o_dot: Array
    normal: Array
    normal_rate: Array


def frame(n: ca.SX) -> ca.SX:
    """(3,2): e_x and +-e_y of the pole +-e_z, turned with it by the least rotation that takes it to n."""
    side = ca.if_else(n[2] >= -0.38, 1, -1)
    pole = ca.vertcat(0, 0, side)
    K = ca.skew(ca.cross(pole, n))
    R = ca.SX.eye(3) + K + K @ K / (1 + ca.dot(pole, n))
    return R @ ca.vertcat(ca.horzcat(1, 0), ca.horzcat(0, side), ca.horzcat(0, 0))


def spin(R: ca.SX, t: ca.SX) -> ca.SX:
    """World angular velocity of R(t)."""
    W = ca.reshape(ca.jacobian(ca.vec(R), t), 3, 3) @ R.T
    return ca.vertcat(W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]) / 2


@cache
def _rows() -> ca.Function:
    """Points held on their bodies, then carried along: N.V, t.V, N.w, t.w and their rates; the tangents."""
    x, x_dot = ca.SX.sym("x", 6), ca.SX.sym("x_dot", 6)
    N, N_dot, t = ca.SX.sym("N", 3), ca.SX.sym("N_dot", 3), ca.SX.sym("t")
    sides = [[ca.SX.sym("s", size) for size in (12, 6, 6)] for _ in range(2)]
    (p_o, R_o), (p_f, R_f) = (moved(*side, t) for side in sides)
    V = ca.jacobian(p_f + R_f @ x[3:] - p_o - R_o @ x[:3], t)
    w = spin(R_f, t) - spin(R_o, t)
    T = R_o @ frame(R_o.T @ N)
    axes = ca.horzcat(N, T)
    values = ca.vertcat(axes.T @ V, axes.T @ w)
    rates = ca.jacobian(values, t) + ca.jtimes(values, x, x_dot) + ca.jtimes(values, N, N_dot)
    still = ca.substitute([values, rates, ca.vec(T)], [t], [ca.SX(0)])
    return ca.Function("rows", [x, x_dot, N, N_dot, *sides[0], *sides[1]], still)


def expected_rows(at: Motion, known: Derivatives) -> tuple[Array, Array, Array]:
    """(6,n) the rows times u, (6,n) their rates, and (6,n) the tangents; P_f = P_o + d N places f's point."""
    R_o, R_f = rotation_of(at.pose_o), rotation_of(at.pose_f)
    to_f = R_f.transpose(0, 2, 1)
    reach = turned(R_o, at.x_o) + known.d * known.normal
    x_f = turned(to_f, at.pose_o[:3] + reach - at.pose_f[:3])
    point = at.twist_o[:3] + turned(R_o, np.cross(at.twist_o[3:], at.x_o, axis=0) + known.x_o_dot)
    point = point + known.d_dot * known.normal + known.d * known.normal_rate
    x_f_dot = turned(to_f, point - at.twist_f[:3]) - np.cross(at.twist_f[3:], x_f, axis=0)
    return columns(  # type: ignore[return-value]
        _rows(), np.concatenate([at.x_o, x_f]), np.concatenate([known.x_o_dot, x_f_dot]),
        known.normal, known.normal_rate,
        at.pose_o, at.twist_o, at.accel_o, at.pose_f, at.twist_f, at.accel_f,
    )  # fmt: skip


def times(J: Array, u: Array, rows: int) -> Array:
    """(rows,n) of J, row after row."""
    blocks = J.reshape(rows, -1, J.shape[1])
    return np.einsum("ijn,jn->in", blocks, u[: blocks.shape[1]])
