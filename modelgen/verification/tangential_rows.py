"""The tangential rows of a contact against material points that move: no lever, no cross product.

V is the rate of P_f - P_o with the coordinates of both points held, w comes from R_dot R^T; their own rates
follow along the motion of the extremal pair. The frame is taken as exported, its rate by differentiation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from modelgen.verification.contact_sides import Feature
from modelgen.verification.extremal_motion import Truth, columns, moved, placed, repeated
from modelgen.verification.findings import Finding, compared
from modelgen.verification.random_configurations import Configurations, Partnership

Array = np.ndarray[Any, Any]
POINTS = "rates of material points and rotations by differentiation of the motion"


@dataclass(frozen=True)
class Passing:
    """Relative motion of f and o at the closest points, world axes, one column per configuration."""

    V: Array  # (3,n) m/s
    V_dot: Array  # (3,n) m/s^2
    w: Array  # (3,n) rad/s
    w_dot: Array  # (3,n) rad/s^2


def _spin(R: ca.SX, t: ca.SX) -> ca.SX:
    W = ca.reshape(ca.jacobian(ca.vec(R), t), 3, 3) @ R.T
    return ca.vertcat(W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]) / 2


@cache
def _derivatives(o: Feature, f: Feature) -> ca.Function:
    alpha, t = ca.SX.sym("alpha", o.dimension + f.dimension), ca.SX.sym("t")
    sides = [[ca.SX.sym(f"s{i}{k}", size) for k, size in enumerate((12, 6, 6))] for i in range(2)]
    numbers = [ca.SX.sym("n", len(side.shape.parameter_names)) for side in (o, f)]
    places = [ca.SX.sym("place", 12) for _ in range(2)]
    local = (
        placed(o, alpha[: o.dimension], numbers[0], places[0])[1],
        placed(f, alpha[o.dimension :], numbers[1], places[1])[1],
    )
    (p_o, R_o), (p_f, R_f) = (moved(side[0], side[1], side[2], t) for side in sides)
    V = ca.jacobian(p_f + R_f @ local[1] - p_o - R_o @ local[0], t)
    w = _spin(R_f, t) - _spin(R_o, t)
    wanted = [V, ca.jacobian(V, t), ca.jacobian(V, alpha), w, ca.jacobian(w, t)]
    still = [ca.densify(entry) for entry in ca.substitute(wanted, [t], [ca.SX(0)])]
    return ca.Function("passing", [alpha, *sides[0], *sides[1], *numbers, *places], still)


def passing(pair: Partnership, at: Configurations, known: Truth) -> Passing:
    """Relative motion at the given closest points, whose coordinates move at the rates `known`."""
    n = at.n
    given = [repeated(entry, n) for entry in (*pair.numbers, *pair.placements)]
    V, V_t, V_alpha, w, w_dot = columns(
        _derivatives(pair.o, pair.f), at.alpha, at.pose_o, at.twist_o, at.accel_o,
        at.pose_f, at.twist_f, at.accel_f, *given,
    )  # fmt: skip
    carried = np.einsum("ink,kn->in", V_alpha.reshape(3, n, -1), known.alpha_dot)
    return Passing(V, V_t + carried, w, w_dot)


def row_products(J: Array, u: Array, rows: int) -> Array:
    """J u (rows,n) of J (rows x columns,n), row after row."""
    blocks = J.reshape(rows, -1, J.shape[1])
    return np.asarray(np.einsum("ijn,jn->in", blocks, u[: blocks.shape[1]]))


def check_slip(
    found: Passing, known: Truth, tangents: Array, rate: Array, speed: Array, gained: Array
) -> list[Finding]:
    """The exported frame and its rate, and J u and J u_dot + gamma of the rows below the first."""
    N = known.normal
    axes = [N, *tangents.reshape(2, 3, -1)]
    rates = [known.normal_rate, *rate.reshape(2, 3, -1)]
    vectors = [(found.V, found.V_dot), (found.w, found.w_dot)][: len(speed) // 3]
    first = np.array([np.sum(e * x, axis=0) for x, _ in vectors for e in axes])
    second = np.array(
        [
            np.sum(e_dot * x + e * x_dot, axis=0)
            for x, x_dot in vectors
            for e, e_dot in zip(axes, rates, strict=True)
        ]
    )
    _, t1, t2 = axes
    frame = np.concatenate([t1, t2, np.cross(t1, t2, axis=0)])
    right = np.concatenate([np.cross(t2, N, axis=0), np.cross(N, t1, axis=0), N])
    return [
        compared("tangents", "t1, t2 and N are right-handed and orthonormal", frame, right),
        compared("J", f"J u below the normal row: N, t1, t2 times V, then w; {POINTS}", speed[1:], first[1:]),
        compared("gamma", f"J u_dot + gamma is its rate; {POINTS}", gained[1:], second[1:]),
    ]
