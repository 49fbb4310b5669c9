"""Meridians of surfaces of revolution: they lie on them, and only surfaces that a ball can touch all around
have one."""

from __future__ import annotations

from collections.abc import Callable
from math import tan

import numpy as np
import pytest

from modelgen.assembly.coaxial_supports import coaxial_supports_of
from modelgen.assembly.rim_support_points import SUPPORT_POINTS
from modelgen.geometry.face_regions import points_of
from modelgen.geometry.shape_features import features_of
from modelgen.scene import python_scenes as make
from modelgen.scene.pose_arithmetic import to_outer
from modelgen.scene.scene_types import Feature, Shape

T = np.linspace(0.01, 0.9, 7)
Residual = Callable[[np.ndarray, np.ndarray], np.ndarray]  # of r and z, 0 on the surface

SURFACES: dict[str, tuple[Shape, Residual]] = {
    "circle": (make.circle(0.3), lambda r, z: np.hypot(r - 0.3, z)),
    "cone": (make.shape("cone", half_angle=0.5, cavity=True), lambda r, z: r - np.abs(z) * tan(0.5)),
    "paraboloid": (make.paraboloid(0.4, 0.4), lambda r, z: z - r**2 / 0.8),
    "ellipsoid": (
        make.ellipsoid(0.5, 0.5, 0.7, cavity=True), lambda r, z: (r / 0.5) ** 2 + (z / 0.7) ** 2 - 1,
    ),
    "revolution": (
        make.revolution("0.1 + t", "t**2", domain=(0.0, 1.0), cavity=True), lambda r, z: z - (r - 0.1) ** 2,
    ),
}  # fmt: skip


def places(support: Feature) -> np.ndarray:
    """(n, 3) m: points of a support in the axes of its bearer."""
    shape = support.shape
    if shape.kind == "point":
        return np.array([[value for _, value in shape.parameters]])
    local = np.outer(T, [0, 0, 1]) if shape.kind == "line" else points_of(shape, T)
    return to_outer(shape.pose, local)


@pytest.mark.parametrize("name", SURFACES)
def test_three_meridians_lie_on_the_surface_a_third_of_a_turn_apart(name: str) -> None:
    shape, residual = SURFACES[name]
    bearer = features_of(shape).features[0]
    found = [places(each) for each in coaxial_supports_of(bearer)]
    azimuths = [np.arctan2(x[-1, 1], x[-1, 0]) for x in found]
    assert len(found) == SUPPORT_POINTS
    for x in found:
        np.testing.assert_allclose(residual(np.hypot(x[:, 0], x[:, 1]), x[:, 2]), 0, atol=1e-15)
    np.testing.assert_allclose(np.exp(1j * np.array(azimuths)) ** SUPPORT_POINTS, 1, atol=1e-14)


def test_the_supports_of_a_torus_are_balls_in_it() -> None:
    (bearer,) = features_of(make.torus(0.3, 0.1)).features
    for each in coaxial_supports_of(bearer):
        x, y, z = each.shape.pose.position
        assert each.shape.parameters == (("radius", 0.1),)
        assert (np.hypot(x, y), z) == (pytest.approx(0.3, abs=1e-15), 0.0)


def test_an_open_surface_that_faces_away_from_its_axis_has_those_of_its_rims() -> None:
    sheet, *rims = features_of(make.revolution("0.1 + t", "t**2", domain=(0.0, 1.0))).features
    assert not coaxial_supports_of(sheet)
    for rim, (r, z), slope in zip(rims, ((0.1, 0.0), (1.1, 1.0)), ((1, 0), (-1, -2)), strict=True):
        for k, each in enumerate(coaxial_supports_of(rim)):
            turn = 2 * np.pi * k / SUPPORT_POINTS
            across = np.array([np.cos(turn), np.sin(turn)])
            np.testing.assert_allclose(places(each)[0], [*(r * across), z], atol=1e-15)
            inward = np.array([*(slope[0] * across), slope[1]]) / np.hypot(*slope)
            for condition in each.conditions[:-1]:
                np.testing.assert_allclose(condition.numbers, inward, atol=1e-11)


@pytest.mark.parametrize(
    "shape",
    [
        make.sphere(0.1),
        make.ellipsoid(0.5, 0.5, 0.7),
        make.ellipsoid(0.5, 0.4, 0.7, cavity=True),
        make.paraboloid(0.4, 0.3),
        make.torus(0.3, 0.1, cavity=True),
        make.shape("cone", half_angle=0.5),
        make.chart("u", "v", "u*v", domain=((-1.0, 1.0), (-1.0, 1.0))),
    ],
)
def test_other_surfaces_have_none(shape: Shape) -> None:
    assert all(not coaxial_supports_of(each) for each in features_of(shape).features)
