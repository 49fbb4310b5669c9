"""Rows of the erratum table on N, J, Gamma_2 and the rates of two surfaces: printed and corrected errors."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from modelgen.verification.contact_sides import Feature
from modelgen.verification.errata.random_data import Array, Body, Ground, ground
from modelgen.verification.extremal_motion import columns, repeated

Errors = tuple[Array, Array]  # of the printed and of the corrected formula, one per configuration


def surfaces(n: int, seed: int) -> Ground:
    return ground("ellipsoid", "torus", "paper", n, seed)


def curve_and_surface(n: int, seed: int) -> Ground:
    return ground("ellipsoid", "helix", "curve_paper", n, seed)


def two_curves(n: int, seed: int) -> Ground:
    return ground("ellipse_curve", "helix", "curves_paper", n, seed)


EVERY = (surfaces, curve_and_surface, two_curves)


def dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1))


def applied(A: Array, x: Array) -> Array:
    return np.asarray(np.einsum("nij,nj->ni", A, x))


def size(x: Array) -> Array:
    return np.asarray(np.linalg.norm(x, axis=-1))


def joined(parts: list[Errors]) -> Errors:
    printed, corrected = zip(*parts, strict=True)
    return np.concatenate(printed), np.concatenate(corrected)


def row_of_J(at: Ground, N: Array) -> tuple[Array, Array]:
    """J v and J v_dot of (3.3) for a normal."""
    o, f = at.world("o"), at.world("f")

    def times(linear: Any, angular: Any) -> Array:
        return (
            dot(N, linear(f) - linear(o))
            + dot(np.cross(f.r, N), angular(f))
            - dot(np.cross(o.r, N), angular(o))
        )

    return times(lambda b: b.v, lambda b: b.w), times(lambda b: b.v_dot, lambda b: b.w_dot)


def extremal_points(n: int, seed: int) -> Errors:
    """(2.1): how much of rank 4 the Jacobian of the system lacks at touching contact."""
    at = surfaces(n, seed)
    drawn = at.sample
    touching = drawn.at.d == 0
    pair = drawn.pair
    numbers = [repeated(entry, drawn.n) for entry in pair.numbers]
    G = columns(_stationary(pair.o, pair.f), drawn.at.alpha, drawn.at.pose_o, drawn.at.pose_f, *numbers)[0]
    printed = G.reshape(4, drawn.n, 4).transpose(1, 0, 2)

    def lacking(matrices: Array) -> Array:
        return 4.0 - np.array([np.linalg.matrix_rank(each, tol=1e-9) for each in matrices[touching]])

    return lacking(printed), lacking(drawn.truth.g_alpha)


def _stationary(o: Feature, f: Feature) -> ca.Function:
    """Jacobian of g = grad |P_f - P_o|^2/2 by alpha."""
    alpha = ca.SX.sym("alpha", 4)
    poses = [ca.SX.sym("pose", 12) for _ in range(2)]
    numbers = [ca.SX.sym("p", len(side.shape.parameter_names)) for side in (o, f)]
    x = [o.point(alpha[:2], numbers[0]), f.point(alpha[2:], numbers[1])]
    P = [pose[:3] + ca.reshape(pose[3:], 3, 3) @ point for pose, point in zip(poses, x, strict=True)]
    H = ca.hessian(ca.sumsqr(P[1] - P[0]) / 2, alpha)[0]
    return ca.Function("stationary", [alpha, *poses, *numbers], [ca.densify(H)])


def normal(n: int, seed: int) -> Errors:
    """(3.1): d_dot = J v with either normal."""

    def errors(at: Ground) -> Errors:
        d_dot = at.sample.truth.d_dot
        return np.abs(row_of_J(at, -at.N)[0] - d_dot), np.abs(row_of_J(at, at.N)[0] - d_dot)

    return joined([errors(case(n, seed)) for case in EVERY])


def gap_bias(n: int, seed: int) -> Errors:
    """(3.11): d_ddot = J v_dot + Gamma_2 with either sign of the centripetal terms."""

    def errors(at: Ground) -> Errors:
        o, f, N, Nd = at.world("o"), at.world("f"), at.N, at.N_dot

        def pull(b: Body) -> Array:
            return dot(np.cross(b.w, b.r), np.cross(b.w, N))

        def rest(b: Body) -> Array:
            return dot(Nd, b.v) + dot(np.cross(b.r, Nd), b.w) + dot(np.cross(b.slide, N), b.w)

        left = at.sample.truth.d_ddot - row_of_J(at, N)[1] - rest(f) + rest(o)
        return np.abs(left - pull(f) + pull(o)), np.abs(left + pull(f) - pull(o))

    return joined([errors(case(n, seed)) for case in EVERY])


def gap_rate(n: int, seed: int) -> Errors:
    """(4.4), (4.12), (4.23), (4.28), (B.7): d_dot = v_z or -v_z, V by Appendix E, z_f = -N."""

    def errors(at: Ground) -> Errors:
        o, f = at.world("o"), at.world("f")
        v = f.v - o.v - np.cross(o.w, f.p - o.p) - np.cross(f.r, f.w - o.w)
        v_z, d_dot = dot(-at.N, v), at.sample.truth.d_dot
        return np.abs(v_z - d_dot), np.abs(-v_z - d_dot)

    return joined([errors(case(n, seed)) for case in EVERY])


def normal_rate(n: int, seed: int) -> Errors:
    """(4.5): the tangent components need the basis [x_o y_o]."""
    at = surfaces(n, seed)
    o, paper = at.world("o"), at.paper
    bent = applied(paper["K_o"], applied(paper["M_o"], at.sample.truth.alpha_dot[:2].T))
    turned = np.cross(o.w, at.N)
    printed = turned + applied(o.R[:, :, :2], bent)
    return size(printed - at.N_dot), size(turned + applied(paper["axes_o"], bent) - at.N_dot)


def orthogonal_charts(n: int, seed: int) -> Errors:
    """Appendix E.1, Lemma B.1: (4.1) and (4.2) with M = diag(|c_u|, |c_v|) and with Gram-Schmidt frames."""
    at = surfaces(n, seed)
    p, alpha_dot = at.paper, at.sample.truth.alpha_dot.T
    x_o, y_o = np.moveaxis(p["literal_axes_o"], 2, 0)
    x_f = p["literal_axes_f"][:, :, 0]
    psi = np.arctan2(-dot(x_f, y_o), dot(x_f, x_o))
    c, s = np.cos(psi), np.sin(psi)
    R_psi = np.array([[c, -s], [-s, -c]]).transpose(2, 0, 1)
    frame = np.einsum("nik,nij->nkj", p["literal_axes_f"], p["axes_f"])
    v = applied(frame, p["v"])
    w_J = applied(frame, np.stack([-p["w"][:, 1], p["w"][:, 0]], axis=1))
    literal = (p["literal_M_o"], p["literal_M_f"], p["literal_K_o"], p["literal_K_f"])
    printed = theorem(literal, R_psi, p["d"], v, w_J)
    own = (p["M_o"], p["M_f"], p["K_o"], p["K_f"])
    turned = np.stack([-p["w"][:, 1], p["w"][:, 0]], axis=1)
    corrected = theorem(own, p["R_psi"], p["d"], p["v"], turned)
    return size(printed - alpha_dot), size(corrected - alpha_dot)


def theorem(forms: tuple[Array, ...], R_psi: Array, d: Array, v: Array, w_J: Array) -> Array:
    """(4.1) and (4.2): (alpha_o_dot, alpha_f_dot), (n,4)."""
    M_o, M_f, K_o, K_f = forms
    K_t, d = R_psi @ K_o @ R_psi, d[:, None, None]
    right_f = w_J + d[:, 0] * applied(K_t, w_J) - applied(K_t, v)
    slip_f = np.linalg.solve(K_f + K_t + d * K_t @ K_f, right_f[..., None])
    slip_o = np.linalg.solve(K_f + K_t + d * K_f @ K_t, (w_J + applied(K_f, v))[..., None])
    rates = np.linalg.solve(M_o, R_psi @ slip_o), np.linalg.solve(M_f, slip_f)
    return np.concatenate([rate[..., 0] for rate in rates], axis=1)
