"""Random pairs of ellipsoids at known gaps, their true normals in extended precision, and small motions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.running import library_of

Array = np.ndarray[Any, Any]
L = np.longdouble
EPS = float(np.finfo(float).eps)
SCENE = """
run = { until = 1.0 }
body = [
  { name = "a", mass = 1.0, inertia = [1.0, 1.0, 1.0], shape = SHAPE_A },
  { name = "b", mass = 1.0, inertia = [1.0, 1.0, 1.0], shape = SHAPE_B, position = [9.0, 0.0, 0.0] },
]
contact = [{ between = ["a", "b"] }]
"""
ELLIPSOID = '{ kind = "ellipsoid", semi_axes = [1.0, 0.5, 0.2] }'


@cache
def library(a: str = ELLIPSOID, b: str = ELLIPSOID, real: str = "double") -> Library:
    """Two free bodies of the given shapes in contact."""
    scene = read_text(SCENE.replace("SHAPE_A", a).replace("SHAPE_B", b), "pair.toml")
    return library_of(scene, real)


@dataclass(frozen=True)
class Pairs:
    """n pairs; the surfaces touch when f is moved by -gap along the normal."""

    lengths: Array  # (n, 6) semi-axes of o, then f
    pose_o: Array  # (n, 12)
    pose_f: Array  # (n, 12)
    normal: Array  # (n, 3) near the true one
    gap: Array  # (n,)

    @property
    def sharpest(self) -> Array:
        """(n, 2) the smallest radius of curvature of each ellipsoid."""
        axes = self.lengths.reshape(-1, 2, 3)
        return axes.min(2) ** 2 / axes.max(2)


def unit(v: Array) -> Array:
    return v / np.sqrt((v * v).sum(-1))[..., None]


def times(R: Array, v: Array) -> Array:
    return np.einsum("nij,nj->ni", R, v)


def half_turn(axis: Array) -> Array:
    return 2 * axis[:, :, None] * axis[:, None, :] - np.eye(3, dtype=L)


def rotations(rng: np.random.Generator, n: int) -> Array:
    first, second = unit(rng.normal(size=(2, n, 3)).astype(L))
    return half_turn(first) @ half_turn(second)


def pose(p: Array, R: Array) -> Array:
    return np.concatenate([p, np.swapaxes(R, 1, 2).reshape(len(p), 9)], 1).astype(float)


def frame(poses: Array) -> tuple[Array, Array]:
    return poses[:, :3].astype(L), np.swapaxes(poses[:, 3:].reshape(-1, 3, 3), 1, 2).astype(L)


def draw_axes(rng: np.random.Generator, n: int) -> Array:
    """Ratios to 100:1, a tenth of them needles, blades and discs of 100:1; sizes from 0.1 to 1 m."""
    powers = rng.uniform(-2, 0, (n, 3))
    powers[: n // 10] = np.where(rng.random((n // 10, 3)) < 0.5, -2, powers[: n // 10])
    powers[:, 0] = 0
    return rng.permuted(10.0**powers, axis=1) * 10.0 ** rng.uniform(-1, 0, n)[:, None]


def draw_normals(rng: np.random.Generator, axes: Array) -> Array:
    """Half of them uniform on the sphere, half at points that fill the flat parts too."""
    u = unit(rng.normal(size=axes.shape))
    return unit(np.where(rng.random(len(axes))[:, None] < 0.5, u, u / axes).astype(L))


def draw_gaps(rng: np.random.Generator, sharpest: Array) -> Array:
    """From 1e-2 m to 1e-16 m, none, and overlaps down to a tenth of the smallest radius of curvature."""
    n, kind = len(sharpest), rng.random(len(sharpest))
    apart = 10.0 ** rng.uniform(-16, -2, n)
    overlap = -0.1 * sharpest * np.where(kind > 0.9, 1, 10.0 ** rng.uniform(-8, 0, n))
    return np.where(kind < 0.5, apart, np.where(kind < 0.6, 0, overlap))


def random_pairs(n: int, seed: int) -> Pairs:
    """Two surface points brought to a gap along their common normal, anywhere within 1 m of the origin."""
    rng = np.random.default_rng(seed)
    axes = draw_axes(rng, n), draw_axes(rng, n)
    normals = [draw_normals(rng, each) for each in axes]
    x_o, x_f = (
        a * a * m / np.sqrt((a * a * m * m).sum(1))[:, None] for a, m in zip(axes, normals, strict=True)
    )
    R_o, R_f = rotations(rng, n), rotations(rng, n)
    N = times(R_o, normals[0])
    R_f = half_turn(unit(times(R_f, normals[1]) - N)) @ R_f
    pairs = Pairs(np.concatenate(axes, 1), N, N, N, np.zeros(n))
    gap = draw_gaps(rng, pairs.sharpest.min(1))
    p_o = rng.uniform(-1, 1, (n, 3)).astype(L)
    p_f = p_o + times(R_o, x_o) + gap[:, None] * N - times(R_f, x_f)
    return Pairs(pairs.lengths, pose(p_o, R_o), pose(p_f, R_f), N, gap)


def tangents(n: Array) -> Array:
    other = np.where((np.abs(n[:, 0]) < 0.6)[:, None], np.eye(3)[0], np.eye(3)[1]).astype(L)
    first = unit(np.cross(n, other))
    return np.stack([first, np.cross(n, first)], 2)


def solved(W: Array, g: Array) -> Array:
    """W^-1 g for symmetric (n, 2, 2)."""
    a, b, c = W[:, 0, 0], W[:, 0, 1], W[:, 1, 1]
    return np.stack([c * g[:, 0] - b * g[:, 1], a * g[:, 1] - b * g[:, 0]], 1) / (a * c - b * b)[:, None]


def true_normals(pairs: Pairs, steps: int = 4) -> tuple[Array, Array, Array]:
    """(normal, d, kappa) in extended precision for the poses as they stand; kappa: largest curvature there.

    Newton's method on the separation function of the two supports sqrt(n.M n), M = R diag(axes^2) R^T.
    """
    (p_o, R_o), (p_f, R_f) = frame(pairs.pose_o), frame(pairs.pose_f)
    squares = pairs.lengths.astype(L) ** 2
    M = [np.einsum("nij,nj,nkj->nik", R, s, R) for R, s in ((R_o, squares[:, :3]), (R_f, squares[:, 3:]))]
    n = unit(pairs.normal.astype(L))
    for _ in range(steps):
        T = tangents(n)
        h = [np.sqrt(np.einsum("ni,nij,nj->n", n, m, n))[:, None] for m in M]
        x = [times(m, n) / size for m, size in zip(M, h, strict=True)]
        bent = [(m - y[:, :, None] * y[:, None, :]) / s[:, None] for m, y, s in zip(M, x, h, strict=True)]
        R = [np.einsum("nji,njk,nkl->nil", T, m, T) for m in bent]
        between = p_f - p_o - x[0] - x[1]
        d = (n * between).sum(1)
        n = unit(
            n
            + times(
                T, solved(R[0] + R[1] + d[:, None, None] * np.eye(2), times(np.swapaxes(T, 1, 2), between))
            )
        )
    kappa = np.max([1 / np.linalg.eigvalsh(r.astype(float))[:, 0].clip(1e-12) for r in R], axis=0)
    return n, d, np.minimum(kappa, 1 / pairs.sharpest.min(1))


def turned(rng: np.random.Generator, poses: Array, size: Array, amount: float) -> Array:
    """Poses turned by `amount` rad and moved by `amount` of the size, each in a random direction."""
    p, R = frame(poses)
    w = unit(rng.normal(size=p.shape)).astype(L)
    half = unit(np.cross(w, unit(rng.normal(size=p.shape))).astype(L))
    other = np.cos(L(amount) / 2) * half + np.sin(L(amount) / 2) * np.cross(w, half)
    step = amount * size[:, None] * unit(rng.normal(size=p.shape))
    return pose(p + step, half_turn(unit(other)) @ half_turn(half) @ R)


def moved(pairs: Pairs, amount: float, seed: int, solve: Any) -> Pairs:
    """Both bodies moved a little and f shifted back to the same gap; `solve(pairs)` finds normals apart."""
    rng = np.random.default_rng(seed)
    size = pairs.lengths.reshape(-1, 2, 3).max(2)
    pose_o = turned(rng, pairs.pose_o, size[:, 0], amount)
    pose_f = turned(rng, pairs.pose_f, size[:, 1], amount)
    lift = (4 * amount * size.sum(1) - np.minimum(pairs.gap, 0))[:, None] * pairs.normal.astype(float)
    pose_f[:, :3] += lift
    apart = Pairs(pairs.lengths, pose_o, pose_f, pairs.normal, pairs.gap)
    n, d, _ = true_normals(Pairs(pairs.lengths, pose_o, pose_f, solve(apart), pairs.gap))
    pose_f[:, :3] -= ((d - pairs.gap)[:, None] * n).astype(float)
    return Pairs(pairs.lengths, pose_o, pose_f, n, pairs.gap)


def bound(pairs: Pairs, kappa: Array) -> Array:
    """20 eps (1 + kappa |p|), |p| the farther of both bodies from the origin."""
    far = np.maximum(*(np.sqrt((p[:, :3] ** 2).sum(1)) for p in (pairs.pose_o, pairs.pose_f)))
    return 20 * EPS * (1 + kappa * far)
