"""Rows of the erratum table on singular configurations, and claims that are too strong.

The route is the Jacobian g_eta of the extremality system: |det g_eta| over its metric factors is |A|, |S| or
|D| of the contact, and vanishes where the paper says that a contact is singular, if it is right.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modelgen.verification.contacts import Sample
from modelgen.verification.errata.random_data import Array, ground
from modelgen.verification.errata.surface_errata import Errors, dot
from modelgen.verification.extremal_motion import truth
from modelgen.verification.random_configurations import Configurations, taking


def _determinants(drawn: Sample, at: Configurations) -> Array:
    """|det g_eta|."""
    with np.errstate(all="ignore"):
        return np.asarray(np.abs(np.linalg.det(truth(drawn.pair, at).g_alpha)))


def _area(forms: Array) -> Array:
    """det(M)^2."""
    return np.asarray(np.linalg.det(forms) ** 2)


def _beside_sphere(n: int, seed: int, tilted: bool, concave: bool) -> Array:
    """|S| m of a circle and a sphere at gap d; its signed radius of normal curvature is R + d, hollow side
    towards the sphere if concave."""
    at = ground("sphere", "circle", "curve_paper", n, seed)
    random = np.random.default_rng(seed)
    o, N, R = at.world("o"), at.N, at.sample.pair.numbers[0][0]
    d = random.uniform(0.1, 1.0, at.n)
    tilt = random.uniform(-1.2, 1.2, at.n) if tilted else np.zeros(at.n)
    radius = (R + d) * np.cos(tilt)
    poses, sizes = [], []
    for k in range(at.n):
        side = np.cross(N[k], random.normal(size=3))
        side /= np.linalg.norm(side)
        turned = taking(N[k], N[k], random)
        T = turned @ side
        outward = np.cos(tilt[k]) * N[k] + np.sin(tilt[k]) * np.cross(N[k], T)
        outward *= 1.0 if concave else -1.0
        axes = np.array([outward, T, np.cross(outward, T)]).T
        point = o.p[k] + o.r[k] + d[k] * N[k]
        poses.append(np.concatenate([point - radius[k] * outward, axes.T.ravel()]))
        sizes.append(radius[k])
    dets = []
    for k in range(at.n):
        drawn = at.sample
        pair = replace(drawn.pair, numbers=(drawn.pair.numbers[0], np.array([sizes[k]])))
        alpha = drawn.at.alpha[:, k : k + 1].copy()
        alpha[2] = 0.0
        one = replace(_column(drawn.at, k), alpha=alpha, pose_f=poses[k][:, None])
        dets.append(_determinants(replace(drawn, pair=pair), one)[0])
    return np.asarray(np.array(dets) / (_area(at.paper["M_o"]) * radius**2) * R)


def _column(at: Configurations, k: int) -> Configurations:
    return Configurations(**{name: value[..., k : k + 1] for name, value in vars(at).items()})


def sphere_condition(n: int, seed: int) -> Errors:
    """(4.33): |S| R where the printed condition says singular (a convex circle), and at a concave one."""
    return tuple(_beside_sphere(n, seed, False, concave) for concave in (False, True))  # type: ignore[return-value]


def radius_condition(n: int, seed: int) -> Errors:
    """(4.35): |S| R at r = -(R + d) as printed and at r = R + d, of circles at any inclination."""
    return tuple(_beside_sphere(n, seed, True, concave) for concave in (False, True))  # type: ignore[return-value]


def only_for_spheres(n: int, seed: int) -> Errors:
    """(4.32), (4.33) "iff": |S| at 1 + d k_1 = 0 on an ellipsoid, and less k_1 (1 + d k_2) cos^2."""
    at = ground("ellipsoid", "circle", "curve_paper", n, seed)
    p, drawn = at.paper, at.sample
    curvatures, directions = np.linalg.eigh((p["K_o"] + p["K_o"].transpose(0, 2, 1)) / 2)
    first, second = curvatures.T
    d = -1 / first
    shifted = drawn.at.pose_f.copy()
    shifted[:3] += (d - drawn.at.d) * at.N.T
    moved = replace(drawn.at, pose_f=shifted, d=d)
    S = _determinants(drawn, moved) / (_area(p["M_o"]) * p["speed_f"] ** 2)
    axis = np.einsum("nij,nj->ni", p["axes_o"], directions[:, :, 0])
    expected = np.abs(first * (1 + d * second)) * dot(p["T_f"], axis) ** 2
    return S, np.abs(S - expected)


def convex_pairs(n: int, seed: int) -> Errors:
    """Section 4.1.2, d >= 0: 1 where A is not positive definite; 1 where det A is not positive."""
    random = np.random.default_rng(seed)
    count = 20 * n
    K_o, K_f = (_positive(random, count) for _ in range(2))
    d, psi = random.exponential(2.0, count), random.uniform(-np.pi, np.pi, count)
    c, s = np.cos(psi), np.sin(psi)
    R = np.array([[c, -s], [-s, -c]]).transpose(2, 0, 1)
    K_t = R @ K_o @ R
    A = K_f + K_t + d[:, None, None] * K_t @ K_f
    definite = np.linalg.eigvalsh(A + A.transpose(0, 2, 1))[:, 0] > 0
    return (~definite).astype(float), (np.linalg.det(A) <= 0).astype(float)


def _positive(random: np.random.Generator, count: int) -> Array:
    roots = random.normal(size=(count, 2, 2))
    return np.asarray(roots @ roots.transpose(0, 2, 1) + 0.01 * np.eye(2))


def parallel_tangents(n: int, seed: int) -> Errors:
    """Section 4.2.2, d not 0: |D| at sin(psi) = 0, said to be singular; and less |(1+dk)(1+dk) - cos^2|."""
    at = ground("ellipse_curve", "helix", "curves_paper", n, seed)
    random = np.random.default_rng(seed)
    drawn, p, o = at.sample, at.paper, at.world("o")
    d = random.uniform(0.1, 0.5, at.n)
    poses, expected = [], []
    for k in range(at.n):
        T_f, T_o, N = p["T_f"][k], p["T_o"][k], at.N[k]
        turn = taking(T_f, T_o, random)
        R_f = turn @ at.world("f").R[k]
        point = o.p[k] + o.r[k] + d[k] * N
        poses.append(np.concatenate([point - turn @ at.world("f").r[k], R_f.T.ravel()]))
        bent_o, bent_f = -N @ p["kN_o"][k], N @ turn @ p["kN_f"][k]
        expected.append((1 + d[k] * bent_o) * (1 + d[k] * bent_f) - 1)
    moved = replace(drawn.at, pose_f=np.array(poses).T, d=d)
    D = _determinants(drawn, moved) / (p["speed_o"] * p["speed_f"]) ** 2
    return D, np.abs(D - np.abs(expected))
