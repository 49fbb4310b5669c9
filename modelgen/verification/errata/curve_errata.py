"""Rows of the erratum table on curves: Theorem 4.3 with Lemma 4.4 and Corollary 4.5, and Theorem 4.6."""

from __future__ import annotations

import numpy as np

from modelgen.verification.errata.random_data import Array, Ground, ground
from modelgen.verification.errata.surface_errata import Errors, applied, joined, size, two_curves


def _rates(at: Ground, side: str) -> Array:
    """True arc length rate of one side."""
    k = 0 if side == "o" else -1
    return np.asarray(at.paper[f"speed_{side}"] * at.sample.truth.alpha_dot[k])


def _system(at: Ground, sign: float) -> Array:
    """(4.10) and (4.11) with `sign` R_psi on the right of (4.11): l_o, l_f, phi_o, phi_f rates (n,4)."""
    p, found = at.paper, []
    for k in range(at.n):
        d, R, v, w = p["d"][k], p["R_psi"][k], p["v"][k], p["w"][k]
        (k_o, t_o), (k_f, t_f) = ((p[f"kappa_{s}"][k], p[f"tau_{s}"][k]) for s in "of")
        A = np.zeros((4, 4))  # unknowns l_o, l_f, phi_o, phi_f
        A[:2, 0] = -R @ [1 + d * k_o, -d * t_o]
        A[:2, 1] = [1, 0]
        A[:2, 2] = -R @ [0, -d]
        A[2:, 0] = -sign * R @ [k_o, -t_o]
        A[2:, 1] = [k_f, -t_f]
        A[2:, 2] = -sign * R @ [0, -1]
        A[2:, 3] = [0, -1]
        found.append(np.linalg.solve(A, -np.array([v[0], v[1], w[1], -w[0]])))
    return np.array(found)


def contact_frames(n: int, seed: int) -> Errors:
    """(4.11): all four rates of (4.10) and (4.11), without and with the minus."""
    at = two_curves(n, seed)
    angles = at.angle_rates
    true = np.stack([_rates(at, "o"), _rates(at, "f"), angles["phi_o"], angles["phi_f"]], axis=1)
    return size(_system(at, 1.0) - true), size(_system(at, -1.0) - true)


def spin_row(n: int, seed: int) -> Errors:
    """(C.18), third row: psi_dot with either sign of k_o cos(phi_o) l_o_dot."""
    at = two_curves(n, seed)
    p, psi_dot = at.paper, at.angle_rates["psi"]
    own = p["geodesic_o"] * _rates(at, "o")
    rest = p["w"][:, 2] + p["geodesic_f"] * _rates(at, "f") - psi_dot
    return np.abs(rest - own), np.abs(rest + own)


def crossed_normal(n: int, seed: int) -> Errors:
    """(4.15): N = T1 x T2/|T1 x T2| without and with the factor -sgn(sin(psi))."""
    at = two_curves(n, seed)
    crossed = np.cross(at.paper["T_o"], at.paper["T_f"])
    crossed /= size(crossed)[:, None]
    sign = -np.sign(-at.paper["R_psi"][:, 0, 1])
    return size(crossed - at.N), size(sign[:, None] * crossed - at.N)


def tangent_rate(n: int, seed: int) -> Errors:
    """(4.17), (4.18): T_dot = w x T + k n, without and with l_dot."""
    at = two_curves(n, seed)
    parts = []
    for side, k in (("o", 0), ("f", -1)):
        w, p = at.world(side).w, at.paper
        turned = np.cross(w, p[f"T_{side}"])
        true = turned + p[f"T_rate_{side}"] * at.sample.truth.alpha_dot[k][:, None]
        bent, rate = p[f"kN_{side}"], _rates(at, side)[:, None]
        parts.append((size(turned + bent - true), size(turned + bent * rate - true)))
    return joined(parts)


def _touching(at: Ground) -> Array:
    return np.asarray(at.sample.at.d == 0)


def _angle(at: Ground) -> tuple[Array, Array]:
    """sin(psi) and cot(psi)."""
    sine = -at.paper["R_psi"][:, 0, 1]
    return sine, at.paper["R_psi"][:, 0, 0] / sine


def _xi(at: Ground, sign: float) -> Array:
    """(4.25) with `sign` R_psi."""
    p = at.paper
    own_f = np.stack([p["kappa_f"], -p["tau_f"]], axis=1) * _rates(at, "f")[:, None]
    own_o = np.stack([p["kappa_o"], -p["tau_o"]], axis=1) * _rates(at, "o")[:, None]
    turned = np.stack([p["w"][:, 1], -p["w"][:, 0]], axis=1)
    return np.asarray(turned + own_f + sign * applied(p["R_psi"], own_o))


def slide_of_f(n: int, seed: int) -> Errors:
    """(4.20): l_f_dot = -v_x + cot(psi) v_y, or minus; touching curves."""
    at = two_curves(n, seed)
    v, (_, cot), here = at.paper["v"], _angle(at), _touching(at)
    rest = -v[:, 0] - _rates(at, "f")
    return np.abs(rest + cot * v[:, 1])[here], np.abs(rest - cot * v[:, 1])[here]


def turn_of_o(n: int, seed: int) -> Errors:
    """(4.21) with (4.25): phi_o_dot = -xi_x/sin(psi), xi with -R_psi or with +R_psi."""
    at = two_curves(n, seed)
    (sine, _), here = _angle(at), _touching(at)
    errors = [np.abs(-_xi(at, sign)[:, 0] / sine - at.angle_rates["phi_o"])[here] for sign in (-1.0, 1.0)]
    return errors[0], errors[1]


def turn_of_f(n: int, seed: int) -> Errors:
    """(4.22): phi_f_dot = -xi_y + cot(psi) xi_x, or with both signs turned round; xi with +R_psi."""
    at = two_curves(n, seed)
    (_, cot), here, xi = _angle(at), _touching(at), _xi(at, 1.0)
    value, true = xi[:, 1] - cot * xi[:, 0], at.angle_rates["phi_f"]
    return np.abs(-value - true)[here], np.abs(value - true)[here]


def sphere_row(n: int, seed: int) -> Errors:
    """(4.31): (k_f sin(phi_f) l_f_dot + w_y) = beta_x/R, or with a minus, R the radius of a sphere."""
    at = ground("sphere", "helix", "curve_paper", n, seed)
    p = at.paper
    R = 1 / p["K_o"][:, 0, 0]
    stretch, kappa, v_x, w_y = 1 + p["d"] / R, p["kappa_f"], p["v"][:, 0], p["w"][:, 1]

    def error(sign: float) -> Array:
        """l_f + v_x = (1 + d/R) beta_x and kappa_f l_f + w_y = sign beta_x/R."""
        rate = (sign * v_x / (R * stretch) - w_y) / (kappa - sign / (R * stretch))
        return np.abs(rate - _rates(at, "f"))

    return error(1.0), error(-1.0)


def arc_length(n: int, seed: int) -> Errors:
    """Theorems 4.3 and 4.6: l_dot in the place of t_dot, and l_dot = |c'| t_dot."""

    def errors(at: Ground, side: str) -> Errors:
        rate = _system(at, -1.0)[:, 0 if side == "o" else 1]
        true = at.sample.truth.alpha_dot[0 if side == "o" else -1]
        return np.abs(rate - true), np.abs(rate / at.paper[f"speed_{side}"] - true)

    return joined([errors(two_curves(n, seed), side) for side in "of"])
