"""Minima of the distance: the search by cells finds every minimum that brute force finds, and no other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import ModelgenError, distance_minima
from modelgen.runtime.poses import pose_matrices as matrices
from modelgen.scene import python_scenes as make
from tests.laws.exhaustive_minima import Array, exhaustive
from tests.laws.minima_families import PAIRS, TURN, library, random_pose, sides
from tests.running import library_of

HERE = np.append(np.zeros(3), np.eye(3).ravel())
GAP, DEPTH = 0.5, 0.04  # m
MERGE = 1e-4  # m
SOME, ALL = 6, 770  # pairs of poses for each pair of shapes: in the tests, and in the study


def missed_and_false(o: str, f: str, pose: Array, n: int) -> tuple[list[float], list[float], bool]:
    """Distances of minima that the search did not find, and of those found that are none; complete.

    n: values of each coordinate on the grid of brute force, which starts from the points found too: a grid
    may miss a minimum, and a point found has to be one by the plain expressions of the shapes.
    """
    first, second = sides()[o].plain, sides()[f].plain
    depth = DEPTH * abs(first.outward)
    found = distance_minima(library(o, f), "a-b", matrices(HERE), matrices(pose), gap=GAP, depth=depth)
    true = exhaustive(first, second, pose, near=(found.point_o, found.point_f), offset=1.5 * depth, n=n)
    ours, theirs = (np.hstack([each.point_o, each.point_f]) for each in (found, true))
    apart = np.linalg.norm(ours[:, None] - theirs, axis=2)
    wanted = (true.d > max(-depth, MERGE - depth)) & (true.d < GAP - MERGE)
    missed = true.d[wanted & (apart.min(axis=0, initial=np.inf) > MERGE)]
    false = found.d[apart.min(axis=1, initial=np.inf) > MERGE]
    return missed.tolist(), false.tolist(), bool(found.complete[0])


def judge(o: str, f: str, count: int) -> list[tuple[int, list[float], list[float], bool]]:
    """The pairs of poses in which the search and brute force differ, or the search gave up."""
    rng = np.random.default_rng(0)
    coarse, fine = (32, 72) if sides()[o].plain.outward else (80, 400)
    wrong = []
    for k in range(count):
        pose = random_pose(o, rng)
        judged = missed_and_false(o, f, pose, coarse)
        if judged[1]:  # brute force misses what its grid does not resolve
            judged = missed_and_false(o, f, pose, fine)
        if judged[0] or judged[1] or not judged[2]:
            wrong.append((k, *judged))
    return wrong


@pytest.mark.cases(8)
@pytest.mark.parametrize(("o", "f"), PAIRS)
def test_every_minimum_is_found_and_nothing_else(o: str, f: str) -> None:
    assert judge(o, f, SOME) == []


@pytest.mark.slow
@pytest.mark.parametrize(("o", "f"), PAIRS)
def test_every_minimum_of_ten_thousand_pairs_is_found(o: str, f: str) -> None:
    assert judge(o, f, ALL) == []


def test_no_minimum_is_lost_when_the_world_is_moved_or_the_bodies_are_swapped() -> None:
    rng = np.random.default_rng(1)
    pose, moved = (random_pose("waist", rng) for _ in range(2))
    pose[:3] *= 2.5 / np.linalg.norm(pose[:3])
    R = moved[3:].reshape(3, 3, order="F")
    there = np.append(moved[:3] + R @ pose[:3], (R @ pose[3:].reshape(3, 3, order="F")).ravel(order="F"))
    first = distance_minima(library("waist", "torus"), "a-b", matrices(HERE), matrices(pose), gap=5.0)
    second = distance_minima(library("waist", "torus"), "a-b", matrices(moved), matrices(there), gap=5.0)
    swapped = distance_minima(library("torus", "waist"), "a-b", matrices(pose), matrices(HERE), gap=5.0)
    assert len(first.d) > 0
    np.testing.assert_allclose(second.d, first.d, atol=1e-12)
    np.testing.assert_allclose(swapped.d, first.d, atol=1e-12)
    np.testing.assert_allclose(second.point_o, moved[:3] + first.point_o @ R.T, atol=1e-7)
    np.testing.assert_allclose(swapped.normal, -first.normal, atol=1e-7)


def test_bounds_and_names_are_checked() -> None:
    for contact, keys, message in (
        ("a-c", {}, "no contact 'a-c'"),
        ("a-b", {"gap": -1.0}, "a length of 0 m or more"),
        ("a-b", {"depth": float("nan")}, "a length of 0 m or more"),
    ):
        with pytest.raises(ModelgenError, match=message):
            distance_minima(library("torus", "torus"), contact, matrices(HERE), matrices(HERE), **keys)  # type: ignore[arg-type]


@pytest.mark.parametrize("decade", range(1, 10))
def test_a_ring_that_is_almost_coaxial_with_a_bore_is_nearest_at_one_or_two_places(decade: int) -> None:
    """The gap along a ring, off the axis and leaning by decades, against dense angles of the ring."""
    rng = np.random.default_rng(decade)
    away, lean, way = 10.0**-decade * rng.uniform(0.5, 1, 2), 10.0 ** -rng.uniform(1, 5), rng.uniform(0, TURN)
    lean_by = Rotation.from_rotvec(lean * np.array([np.cos(way), np.sin(way), 0])).as_matrix()
    pose = np.append([*away, 0.3], lean_by.ravel(order="F"))
    found = distance_minima(library("bore", "ring"), "a-b", matrices(HERE), matrices(pose))
    angle = np.linspace(0, TURN, 20_000, endpoint=False)
    x = pose[:3] + 0.8 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) @ lean_by.T
    gap = 1.6 - np.hypot(x[:, 0], x[:, 1])
    least = (gap < np.roll(gap, 1)) & (gap <= np.roll(gap, -1))
    assert found.complete.all()
    resolved = np.ptp(gap) * (TURN / 20_000) ** 2  # by the dense angles
    assert found.d[0] == pytest.approx(gap.min(), abs=resolved + 1e-13)
    assert len(found.d) == np.count_nonzero(least) or np.ptp(gap) < 1e-7


def test_a_search_on_a_spline_is_complete_after_few_pairs_of_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cam near the walls of a hollow: cells that have a knot within do not stay open."""
    monkeypatch.setattr("modelgen.runtime.distance_minima.EFFORT", 10_000)
    rng = np.random.default_rng(0)
    angle = TURN * np.arange(8) / 8
    outline = rng.uniform(0.6, 1, (8, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    hollow = make.fixed("b", make.ellipsoid(1.4, 1.2, 1.1, cavity=True))
    cam = make.extrusion(0.8, points=outline.tolist(), smooth=True)
    moving = make.dynamic("a", cam, mass=1.0, inertia=[0.3] * 3)
    built = library_of(
        make.scene("cam", [hollow, moving], contact=[{"between": ["b", "a"]}], run={"until": 1.0})
    )
    poses = np.hstack(
        [
            rng.uniform(-0.1, 0.1, (6, 3)),
            Rotation.random(6, random_state=rng).as_matrix().transpose(0, 2, 1).reshape(6, 9),
        ]
    )
    assert distance_minima(built, "b-a", matrices(HERE), matrices(poses), gap=0.4, depth=0.1).complete.all()


def test_a_spline_of_constants_is_searched_as_one_of_parameters() -> None:
    rng = np.random.default_rng(3)
    along = np.linspace(-0.5, 0.5, 40)
    profile = np.stack([0.3 + 0.03 * np.sin(7 * along) + 1e-3 * rng.normal(size=40), along], axis=1)
    bodies = [
        make.fixed("a", make.shape("revolution", points=profile.tolist())),
        make.dynamic("b", make.ellipsoid(0.1, 0.08, 0.06), mass=1.0, inertia=[1.0] * 3),
    ]
    scene = make.scene("folded", bodies, contact=[{"between": ["a", "b"]}], run={"until": 1.0})
    poses = np.hstack([rng.uniform([0.4, -0.1, -0.4], [0.42, 0.1, 0.4], (5, 3)), np.tile(HERE[3:], (5, 1))])
    found = [
        distance_minima(library_of(made), "a-b", matrices(HERE), matrices(poses), gap=0.1, depth=0.05)
        for made in (scene, replace(scene, fold=True))
    ]
    assert all(each.complete.all() for each in found)
    assert len(found[0].d) >= 5
    np.testing.assert_allclose(found[0].d, found[1].d, atol=1e-13)
