"""The heights over the material of shapes against independent distances."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.tables.shapes import BallTables
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.measured_solids import Solid
from tests.benchmarks.solids_by_decades import KINDS, Endless, seen
from tests.running import library_of

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
POINTS = 4000
FIRST_ORDER, LIPSCHITZ = 0, 1
BY_TERMS = (
    *("plane", "sphere", "ellipsoid", "superellipsoid", "torus", "half_torus", "cylinder", "cone"),
    *("paraboloid", "bowl", "box", "capsule", "tube", "frustum", "dome", "polyhedron", "star"),
    *("endless cylinder", "bore", "hollow sphere", "hollow box", "hollow capsule", "hollow frustum"),
)
SMOOTH = ("sphere", "ellipsoid", "superellipsoid", "torus", "paraboloid", "capsule", "cone")


def specimen(kind: str, seed: int) -> Solid:
    made: Solid | Endless = KINDS[kind](np.random.default_rng([len(kind), seed]), 1.0)
    return seen(made, 3.0)


def heights(solid: Solid, x: Array, how: int) -> Array:
    """Heights of points in the axes of a fixed shape."""
    ball = make.dynamic("ball", make.sphere(0.1), mass=1.0, inertia=[1.0] * 3, position=[50.0, 0.0, 0.0])
    scene: Scene = make.scene(
        "heights", [make.fixed("base", solid.shape), ball], contact=[{"between": ["ball", "base"]}]
    )
    library = library_of(scene)
    table = library_tables(library)
    side = BallTables(library.manifest.instance).index[0, solid.shape.name]
    pairs = ctypes.cast(table.system.ball_solid, ctypes.POINTER(ctypes.c_int))
    pose, found = np.array([0.0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), np.empty(len(x))
    points = np.ascontiguousarray(x)
    assert pairs[side] >= 0
    library.cdll.mg_solid_heights(
        ctypes.byref(table.system), pairs[side], *(ctypes.c_void_p(pose.ctypes.data), how, len(x)),
        *(ctypes.c_void_p(each.ctypes.data) for each in (points, found)),
    )  # fmt: skip
    return found


def points_about(solid: Solid, rng: np.random.Generator) -> Array:
    """Points in and around a solid, half of them near its faces and edges, by decades."""
    size = solid.size if solid.size < np.inf else 3.0
    anywhere = 1.5 * size * rng.uniform(-1, 1, (POINTS, 3))
    near = np.concatenate([each.points for each in solid.dense]) if solid.faces or solid.edges else anywhere
    near = near[rng.integers(len(near), size=POINTS)]
    off = rng.normal(size=(POINTS, 3)) * size * 10 ** rng.uniform(-8, -1, (POINTS, 1))
    return np.concatenate([anywhere, near + off])


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", BY_TERMS)
def test_heights_are_negative_in_the_material_alone(kind: str, seed: int) -> None:
    solid = specimen(kind, seed)
    x = points_about(solid, np.random.default_rng(seed))
    right, size = solid.distance(x), float(np.abs(x).max())
    for how in (FIRST_ORDER, LIPSCHITZ):
        found = heights(solid, x, how)
        clear = np.abs(right) > 1e-12 * size
        assert (np.sign(found) == np.sign(right))[clear].all()


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", BY_TERMS)
def test_bounded_heights_change_no_faster_than_the_point_moves(kind: str, seed: int) -> None:
    """Which is also why no surface is nearer than they are high."""
    solid, rng = specimen(kind, seed), np.random.default_rng(seed)
    a = points_about(solid, rng)
    b = a + rng.normal(size=a.shape) * 10 ** rng.uniform(-6, 0, (len(a), 1))
    change = np.abs(heights(solid, a, LIPSCHITZ) - heights(solid, b, LIPSCHITZ))
    assert (change <= np.linalg.norm(a - b, axis=1) * (1 + 1e-9) + 1e-14).all()


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", SMOOTH)
def test_heights_are_distances_near_a_smooth_surface(kind: str, seed: int) -> None:
    """To first order: their slope across the surface is 1."""
    solid, rng = specimen(kind, seed), np.random.default_rng(seed)
    on = solid.faces[0](rng.uniform(0.2, 0.8, 500), rng.uniform(0.2, 0.8, 500))
    step = 1e-7 * (solid.size if solid.size < np.inf else 1.0)

    def slope(along: Array) -> Array:
        ahead, behind = (heights(solid, on + sign * step * along, FIRST_ORDER) for sign in (1.0, -1.0))
        return np.asarray((ahead - behind) / (2 * step))

    slopes = np.stack([slope(each) for each in np.eye(3)], axis=1)
    np.testing.assert_allclose(np.linalg.norm(slopes, axis=1), 1.0, atol=1e-4)
