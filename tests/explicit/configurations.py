"""Random extremal pairs with a centre, by construction, and their derivatives by a route of their own.

The centre C and the radius rho give d = N.(C - X) - rho on E.(C - X) = 0, with N the surface's normal, or the
direction from the curve to the centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from tests.curves.configurations import Truth, across, curve, units
from tests.curves.specimens import ALL
from tests.explicit.specimens import CENTRES, is_surface
from tests.laws.configurations import Array, columns, pose_of, rotation_taking, surface, turned
from tests.laws.oracle import moved


@dataclass(frozen=True)
class Pairs:
    """n extremal pairs; every array has one column per configuration."""

    alpha: Array  # (2,n) chart of the surface, or (1,n) parameter of the curve
    pose_o: Array
    pose_f: Array
    twist_o: Array
    twist_f: Array
    accel_o: Array
    accel_f: Array
    x_o: Array  # (3,n) shape frame
    d: Array  # (n,)

    @property
    def n(self) -> int:
        return len(self.d)


def random_pairs(o: str, f: str, n: int, seed: int) -> Pairs:
    """A third of the gaps positive, a third zero, a third negative; all positive of a point by a curve."""
    one, two = ALL[o], CENTRES[f]
    random = np.random.default_rng(seed)
    alpha = np.array([random.uniform(*ends, n) for ends in one.box])
    d = np.repeat([0.3, 0.0, -0.15], n)[::3][:n] * random.uniform(0.2, 1.0, n)
    R_o = rotation_taking(units(random, n), units(random, n), random.uniform(-3, 3, n))
    R_f = rotation_taking(units(random, n), units(random, n), random.uniform(-3, 3, n))
    if is_surface(o):
        x_o, n_o = columns(surface(one), alpha)
        N = turned(R_o, n_o)
    else:
        x_o, tangent = columns(curve(one), alpha)
        N = across(turned(R_o, tangent), units(random, n))
        d = np.abs(d) + 0.1 if two.radius == 0 else d
    p_o = random.normal(size=(3, n))
    centre = p_o + turned(R_o, x_o) + (d + two.radius) * N
    p_f = centre - (R_f @ np.array(two.at)).T
    motion = random.normal(size=(4, 6, n))
    return Pairs(alpha, pose_of(p_o, R_o), pose_of(p_f, R_f), *motion, x_o, d)


def carried(layout: tuple[str, str], alpha: Array, x_o: Array) -> Array:
    """eta, or its rate, as the form carries it."""
    kept = next((each for each in layout if each != "none"), "none")
    return {"none": alpha[:0], "point": x_o, "chart": alpha, "curve": alpha}[kept]


def lengths(o: str, f: str, n: int, swapped: bool = False) -> Array:
    sides = ALL[o].parameters, CENTRES[f].parameters
    numbers = [*sides[1], *sides[0]] if swapped else [*sides[0], *sides[1]]
    return np.tile(np.array(numbers).reshape(-1, 1), (1, n))


@cache
def _derivatives(o: str, f: str) -> ca.Function:
    one, two = ALL[o], CENTRES[f]
    alpha, t = ca.SX.sym("alpha", len(one.box)), ca.SX.sym("t")
    sides = [[ca.SX.sym(f"s{i}{k}", width) for k, width in enumerate((12, 6, 6))] for i in range(2)]
    (p_o, R_o), (p_f, R_f) = (moved(*side, t) for side in sides)
    form = one.chart if is_surface(o) else one.curve
    x_o = ca.vertcat(*form(ca, *ca.vertsplit(alpha), one.parameters))
    E = R_o @ ca.jacobian(x_o, alpha)
    between = p_f + R_f @ ca.DM(two.at) - p_o - R_o @ x_o
    towards = one.sign * ca.cross(E[:, 0], E[:, 1]) if is_surface(o) else between
    N = towards / ca.norm_2(towards) * (-1 if two.radius < 0 and not is_surface(o) else 1)
    d, g = N.T @ between - two.radius, E.T @ between
    d_t = ca.jacobian(d, t)
    wanted = [
        ca.jacobian(g, alpha), ca.jacobian(g, t), d, d_t, ca.jacobian(d_t, t), ca.jacobian(d_t, alpha).T,
        ca.hessian(d, alpha)[0], N, ca.jacobian(N, t), ca.jacobian(N, alpha), ca.jacobian(x_o, alpha),
    ]  # fmt: skip
    still = [ca.densify(entry) for entry in ca.substitute(wanted, [t], [ca.SX(0)])]
    return ca.Function("derivatives", [alpha, *sides[0], *sides[1]], still)


def truth(o: str, f: str, at: Pairs) -> Truth:
    """All derivatives on the given extremal pairs by implicit differentiation, as in the laws of surfaces."""
    size = len(at.alpha)
    motion = at.pose_o, at.twist_o, at.accel_o, at.pose_f, at.twist_f, at.accel_f
    out = columns(_derivatives(o, f), at.alpha, *motion)

    def stacked(value: Array) -> Array:
        return value.reshape(value.shape[0], at.n, size).transpose(1, 0, 2)

    g_alpha, d_aa, N_a, x_o_a = (stacked(out[i]) for i in (0, 6, 9, 10))
    rate = -np.linalg.solve(g_alpha, out[1].T[..., None])[..., 0].T

    def applied(matrix: Array) -> Array:
        return np.einsum("nij,jn->in", matrix, rate)

    d_ddot = out[4][0] + 2 * np.sum(out[5] * rate, axis=0) + np.sum(rate * applied(d_aa), axis=0)
    return Truth(out[2][0], out[3][0], d_ddot, rate, applied(x_o_a), out[7], out[8] + applied(N_a))
