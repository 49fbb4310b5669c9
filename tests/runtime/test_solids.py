"""The depth of points in the material of a shape, as the search for passages takes it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.solid_terms import FORMULAS
from modelgen.geometry.surface_catalogue import SURFACES
from modelgen.rotations import rotation_of
from modelgen.runtime.solids import Array, Materials
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Shape
from tests.running import library_of

POINTS = 4000

SPECIMENS = {
    "plane": "",
    "sphere": "radius = 0.7",
    "ellipsoid": "semi_axes = [0.9, 0.6, 0.4]",
    "superellipsoid": "semi_axes = [0.9, 0.6, 0.4], exponents = [3.0, 5.0]",
    "torus": "major = 0.6, minor = 0.3",
    "half_torus": "major = 0.6, minor = 0.3",
    "cylinder": "radius = 0.5, length = 1.2",
    "cone": "half_angle = 0.6",
    "paraboloid": "radii = [0.5, 0.9]",
    "box": "size = [1.5, 1.0, 0.7]",
    "capsule": "radius = 0.4, length = 1.0",
    "tube": "radius = 0.8, bore = 0.4, length = 1.1",
    "dome": "radius = 0.8, length = 0.5",
    "frustum": "radius_bottom = 0.8, radius_top = 0.3, length = 1.2",
    "polyhedron": "vertices = [[0.9, 0, 0], [-0.5, 0.8, 0], [-0.5, -0.8, 0], [0, 0, 0.9], [0, 0, -0.4]]",
    "extrusion": "points = [[0, 0], [0.9, 0], [0.9, 0.9], [0.4, 0.3], [-0.7, 0.8]], length = 1.1",
    "revolution": 'r = "sin(t)*(0.6 + 0.25*cos(2*t))", z = "-0.8*cos(t)", domain = [0.0, "pi"]',
}


def material_of(kind: str, cavity: bool = False) -> tuple[Callable[[Array], Array], Shape, float]:
    """The depth in a specimen, its shape, and the spacing of its samples, m."""
    hollow = ", cavity = true" if cavity else ""
    comma = ", " if SPECIMENS[kind] else ""
    shape = (
        f'kind = "{kind}"{comma}{SPECIMENS[kind]}{hollow}, position = [0.1, 0.2, 0.3], rpy = [0.4, 0.5, 0.6]'
    )
    ball = 'density = 1.0, position = [5, 0, 0], shape = { kind = "sphere", radius = 0.1 }'
    text = f"""
run = {{ until = 1.0 }}
body = [{{ name = "a", motion = "fixed", shape = {{ {shape} }} }}, {{ name = "b", {ball} }}]
"""
    made = read_text(text, "scene.toml")
    library = library_of(made)
    table = library.manifest.instance["unlisted"]
    entry, materials = table["shapes"][0], Materials(table, library)
    number = materials.number(entry)
    assert number is not None
    return partial(materials.heights, number), made.bodies[0].shapes[0], entry.get("parameters", [0.0])[0]


def test_every_formula_has_a_specimen() -> None:
    assert set(SPECIMENS) == {*FORMULAS, "plane", "box", "polyhedron", "revolution"}


@pytest.mark.parametrize("kind", SPECIMENS)
def test_the_depth_in_a_material_changes_no_faster_than_the_place(kind: str) -> None:
    depth, _, spacing = material_of(kind)
    random = np.random.default_rng(1)
    x = random.uniform(-1, 1, (POINTS, 3))
    y = x + random.normal(0, 0.1, (POINTS, 3))
    moved = np.linalg.norm(x - y, axis=1)
    near = (
        np.minimum(np.abs(depth(x)), np.abs(depth(y))) < 0.3
        if kind == "paraboloid"
        else np.full(POINTS, True)
    )
    slack = 2 * spacing + 1e-12
    assert (np.abs(depth(x) - depth(y)) <= moved + slack)[near].all()


@pytest.mark.parametrize("kind", [kind for kind in SPECIMENS if kind in SURFACES and kind != "cylinder"])
@pytest.mark.parametrize("cavity", [False, True])
def test_the_sign_of_the_depth_is_that_of_the_implicit_function(kind: str, cavity: bool) -> None:
    depth, shape, _ = material_of(kind, cavity)
    implicit = SURFACES[kind].implicit
    assert implicit is not None
    x, numbers = ca.SX.sym("x", 3), ca.DM([value for _, value in shape.parameters])
    value = ca.Function("phi", [x], [implicit(x, ca.SX(numbers)).value])
    points = np.random.default_rng(2).uniform(-1.2, 1.2, (POINTS, 3))
    local = (points - shape.pose.position) @ rotation_of(shape.pose.quaternion)
    phi = np.asarray(value(local.T)).ravel() * (-1 if cavity else 1)
    known = local[:, 2] < 0 if kind == "cone" else np.full(POINTS, True)  # the nappe below the apex
    assert ((phi < 0) == (depth(points) < 0))[known].all()


@pytest.mark.parametrize(
    "kind",
    [
        "half_torus",
        "cylinder",
        "dome",
        "box",
        "capsule",
        "tube",
        "frustum",
        "polyhedron",
        "extrusion",
        "revolution",
    ],
)
def test_the_points_of_negative_depth_fill_the_volume(kind: str) -> None:
    """Within five standard deviations of their count; a sampled surface counts a layer less."""
    depth, shape, layer = material_of(kind)
    n, side = 200_000, 3.2
    points = np.array([0.1, 0.2, 0.3]) + np.random.default_rng(3).uniform(-side / 2, side / 2, (n, 3))
    share = float((depth(points) - layer < 0).mean())
    true = mass_properties(shape, 1.0)[0] / side**3
    assert abs(share - true) < 5 * np.sqrt(true / n) + (0.01 * true if layer else 0.0)


TWO = """
run = {{ until = 1.0 }}
body = [
    {{ name = "a", motion = "fixed", shape = {{ kind = "{first}", {sizes} }} }},
    {{ name = "b", density = 1.0, shape = {{ kind = "sphere", radius = 0.4 }} }},
]
"""
ROUND = 'r = "0.7*sin(t)", z = "-0.7*cos(t)", domain = [0.0, "pi"]'


@pytest.mark.parametrize(("first", "sizes"), [("sphere", "radius = 0.7"), ("revolution", ROUND)])
def test_a_common_point_is_found_where_two_balls_are_deep_enough_and_slack_is_how_far_they_may_move(
    first: str, sizes: str
) -> None:
    """The deepest point of both is (0.7 + 0.4 - distance) / 2 deep; a sampled ball is smaller by a layer."""
    library = library_of(read_text(TWO.format(first=first, sizes=sizes), "scene.toml"))
    table = library.manifest.instance["unlisted"]
    materials = Materials(table, library)
    a, b = (materials.number(each) for each in table["shapes"])
    assert a is not None
    assert b is not None
    layer = 2 * sum(table["shapes"][0].get("parameters", [0.0]))
    random = np.random.default_rng(5)
    for _ in range(200):
        deep = 10 ** random.uniform(-4, -1.5)
        way, apart = random.normal(size=3), random.choice([-1, 1]) * 10 ** random.uniform(-5, -0.5)
        distance = 1.1 - 2 * deep + apart
        p = way / np.linalg.norm(way) * distance
        R = Rotation.random(random_state=random).as_matrix()
        found = materials.common(a, b, R, p, np.zeros(3), 0.4, deep)
        assert not found.is_deep or apart < 0
        assert found.slack <= max(apart + 2 * layer, 0.0) + 1e-12
        assert found.is_deep or apart > -2 * deep - 2 * layer
