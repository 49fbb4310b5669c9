"""Closest points of two circles: every minimum, in general and in degenerate positions, against 50 digits.

Two circles are equally far from each other along a curve where they are coaxial, where one is centred on the
other in a plane through its axis, and where one is a circle of Villarceau of a torus about the other.
Positions lie at and near these by decades.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import distance_minima
from modelgen.codegen.library import Library
from modelgen.runtime.poses import pose_matrices as matrices
from modelgen.scene import python_scenes as make
from tests.laws.circle_minima import CirclePair
from tests.laws.exhaustive_minima import Array
from tests.running import library_of

HERE = np.append(np.zeros(3), np.eye(3).ravel())
RADII = ((1.0, 0.37), (0.8, 0.8))
REGULAR, FLAT = 1e-7, 1e-8  # least margin of minima that have to be found; m, error of distances below it
TILT, QUARTER = float(np.arcsin(0.4)), float(np.pi / 2)

FAMILIES: dict[str, Callable[[float, float], tuple[list[float], list[float]]]] = {  # position and rotation
    "coaxial": lambda R, r: ([0, 0, 0.3], [0, 0, 0.2]),
    "concentric": lambda R, r: ([0, 0, 0], [0, 0, 0]),
    "one centre": lambda R, r: ([0, 0, 0], [0.7, 0, 0]),
    "centred on the first": lambda R, r: ([R, 0, 0], [QUARTER, 0, 0]),
    "centred on the second": lambda R, r: ([0, 0, r], [QUARTER, 0, 0]),
    "Villarceau": lambda R, r: ([0.4 * R, 0, 0], [TILT, 0, 0]),
    "Villarceau, mirrored": lambda R, r: ([0.4 * R, 0, 0], [-TILT, 0, 0]),
    "linked": lambda R, r: ([0.8 * R, 0, 0], [QUARTER, 0, 0]),
    "in one plane": lambda R, r: ([(R + r) / 2, 0, 0], [0, 0, 0]),
    "touching": lambda R, r: ([R + r, 0, 0], [0, 0, 0]),
    "touching inside": lambda R, r: ([abs(R - r), 0, 0], [0, 0, 0]),
    "crossing": lambda R, r: ([R + r, 0, 0], [0.6, 0, 0]),
    "far": lambda R, r: ([1e3 * R, 0, 0], [0.5, 0.2, 0]),
    "far along the axis": lambda R, r: ([0, 0, 1e3 * R], [0.5, 0.2, 0]),
}


@cache
def rings(R: float, r: float, tube: float = 0.0) -> Library:
    """Two circles, or tori about them."""
    shapes = [make.torus(radius, tube) if tube else make.circle(radius) for radius in (R, r)]
    bodies = [
        make.dynamic(name, shape, mass=1.0, inertia=[1.0, 1.0, 1.0])
        for name, shape in zip("ab", shapes, strict=True)
    ]
    return library_of(make.scene("rings", bodies, contact=[{"between": ["a", "b"]}]))


def pose_of(x: Array, rotation: Rotation) -> Array:
    return np.append(x, rotation.as_matrix().ravel(order="F"))


def judge(R: float, r: float, pose: Array) -> None:
    """What is found are minima; all regular ones are found; what is said to be complete is so."""
    pair = CirclePair(R, r, pose)
    found = distance_minima(rings(R, r), "a-b", matrices(HERE), matrices(pose))
    points, exact = np.hstack([found.point_o, found.point_f]), 1e-12 * (1 + float(np.linalg.norm(pose[:3])))
    for k, d in enumerate(found.d):
        beside = pair.beside(points[k, 3:])
        assert abs(d) == pytest.approx(beside.distance, abs=exact if beside.margin > REGULAR else FLAT)
        assert abs(pair.gradient(points[k, 3:])) <= exact
        assert beside.margin > -REGULAR
    for true in pair.minima:
        if true.margin > REGULAR:
            apart = np.abs(points - true.points).max(axis=1, initial=0.0)
            assert apart.min(initial=np.inf) <= 100 * exact / true.margin + 1e-9, (found.d, true)
    if pair.minima and all(true.margin > 10 * REGULAR for true in pair.minima):
        assert found.complete.all()


@pytest.mark.cases(20)
@pytest.mark.parametrize("decade", [*range(1, 14), None])
@pytest.mark.parametrize("family", FAMILIES)
def test_every_minimum_of_circles_is_found_near_degenerate_positions(family: str, decade: int | None) -> None:
    rng = np.random.default_rng([decade or 0, *family.encode()])
    off = 10.0**-decade if decade else 0.0
    for R, r in RADII:
        x, turn = FAMILIES[family](R, r)
        rotation = Rotation.from_rotvec(turn) * Rotation.from_rotvec(off * rng.normal(size=3))
        judge(R, r, pose_of(np.array(x) + off * rng.normal(size=3), rotation))


@pytest.mark.parametrize("count", [12, pytest.param(1000, marks=pytest.mark.slow)])
def test_every_minimum_of_circles_is_found(count: int) -> None:
    rng = np.random.default_rng(0)
    for _ in range(count):
        for R, r in RADII:
            rotation = Rotation.random(random_state=rng.integers(2**31))
            judge(R, r, pose_of(rng.normal(size=3) * R, rotation))


@pytest.mark.parametrize("gap", [0.05, 0.3, np.inf])
def test_tori_have_the_minima_of_their_centre_circles(gap: float) -> None:
    """Also where the search leaves out arcs that are farther apart than the gap."""
    R, r, tube = 1.0, 0.6, 0.04
    rng = np.random.default_rng(1)
    for _ in range(8):
        pose = pose_of(rng.normal(size=3) * R, Rotation.random(random_state=rng.integers(2**31)))
        found = distance_minima(rings(R, r, tube), "a-b", matrices(HERE), matrices(pose), gap=gap, depth=0.0)
        true = [each.distance - 2 * tube for each in CirclePair(R, r, pose).minima]
        wanted = sorted(d for d in true if 0 <= d <= gap)
        np.testing.assert_allclose(np.sort(found.d), wanted, rtol=0, atol=1e-12)
