"""The independent route: exact derivatives of the implicit extremal pair, accelerations included.

Bodies move by p + v t + a t^2/2 and R (I + h + h^2/2), h = hat(w t + w_dot t^2/2): exact to second order.
g(alpha, t) = 0 gives alpha_dot by a dense numerical solve; d_ddot = d_tt + 2 d_ta alpha_dot + alpha_dot.d_aa
alpha_dot, since d_a = 0 on extremal pairs. No formula of the package is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from tests.laws.configurations import Array, Configurations, columns
from tests.laws.shapes import Specimen


@dataclass(frozen=True)
class Truth:
    """Derivatives along the motion, one column per configuration."""

    d: Array  # (n,)
    d_dot: Array
    d_ddot: Array
    alpha_dot: Array  # (4,n)
    x_o_dot: Array  # (3,n) shape frame
    x_f_dot: Array
    normal: Array  # (3,n)
    normal_rate: Array


def moved(pose: ca.SX, twist: ca.SX, accel: ca.SX, t: ca.SX) -> tuple[ca.SX, ca.SX]:
    h = ca.skew(twist[3:] * t + accel[3:] * t**2 / 2)
    R = ca.reshape(pose[3:], 3, 3)
    return pose[:3] + twist[:3] * t + accel[:3] * t**2 / 2, R @ (ca.SX.eye(3) + h + h @ h / 2)


@cache
def _derivatives(o: Specimen, f: Specimen) -> ca.Function:
    alpha, t = ca.SX.sym("alpha", 4), ca.SX.sym("t")
    sides = [[ca.SX.sym(f"s{i}{k}", size) for k, size in enumerate((12, 6, 6))] for i in range(2)]
    p_o, R_o = moved(*sides[0], t)
    p_f, R_f = moved(*sides[1], t)
    x_o = ca.vertcat(*o.chart(ca, alpha[0], alpha[1], o.parameters))
    x_f = ca.vertcat(*f.chart(ca, alpha[2], alpha[3], f.parameters))
    E_o, E_f = R_o @ ca.jacobian(x_o, alpha[:2]), R_f @ ca.jacobian(x_f, alpha[2:])
    normal = o.sign * ca.cross(E_o[:, 0], E_o[:, 1])
    N = normal / ca.norm_2(normal)
    between = p_f + R_f @ x_f - p_o - R_o @ x_o
    g = ca.vertcat(E_o.T @ between, E_f.T @ N)
    d = N.T @ between
    d_t = ca.jacobian(d, t)
    wanted = [
        ca.jacobian(g, alpha), ca.jacobian(g, t), d, d_t, ca.jacobian(d_t, t), ca.jacobian(d_t, alpha).T,
        ca.hessian(d, alpha)[0], N, ca.jacobian(N, t), ca.jacobian(N, alpha),
        ca.jacobian(x_o, alpha), ca.jacobian(x_f, alpha),
    ]  # fmt: skip
    still = [ca.densify(entry) for entry in ca.substitute(wanted, [t], [ca.SX(0)])]
    return ca.Function("derivatives", [alpha, *sides[0], *sides[1]], still)


def truth(o: Specimen, f: Specimen, at: Configurations) -> Truth:
    """All derivatives on the given extremal pairs."""
    n = at.alpha.shape[1]
    out = columns(
        _derivatives(o, f), at.alpha, at.pose_o, at.twist_o, at.accel_o, at.pose_f, at.twist_f, at.accel_f
    )

    def stacked(value: Array, width: int) -> Array:
        return value.reshape(value.shape[0], n, width).transpose(1, 0, 2)

    g_alpha, d_aa, N_a, x_o_a, x_f_a = (
        stacked(out[i], width) for i, width in ((0, 4), (6, 4), (9, 4), (10, 4), (11, 4))
    )
    rate = -np.linalg.solve(g_alpha, out[1].T[..., None])[..., 0].T

    def applied(matrix: Array) -> Array:
        return np.einsum("nij,jn->in", matrix, rate)

    d_ddot = out[4][0] + 2 * np.sum(out[5] * rate, axis=0) + np.sum(rate * applied(d_aa), axis=0)
    return Truth(
        d=out[2][0],
        d_dot=out[3][0],
        d_ddot=d_ddot,
        alpha_dot=rate,
        x_o_dot=applied(x_o_a),
        x_f_dot=applied(x_f_a),
        normal=out[7],
        normal_rate=out[8] + applied(N_a),
    )


def eta_dot_of(layout: tuple[str, str], at: Truth) -> Array:
    """The rate of eta as the form carries it."""
    none = at.x_o_dot[:0]
    carried = {
        "none": (none, none), "chart": (at.alpha_dot[:2], at.alpha_dot[2:]), "point": (at.x_o_dot, at.x_f_dot)
    }  # fmt: skip
    return np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])
