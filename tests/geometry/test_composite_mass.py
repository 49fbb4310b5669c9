"""Mass properties of bodies with edges against closed forms, and against each other."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from modelgen.errors import SceneError
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.shape_features import features_of
from modelgen.scene import python_scenes as build
from modelgen.scene.scene_types import Shape

from .composites import L_OUTLINE, SPECIMENS

LENGTH = st.floats(1e-3, 1e2)


def close(
    shape: Shape, mass: float, centre: list[float], inertia: np.ndarray, tolerance: float = 1e-12
) -> None:
    found = mass_properties(shape, 3.0)
    size = bounding_radius(shape)
    assert found[0] == pytest.approx(3 * mass, rel=tolerance)
    np.testing.assert_allclose(found[1], centre, atol=tolerance * size)
    np.testing.assert_allclose(np.diag(found[2]), 3 * np.diag(inertia), rtol=tolerance)
    np.testing.assert_allclose(found[2], 3 * inertia, rtol=tolerance, atol=tolerance * 3 * mass * size**2)


@given(LENGTH, LENGTH, LENGTH)
def test_box(x: float, y: float, z: float) -> None:
    mass = x * y * z
    close(
        build.box(x, y, z),
        mass,
        [0, 0, 0],
        mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y]),
    )


@given(LENGTH, LENGTH)
def test_cylinder(r: float, h: float) -> None:
    mass = pi * r * r * h
    across = mass * (r * r / 4 + h * h / 12)
    close(build.cylinder(r, h), mass, [0, 0, 0], np.diag([across, across, mass * r * r / 2]))


@given(LENGTH, st.floats(0.01, 0.99), LENGTH)
def test_tube(r: float, ratio: float, h: float) -> None:
    bore = ratio * r
    mass = pi * (r - bore) * (r + bore) * h
    square = r * r + bore * bore
    across = mass * (square / 4 + h * h / 12)
    close(build.tube(r, bore, h), mass, [0, 0, 0], np.diag([across, across, mass * square / 2]))


@given(LENGTH, st.floats(0.01, 0.99), LENGTH)
def test_frustum(a: float, ratio: float, h: float) -> None:
    """A cone less its tip: V = pi h/3 (a^2 + ab + b^2), Izz = 3/10 m (a^5 - b^5)/(a^3 - b^3)."""
    b = ratio * a
    if a - b < 1e-3 * h:
        return
    mass = pi * h / 3 * (a * a + a * b + b * b)
    height = h / 4 * (a * a + 2 * a * b + 3 * b * b) / (a * a + a * b + b * b) - h / 2
    found = mass_properties(build.frustum(a, b, h), 1.0)
    assert found[0] == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found[1], [0, 0, height], atol=1e-12 * h)
    assert found[2][2, 2] == pytest.approx(0.3 * mass * (a**5 - b**5) / (a**3 - b**3), rel=1e-11)
    upside_down = mass_properties(build.frustum(b, a, h), 1.0)
    np.testing.assert_allclose(upside_down[1], -found[1], atol=1e-14 * h)
    np.testing.assert_allclose(upside_down[2], found[2], rtol=1e-12)


def test_frustum_as_a_difference_of_two_cones() -> None:
    def cone(r: float, h: float) -> np.ndarray:
        """Volume, first and second moment in z, from the apex down, and second moment across."""
        volume = pi * r * r * h / 3
        return volume * np.array([1, 3 / 4 * h, 3 / 5 * h * h, 3 / 20 * r * r])

    volume, first, along, across = cone(1.2, 3.6) - cone(0.5, 1.5)
    found = mass_properties(build.frustum(1.2, 0.5, 2.1), 1.0)
    depth = first / volume
    inertia = along - volume * depth**2 + across
    assert found[0] == pytest.approx(volume, rel=1e-13)
    assert found[1][2] == pytest.approx(1.5 + 2.1 / 2 - depth, rel=1e-12)
    np.testing.assert_allclose(np.diag(found[2]), [inertia, inertia, 2 * across], rtol=1e-12)


@given(LENGTH, LENGTH)
def test_capsule(r: float, h: float) -> None:
    cylinder, ball = pi * r * r * h, 4 / 3 * pi * r**3
    along = cylinder * r * r / 2 + ball * 2 / 5 * r * r
    across = cylinder * (r * r / 4 + h * h / 12) + ball * (2 / 5 * r * r + h * h / 4 + 3 / 8 * h * r)
    close(build.capsule(r, h), cylinder + ball, [0, 0, 0], np.diag([across, across, along]))


@given(LENGTH, st.floats(0.05, 1.95))
def test_two_domes_are_a_ball(radius: float, share: float) -> None:
    """Their volumes pi h^2 (3 R - h)/3 and their inertia about the centre of the ball."""
    parts = [mass_properties(build.dome(radius, height * radius), 1.0) for height in (share, 2 - share)]
    whole = mass_properties(build.sphere(radius), 1.0)
    assert sum(part[0] for part in parts) == pytest.approx(whole[0], rel=1e-12)
    both = np.zeros(3)
    for (mass, centre, inertia), height in zip(parts, (share, 2 - share), strict=True):
        h = height * radius
        assert mass == pytest.approx(pi * h * h * (3 * radius - h) / 3, rel=1e-12)
        arm = centre[2] - (h - radius)
        both += np.diag(inertia) + mass * arm * arm * np.array([1.0, 1.0, 0.0])
    np.testing.assert_allclose(both, np.diag(whole[2]), rtol=1e-11)


@given(LENGTH, st.floats(0.05, 0.95))
@pytest.mark.slow
def test_half_torus(major: float, ratio: float) -> None:
    """pi^2 R r^2; two halves make the torus."""
    minor = ratio * major
    half = build.half_torus(major, minor)
    mass, centre, inertia = mass_properties(half, 1.0)
    assert mass == pytest.approx(pi**2 * major * minor**2, rel=1e-12)
    assert centre[1] == pytest.approx((4 * major**2 + minor**2) / (2 * pi * major), rel=1e-12)
    both = 2 * (inertia + mass * np.diag([centre[1] ** 2, 0, centre[1] ** 2]))
    whole = mass_properties(build.torus(major, minor), 1.0)
    np.testing.assert_allclose(np.diag(both), np.diag(whole[2]), rtol=1e-12)
    assert whole[0] == pytest.approx(2 * mass, rel=1e-12)


def test_tetrahedron() -> None:
    a, b, c = 1.0, 2.0, 3.0
    shape = build.polyhedron([[0, 0, 0], [a, 0, 0], [0, b, 0], [0, 0, c]])
    second = (a * b * c / 6) * np.array(
        [
            [3 / 80 * a * a, -a * b / 80, -a * c / 80],
            [-a * b / 80, 3 / 80 * b * b, -b * c / 80],
            [-a * c / 80, -b * c / 80, 3 / 80 * c * c],
        ]
    )
    inertia = np.trace(second) * np.eye(3) - second
    close(shape, 1.0, [a / 4, b / 4, c / 4], inertia)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.floats(-50, 50))
def test_a_polyhedron_is_its_hull_wherever_it_lies(seed: int, shift: float) -> None:
    points = np.random.default_rng(seed).normal(size=(14, 3))
    here = mass_properties(build.polyhedron(points.tolist()), 1.0)
    there = mass_properties(build.polyhedron((points + shift).tolist()), 1.0)
    assert here[0] == pytest.approx(ConvexHull(points).volume, rel=1e-12)
    np.testing.assert_allclose(there[1] - shift, here[1], atol=1e-12)
    np.testing.assert_allclose(there[2], here[2], atol=1e-12 * np.trace(here[2]))


def test_a_box_told_four_ways() -> None:
    x, y, z = 1.0, 2.0, 3.0
    expected = mass_properties(build.box(x, y, z), 2.0)
    corners = [[sx * x / 2, sy * y / 2, sz * z / 2] for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    outline = [[-x / 2, -y / 2], [-x / 2, y / 2], [x / 2, y / 2], [x / 2, -y / 2]]
    for other in (build.polyhedron(corners), build.extrusion(z, points=outline)):
        found = mass_properties(other, 2.0)
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-13)


def test_an_l_profile_is_two_boxes() -> None:
    length = 1.5
    boxes = [(2.0, 0.7, (1.0, 0.35)), (0.8, 1.3, (0.4, 1.35))]
    masses = np.array([x * y * length for x, y, _ in boxes])
    centres = np.array([[*at, 0.0] for _, _, at in boxes])
    centre = masses @ centres / masses.sum()
    inertia = np.zeros((3, 3))
    for mass, at, (x, y, _) in zip(masses, centres, boxes, strict=True):
        arm = at - centre
        inertia += mass / 12 * np.diag([y * y + length**2, x * x + length**2, x * x + y * y])
        inertia += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    close(build.extrusion(length, points=L_OUTLINE), masses.sum(), centre.tolist(), inertia)


def test_an_elliptic_prism() -> None:
    a, b, h = 1.5, 1.0, 1.2
    mass = pi * a * b * h
    inertia = mass * np.diag([b * b / 4 + h * h / 12, a * a / 4 + h * h / 12, (a * a + b * b) / 4])
    outline = {
        "x": "2 + a*cos(t)",
        "y": "3 - b*sin(t)",
        "domain": [0, "2*pi"],
        "parameters": {"a": a, "b": b},
    }
    close(build.extrusion(h, **outline), mass, [2, 3, 0], inertia)


def test_the_area_of_a_polygon_is_that_of_its_many_sided_outline() -> None:
    lobed = {"x": "(1 + 0.3*cos(3*t))*cos(t)", "y": "(1 + 0.3*cos(3*t))*sin(t)", "domain": ["-pi", "pi"]}
    mass, centre, _ = mass_properties(build.extrusion(1, **lobed), 1.0)
    assert mass == pytest.approx(pi * (1 + 0.3**2 / 2), rel=1e-13)
    np.testing.assert_allclose(centre, 0, atol=1e-14)


def ring_net(count: int) -> Shape:
    """The cubic net that meets a torus at its knots, where it is (4 + 2 cos h)/6 of its control circle."""
    angle = 2 * pi / count * np.arange(count)
    grow = 6 / (4 + 2 * np.cos(angle[1]))
    tube = [(2 + 0.5 * grow * np.cos(v), 0.5 * grow * np.sin(v)) for v in angle]
    points = [[[grow * rho * np.cos(u), grow * rho * np.sin(u), z] for rho, z in tube] for u in angle]
    return build.bspline(points, periodic=[True, True])


@pytest.mark.slow
def test_a_closed_net_encloses_its_volume() -> None:
    """The error against the torus falls with the fourth power of the spacing."""
    mass, _, inertia = mass_properties(build.torus(2, 0.5), 1.0)
    coarse, fine = (mass_properties(ring_net(count), 1.0) for count in (8, 16))
    assert abs(coarse[0] - mass) / 24 < abs(fine[0] - mass) < abs(coarse[0] - mass) / 10
    assert fine[0] == pytest.approx(mass, rel=1e-3)
    np.testing.assert_allclose(fine[1], 0, atol=1e-13)
    np.testing.assert_allclose(fine[2], inertia, rtol=2e-3, atol=1e-12)


def test_what_has_no_volume_asks_for_mass_and_inertia() -> None:
    for shape in (build.disc(1), build.box(1, 1, 1, cavity=True), build.cylinder(1)):
        with pytest.raises(SceneError, match="mass and inertia"):
            mass_properties(shape, 1.0)


@pytest.mark.parametrize("name", SPECIMENS)
def test_no_point_lies_beyond_the_bounding_radius(name: str) -> None:
    shape = SPECIMENS[name].shape
    radius = bounding_radius(shape)
    corners = [
        [value for _, value in feature.shape.parameters]
        for feature in features_of(shape).features
        if feature.dimension == 0
    ]
    assert all(np.linalg.norm(corner) <= radius * (1 + 1e-15) for corner in corners)
    random = np.random.default_rng(2)
    inside = [x for x in random.uniform(-3, 3, (3000, 3)) if SPECIMENS[name].level(x) <= 0]
    assert all(np.linalg.norm(x) <= radius for x in inside)
    assert radius <= 1.3 * SPECIMENS[name].size
