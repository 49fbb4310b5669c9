"""Closest points: every pair of convex shapes is solved, to rounding, and what is certified is the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from modelgen import ModelgenError, closest_points
from modelgen.runtime.closest_points import ClosestPoints, Extremum
from modelgen.runtime.poses import pose_matrices as matrices
from modelgen.scene import python_scenes as make
from tests.laws import minima_families as families
from tests.laws.ellipsoid_pairs import (
    EPS,
    Array,
    Pairs,
    bound,
    frame,
    library,
    moved,
    random_pairs,
    rotations,
    true_normals,
    unit,
)
from tests.laws.ellipsoid_pairs import pose as pose_of
from tests.laws.exhaustive_minima import exhaustive
from tests.laws.minima_families import random_pose
from tests.running import library_of

N = 2000
HERE = np.append(np.zeros(3), np.eye(3).ravel())
SUPERELLIPSOID = '{ kind = "superellipsoid", semi_axes = [1.0, 0.6, 0.3], exponents = [4.0, 3.0] }'
CAVITY = '{ kind = "ellipsoid", semi_axes = [3.0, 2.0, 1.5], cavity = true }'
EGG = '{ kind = "ellipsoid", semi_axes = [0.4, 0.3, 0.2] }'


def found(pairs: Pairs, eta: Array | None = None) -> ClosestPoints:
    return closest_points(
        library(),
        "a-b",
        matrices(pairs.pose_o),
        matrices(pairs.pose_f),
        eta,
        parameters=pairs.lengths,
    )


@cache
def drawn() -> Pairs:
    return random_pairs(N, seed=1)


def slope(M: list[mp.matrix], r: mp.matrix, turn: list[int]) -> Callable[..., list[mp.mpf]]:
    """What vanishes at the normal: P_f - P_o across n, two entries of it, and |n|^2 - 1."""

    def residual(*entries: mp.mpf) -> list[mp.mpf]:
        n = mp.matrix(entries)
        g = r - sum((m * n / mp.sqrt((n.T * m * n)[0]) for m in M), mp.zeros(3, 1))
        across = g - (n.T * g)[0] / (n.T * n)[0] * n
        return [across[turn[0]], across[turn[1]], (n.T * n)[0] - 1]

    return residual


def test_the_truth_is_true_to_fifty_digits() -> None:
    """The normals in extended precision stand on the same extremum as 50 digits put it."""
    pairs = drawn()
    normals, _, kappa = true_normals(pairs)
    (p_o, R_o), (p_f, R_f) = frame(pairs.pose_o), frame(pairs.pose_f)
    with mp.workdps(50):
        for i in range(0, N, N // 8):
            R = [mp.matrix(rotation[i].astype(float).tolist()) for rotation in (R_o, R_f)]
            squares = [mp.diag([mp.mpf(a) ** 2 for a in axes]) for axes in pairs.lengths[i].reshape(2, 3)]
            M = [rotation * square * rotation.T for rotation, square in zip(R, squares, strict=True)]
            r = mp.matrix(p_f[i].astype(float).tolist()) - mp.matrix(p_o[i].astype(float).tolist())
            turn = np.argsort(np.abs(normals[i])).tolist()
            true = mp.findroot(slope(M, r, turn), [mp.mpf(str(x)) for x in normals[i]], tol=1e-60)
            error = max(abs(x - mp.mpf(str(y))) for x, y in zip(true, normals[i], strict=True))
            assert error < EPS * (1 + kappa[i]) / 50


def test_every_pair_is_solved_to_rounding_from_nothing() -> None:
    """Ellipsoids to 100:1, gaps from 1e-2 m to 0 and overlaps to 0.1 of the smallest radius of curvature."""
    pairs = drawn()
    normal, d, kappa = true_normals(pairs)
    points = found(pairs)
    assert points.certified.all()
    assert (np.linalg.norm((points.normal - normal).astype(float), axis=1) < bound(pairs, kappa)).all()
    assert np.abs(points.d - d).max() < 20 * EPS
    between = ((points.point_f - points.point_o) * points.normal).sum(1)
    assert np.abs(between - points.d).max() < 20 * EPS


def test_small_motions_are_followed_to_rounding() -> None:
    """From the contact parameters of poses 1e-3 rad and 1e-3 of the size away."""
    before = found(drawn())
    pairs = moved(drawn(), 1e-3, 2, lambda apart: found(apart).normal)
    normal, d, kappa = true_normals(pairs)
    points = found(pairs, before.eta)
    assert points.certified.all()
    assert (np.linalg.norm((points.normal - normal).astype(float), axis=1) < bound(pairs, kappa)).all()
    assert np.abs(points.d - d).max() < 20 * EPS


def test_exchanging_the_shapes_turns_the_normal_round() -> None:
    pairs = drawn()
    swapped = Pairs(np.roll(pairs.lengths, 3, axis=1), pairs.pose_f, pairs.pose_o, -pairs.normal, pairs.gap)
    one, other = found(pairs), found(swapped)
    _, _, kappa = true_normals(pairs)
    assert (np.linalg.norm(one.normal + other.normal, axis=1) < 2 * bound(pairs, kappa)).all()
    np.testing.assert_allclose(one.d, other.d, atol=20 * EPS)


def sphere(n: int) -> Array:
    """n directions, evenly over the sphere."""
    k = np.arange(n) + 0.5
    height, angle = 1 - 2 * k / n, np.pi * (1 + 5**0.5) * k
    across = np.sqrt(1 - height**2)
    return np.stack([across * np.cos(angle), across * np.sin(angle), height], 1)


def support(axes: Array, exponents: tuple[float, float], n: Array) -> Array:
    """h(n) of a superellipsoid: the dual norm."""
    P, Q = (e / (e - 1) for e in exponents)
    x, y, z = np.abs(axes * n).T
    return ((x**P + y**P) ** (Q / P) + z**Q) ** (1 / Q)


@pytest.mark.cases(1)
@pytest.mark.parametrize("reach", [0.5, 1.2])
def test_no_plane_separates_superellipsoids_better(reach: float) -> None:
    """Shapes that some plane separates are certified, at a distance that no plane exceeds."""
    rng = np.random.default_rng(3)
    R_o, R_f, p = rotations(rng, 300), rotations(rng, 300), reach * rng.normal(size=(300, 3))
    o, f = pose_of(np.zeros((300, 3)), R_o), pose_of(p, R_f)
    points = closest_points(library(SUPERELLIPSOID, SUPERELLIPSOID), "a-b", matrices(o), matrices(f))
    axes, grid = np.array([1.0, 0.6, 0.3]), sphere(4000)
    for i in range(300):
        heights = [support(axes, (4.0, 3.0), grid @ R[i].astype(float)) for R in (R_o, R_f)]
        best = (grid @ p[i] - sum(heights)).max()
        assert points.certified[i] or best < 0
        assert not points.certified[i] or best <= points.d[i] < best + 0.03
    assert (points.certified == (points.d > 0)).all()
    assert 20 < points.certified.sum() < 300


def test_deep_overlap_is_followed_but_not_certified() -> None:
    """Pushed together along the normal, d falls at the same rate until another normal is proved nearer."""
    pairs = random_pairs(200, seed=5)
    points = found(pairs)
    depth = pairs.sharpest.sum(1) * 1.2 + pairs.gap
    start = pairs.pose_f[:, :3].copy()
    left = 1 / true_normals(pairs)[2] < depth  # at the tips the maximum itself ends
    assert left.sum() < 150
    for part in np.linspace(0.02, 1, 50):
        pairs.pose_f[:, :3] = start - part * depth[:, None] * points.normal
        now = found(pairs, points.eta)
        expected = pairs.gap - part * depth
        assert (now.certified == (now.d > -pairs.sharpest.sum(1))).all()
        left |= now.certified & (expected <= -pairs.sharpest.sum(1))
        assert (np.abs(now.d - expected) < 1e-12)[~left].all()
        points = replace(points, eta=now.eta)


@pytest.mark.parametrize(("real", "epsilon"), [("float", 2.0**-23), ("long double", 2.0**-63)])
def test_other_real_types_reach_their_own_rounding(real: str, epsilon: float) -> None:
    """Round shapes, whose poses a float can hold apart."""
    rng = np.random.default_rng(6)
    n, dtype = 200, np.float32 if real == "float" else np.longdouble
    o = pose_of(np.zeros((n, 3)), rotations(rng, n)).astype(dtype)
    f = pose_of(2.5 * unit(rng.normal(size=(n, 3))), rotations(rng, n)).astype(dtype)
    lengths = np.tile(np.array([1.0, 0.8, 0.5, 1.0, 0.8, 0.5]), (n, 1))
    points = closest_points(library(real=real), "a-b", matrices(o), matrices(f), parameters=lengths)
    pairs = Pairs(lengths, o, f, points.normal.astype(np.longdouble), points.d)
    normal, d, _ = true_normals(pairs)
    assert points.certified.all()
    assert points.d.dtype == dtype
    assert np.abs(points.normal - normal).max() < 20 * epsilon
    assert np.abs(points.d - d).max() < 20 * epsilon


def test_inside_a_cavity_minima_are_told_from_other_extrema() -> None:
    """Newton from random points: minima and no others are closer than all points near them."""
    rng = np.random.default_rng(7)
    n, axes = 300, np.array([3.0, 2.0, 1.5])
    o, f = (pose_of(p, np.tile(np.eye(3), (n, 1, 1))) for p in (np.zeros((n, 3)), np.full((n, 3), 0.05)))
    ball = np.tile([*axes, 0.3, 0.3, 0.3], (n, 1))
    wall = axes * unit(rng.normal(size=(n, 3)))
    eta = np.concatenate([wall, 0.3 * unit(wall - 0.05)], 1)
    points = closest_points(library(CAVITY, EGG), "a-b", matrices(o), matrices(f), eta, parameters=ball)
    solved = np.flatnonzero(points.outcome > Extremum.NOWHERE)
    assert len(solved) > 0.9 * n
    assert {Extremum.STATIONARY, Extremum.MINIMUM} <= set(points.outcome.tolist())
    for i in solved:
        near = axes * unit(points.eta[i, :3] / axes + 1e-3 * sphere(200))
        distances = np.linalg.norm(near - 0.05, axis=1) - 0.3
        assert (points.outcome[i] == Extremum.MINIMUM) == (distances.min() > points.d[i] - 1e-12)


def test_what_has_no_answer_says_so() -> None:
    here = np.eye(3, 4)
    nothing = closest_points(library(), 0, np.stack([here, here]), np.stack([here, here * np.nan]))
    assert not nothing.certified.any()
    assert nothing.outcome[1] == Extremum.NOWHERE
    for arguments, message in (
        (("c", here, here), "no contact 'c'"),
        ((0, here[:3, :3], here), r"\(n, 3, 4\)"),
        ((0, np.tile(here, (2, 1, 1)), np.tile(here, (3, 1, 1))), "2 and 3 rows"),
        ((0, here, here, np.zeros(5)), r"\(n, 6\)"),
    ):
        with pytest.raises(ModelgenError, match=message):
            closest_points(library(), *arguments)
    with pytest.raises(ModelgenError, match="give eta"):
        closest_points(library(CAVITY, EGG), 0, here, here, parameters=np.zeros(6))


@pytest.mark.slow
def test_the_nearest_of_several_minima_is_found_from_nothing() -> None:
    rng = np.random.default_rng(2)
    poses = np.array([random_pose("waist", rng) for _ in range(20)])
    points = closest_points(families.library("waist", "torus"), "a-b", matrices(HERE), matrices(poses))
    waist, torus = (families.sides()[name].plain for name in ("waist", "torus"))
    apart = 0
    for pose, d, certified in zip(poses, points.d, points.certified, strict=True):
        true = exhaustive(waist, torus, pose, offset=0.05).d
        if len(true) and true[0] > 0 and d > 0:
            assert d == pytest.approx(true[0], abs=1e-9)
            assert certified
            apart += 1
    assert apart > 4


def test_bodies_of_several_features_are_searched_at_once() -> None:
    """A box and an ellipsoid, and two boxes, against convex programmes."""
    half, axes = np.array([0.5, 0.3, 0.2]), np.array([0.5, 0.25, 0.4])
    box = make.box(*map(float, 2 * half))
    rng = np.random.default_rng(3)
    poses = pose_of(2 * unit(rng.normal(size=(20, 3))), rotations(rng, 20))
    for other, is_round in ((make.ellipsoid(*map(float, axes)), True), (box, False)):
        bodies = [make.dynamic("a", box, density=1.0), make.dynamic("b", other, density=1.0)]
        library = library_of(make.scene("pair", bodies, contact=[{"between": ["a", "b"]}]))
        points = closest_points(library, "a-b", matrices(HERE), matrices(poses))
        x, pose = ca.SX.sym("x", 6), ca.SX.sym("pose", 12)
        span = pose[:3] + ca.mtimes(ca.reshape(pose[3:], 3, 3), x[3:]) - x[:3]
        inside = ca.vertcat(x[:3] / half, ca.sumsqr(x[3:] / axes) if is_round else x[3:] / half)
        silent = {"print_time": False, "ipopt": {"print_level": 0, "tol": 1e-12}}
        programme = ca.nlpsol(
            "nearest", "ipopt", {"x": x, "p": pose, "f": ca.sumsqr(span), "g": inside}, silent
        )
        apart = [float(programme(x0=0.1, p=each, lbg=-1, ubg=1)["f"]) ** 0.5 for each in poses]
        known = points.outcome != Extremum.NOWHERE
        assert np.sum(known) == len(known) if is_round else np.sum(known) > 3
        np.testing.assert_allclose(points.d[known], np.array(apart)[known], atol=1e-6)
        assert np.all(points.certified == is_round)
