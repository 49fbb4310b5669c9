"""Stated errors of forces against statics in 50 digits, where masses make the equations of the forces badly
conditioned: they cover the true errors, which are those of rounding."""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate, pairwise

import mpmath
import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of

G, RADIUS = 9.81, 0.1
ROUNDED = 1e-10  # relative; of the equations of forces as they stand it would be up to 1


def balls(masses: np.ndarray, places: np.ndarray) -> list[object]:
    return [
        make.dynamic(
            f"b{k}", make.sphere(RADIUS), mass=float(m), inertia=[0.4 * float(m) * RADIUS**2] * 3,
            position=place.tolist(),
        )
        for k, (m, place) in enumerate(zip(masses, places, strict=True))
    ]  # fmt: skip


def tower(masses: np.ndarray) -> Scene:
    """Frictionless spheres, one on the other."""
    n = len(masses)
    places = np.array([[0.0, 0.0, RADIUS + 2 * RADIUS * k] for k in range(n)])
    names = ["floor", *(f"b{k}" for k in range(n))]
    return make.scene(
        "tower", [make.fixed("floor", make.plane()), *balls(masses, places)],
        contact=[{"between": list(pair)} for pair in pairwise(names)], gravity=[0, 0, -G],
    )  # fmt: skip


def zigzag(masses: np.ndarray, width: float) -> Scene:
    """Frictionless spheres in a gap between two walls, left and right in turn, each on the one below."""
    n, across = len(masses), width - 2 * RADIUS
    rise = float(np.sqrt(4 * RADIUS**2 - across**2))
    places = np.array([[(k % 2) * across, 0.0, RADIUS + rise * k] for k in range(n)])
    walls = [
        make.fixed("floor", make.plane()),
        make.fixed(
            "left", make.plane(), position=[-RADIUS, 0, 0], rotation=[[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
        ),
        make.fixed(
            "right",
            make.plane(),
            position=[across + RADIUS, 0, 0],
            rotation=[[0, 0, -1], [0, 1, 0], [1, 0, 0]],
        ),
    ]
    pairs = [("floor", "b0"), *((("left", "right")[k % 2], f"b{k}") for k in range(n))]
    pairs += list(pairwise(f"b{k}" for k in range(n)))
    return make.scene(
        "zigzag", [*walls, *balls(masses, places)], contact=[{"between": list(pair)} for pair in pairs],
        gravity=[0, 0, -G],
    )  # fmt: skip


def forces_of_zigzag(masses: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Forces of floor, walls and neighbours on spheres at p (n, 3), from the topmost sphere down."""
    n = len(masses)
    with mpmath.workdps(50):
        neighbours, walls = [mpmath.mpf(0)] * n, [mpmath.mpf(0)] * n
        load = [mpmath.mpf(0), mpmath.mpf(0)]  # x and z on the sphere from above
        for k in range(n - 1, 0, -1):
            x, z = (mpmath.mpf(float(p[k, i])) - mpmath.mpf(float(p[k - 1, i])) for i in (0, 2))
            size, weight = mpmath.sqrt(x * x + z * z), mpmath.mpf(float(masses[k])) * mpmath.mpf(G)
            neighbours[k] = (weight - load[1]) * size / z
            walls[k] = abs(load[0] + neighbours[k] * x / size)
            load = [-neighbours[k] * x / size, -neighbours[k] * z / size]
        floor = mpmath.mpf(float(masses[0])) * mpmath.mpf(G) - load[1]
        walls[0] = abs(load[0])
        return np.array([float(each) for each in (floor, *walls, *neighbours[1:])])


def check(path: Trajectory, right: np.ndarray) -> None:
    assert path.estimate is not None
    apart = path.force[0, : len(right)] - right
    error = np.sqrt((apart**2).sum() / (right**2).sum())
    assert path.estimate.force is not None
    assert error <= path.estimate.force
    assert error < ROUNDED
    assert path.estimate.force < 1000 * ROUNDED


SIZES = np.unique(np.geomspace(2, 50, 20).astype(int)).tolist()


@pytest.mark.cases(4)
@pytest.mark.parametrize("decades", [0, 4, 8, 10])
@pytest.mark.parametrize("n", SIZES)
def test_the_error_of_forces_in_a_tower_is_stated(n: int, decades: int) -> None:
    rng = np.random.default_rng(100 * n + decades)
    masses = 10.0 ** (decades * (np.arange(n) % 2 - 0.5) * rng.choice([-1, 1]) + rng.uniform(0, 0.1, n))
    weights = accumulate(Fraction(float(m)) * Fraction(G) for m in masses[::-1])
    right = np.array([float(each) for each in weights])[::-1]
    check(simulate(library_of(tower(masses)), until=1e-6, samples=1), right)


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(200))
def test_the_error_of_forces_in_a_random_stack_is_stated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, decades = int(rng.integers(2, 13)), float(rng.uniform(0, 4))
    masses = 10.0 ** rng.uniform(-decades, decades, n)
    width = float(rng.uniform(2.3, 3.6)) * RADIUS
    path = simulate(library_of(zigzag(masses, width)), until=1e-6, samples=1)
    check(path, forces_of_zigzag(masses, path.p[0, 3:]))
