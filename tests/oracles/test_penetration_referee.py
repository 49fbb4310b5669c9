"""The referee of penetration against closed forms, supports at many directions, and translations."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.scene import python_scenes as make
from tests.benchmarks.penetration import DEPTH, REACH, SUPPORT, Referee, Solids

Array = np.ndarray
SIZES = {
    "sphere": [0.05, 0.0, 0.0],
    "ellipsoid": [0.06, 0.05, 0.03],
    "capsule": [0.03, 0.04, 0.0],
    "box": [0.05, 0.04, 0.02],
    "plane": [0.0, 0.0, 0.0],
}
COUNT = 120


def turns(random: np.random.Generator, count: int) -> Array:
    """(count, 3, 3) random rotations."""
    q, r = np.linalg.qr(random.normal(size=(count, 3, 3)))
    q = q * np.sign(np.einsum("nii->ni", r))[:, None]
    return q * np.linalg.det(q)[:, None, None]


def solids(kind: str, random: np.random.Generator, spread: float) -> Solids:
    size = np.tile(SIZES[kind], (COUNT, 1))
    return Solids(random.uniform(-spread, spread, (COUNT, 3)), turns(random, COUNT), size)


def unit(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def sampled(kinds: tuple[str, str], a: Solids, b: Solids, random: np.random.Generator) -> Array:
    """(count,) the least f over many directions, and then over those ever nearer to the best."""

    def f(n: Array) -> Array:
        supports = SUPPORT[kinds[0]](a, n) + SUPPORT[kinds[1]](b, n)
        return supports - np.einsum("ni,ni->n", b.centre - a.centre, n)

    best = np.tile(np.eye(3)[2], (len(a.centre), 1))
    found = f(best)
    for spread in (*[np.inf] * 2000, *np.repeat(0.1 * 0.8 ** np.arange(60), 10)):
        way = random.normal(size=best.shape)
        n = unit(way) if spread == np.inf else unit(best + spread * way)
        value = f(n)
        best = np.where((value < found)[:, None], n, best)
        found = np.minimum(found, value)
    return found


@pytest.mark.parametrize("kinds", [kinds for kinds in DEPTH if kinds[0] != "plane"], ids="-".join)
def test_depths_are_the_least_over_directions(kinds: tuple[str, str]) -> None:
    random = np.random.default_rng(0)
    a, b = (solids(kind, random, 0.05) for kind in kinds)
    found, seen = DEPTH[kinds](a, b), sampled(kinds, a, b, random)
    deep = found > 0
    assert deep.sum() > COUNT / 4
    assert (found[deep] <= seen[deep] + 1e-15).all()
    over = seen[deep] - found[deep]  # creases are found slowly at random
    assert np.median(over) < 1e-6
    assert over.max() < 3e-3
    assert (seen[~deep] <= 1e-9).all()


@pytest.mark.parametrize("kinds", [kinds for kinds in DEPTH if kinds[0] != "plane"], ids="-".join)
def test_no_way_shorter_than_the_depth_leads_out(kinds: tuple[str, str]) -> None:
    random = np.random.default_rng(1)
    a, b = (solids(kind, random, 0.05) for kind in kinds)
    found = DEPTH[kinds](a, b)
    deep = found > 1e-4
    a, b, found = a.taken(deep), b.taken(deep), found[deep]
    for n in unit(random.normal(size=(5, 3))):
        moved = b._replace(centre=b.centre + 0.999 * found[:, None] * n)
        assert (DEPTH[kinds](a, moved) > 0).all()


@pytest.mark.parametrize("kind", [*SUPPORT])
def test_above_a_plane_by_sizes(kind: str) -> None:
    """Not turned, a solid at height z lies -z + its half height deep."""
    half = {"sphere": 0.05, "ellipsoid": 0.03, "capsule": 0.07, "box": 0.02}[kind]
    z = np.array([-0.01, 0.0, 0.01, 0.2])
    upright = np.tile(np.eye(3), (4, 1, 1))
    planes = Solids(np.zeros((4, 3)), upright, np.zeros((4, 3)))
    others = Solids(np.column_stack([0 * z, 0 * z, z]), upright, np.tile(SIZES[kind], (4, 1)))
    assert np.allclose(DEPTH["plane", kind](planes, others), half - z, rtol=0, atol=1e-15)


def test_ellipsoids_that_are_spheres_and_that_touch() -> None:
    random = np.random.default_rng(3)
    a, b = solids("sphere", random, 0.05), solids("sphere", random, 0.05)
    ball = np.full((COUNT, 3), 0.05)
    found = DEPTH["ellipsoid", "ellipsoid"](a._replace(size=ball), b._replace(size=ball))
    assert np.allclose(found, DEPTH["sphere", "sphere"](a, b), rtol=0, atol=1e-14)
    # touching from outside at a point with normal n, and then moved in by 1e-6
    a, b = solids("ellipsoid", random, 0.05), solids("ellipsoid", random, 0.05)
    n = unit(random.normal(size=(COUNT, 3)))

    def farthest(each: Solids, way: Array) -> Array:
        square = np.einsum("nij,nj,nkj->nik", each.turned, each.size**2, each.turned)
        mapped = np.einsum("nij,nj->ni", square, way)
        return mapped / np.sqrt(np.einsum("ni,ni->n", mapped, way))[:, None]

    touching = a.centre + farthest(a, n) - farthest(b, -n)
    for depth in (0.0, 1e-6, 1e-9):
        moved = b._replace(centre=touching - depth * n)
        found = DEPTH["ellipsoid", "ellipsoid"](a, moved)
        assert np.allclose(np.maximum(found, 0.0), depth, rtol=0, atol=1e-14)


def test_cubes_by_their_faces_and_edges() -> None:
    """Two cubes over each other; one turned by 45 degrees on its edge; both on crossed edges."""
    half = np.array([[0.05, 0.05, 0.05]])
    upright, c = np.eye(3)[None], np.sqrt(0.5)
    on_edge = np.array([[[1, 0, 0], [0, c, -c], [0, c, c]]])
    other_edge = np.array([[[c, 0, c], [0, 1, 0], [-c, 0, c]]])
    low = Solids(np.zeros((1, 3)), upright, half)
    for turned, height in ((upright, 0.1), (on_edge, 0.05 + 0.1 * c)):
        high = Solids(np.array([[0.01, 0.0, height - 1e-3]]), turned, half)
        assert DEPTH["box", "box"](low, high)[0] == pytest.approx(1e-3, abs=1e-16)
    crossed = Solids(np.array([[0.0, 0.0, 0.2 * c - 1e-3]]), other_edge, half)
    assert DEPTH["box", "box"](low._replace(turned=on_edge), crossed)[0] == pytest.approx(1e-3, abs=1e-16)


def test_a_referee_takes_the_shapes_of_bodies_where_these_are() -> None:
    bar = make.capsule(0.02, 0.1, position=[0.1, 0.0, 0.0], rpy=[0.0, np.pi / 2, 0.0])
    bodies = [
        make.fixed("floor", make.plane()),
        make.dynamic("bar", bar, mass=1.0, inertia=[1.0, 1.0, 1.0], position=[0.0, 0.0, 1.0]),
        make.dynamic("ball", make.sphere(0.05), density=1.0, position=[0.0, 0.0, 2.0]),
    ]
    referee = Referee(make.scene("bar", bodies, contacts={"between": "all"}))
    upright = np.tile(np.eye(3), (3, 1, 1))
    for p, depth in (
        ([[0, 0, 0], [0, 0, 0.5], [0, 0, 1.0]], 0.0),
        ([[0, 0, 0], [0, 0, 0.019], [0, 0, 1.0]], 0.001),
        ([[0, 0, 0], [0, 0, 0.5], [0.19, 0, 0.5]], 0.03),
    ):
        assert referee.depth(np.array(p, dtype=float), upright) == pytest.approx(depth, abs=1e-15)
    down = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # the bar below its body
    turned = np.array([np.eye(3), down, np.eye(3)])
    p = np.array([[0, 0, 0], [0, 0, 0.169], [0, 0, 1.0]])
    assert referee.depth(p, turned) == pytest.approx(0.001, abs=1e-15)
    assert set(REACH) == {"plane", *SUPPORT}
