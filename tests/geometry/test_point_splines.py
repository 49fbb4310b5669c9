"""Splines through points as profiles: SciPy's splines, one feature each, smooth poles, exact moments."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from modelgen.errors import SceneError
from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.scene import python_scenes as make
from modelgen.scene.expression import evaluate
from modelgen.scene.expression_algebra import derivatives
from modelgen.scene.interpolating_splines import PointSpline, closed_spline, open_spline

Array = np.ndarray


def values(spline: PointSpline, t: Array, order: int = 0) -> Array:
    """(n, 2) of a derivative of the spline."""
    numbers = dict(spline.parameters)
    parts = derivatives(spline.components, "t" * order)
    return np.array([[evaluate(part, {**numbers, "t": at}) for part in parts] for at in t])


def chords(points: Array) -> Array:
    u = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return u / u[-1]


def measured(seed: int, count: int, closed: bool) -> Array:
    """Uneven points around an oval, or along half of it."""
    rng = np.random.default_rng(seed)
    span = 2 * np.pi if closed else np.pi
    angles = span * (np.arange(count) + 0.3 * rng.uniform(-1, 1, count)) / count - np.pi / 2
    radii = 0.1 + 0.005 * rng.normal(size=count)
    across = radii * np.cos(angles) + (0.0 if closed else 0.2)
    return np.column_stack([across, 1.4 * radii * np.sin(angles)])


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("closed", [False, True])
def test_a_spline_is_scipys_through_the_same_points_with_its_derivatives(seed: int, closed: bool) -> None:
    points = measured(seed, 17, closed)
    if closed:
        around = np.vstack([points, points[:1]])
        spline = closed_spline(points.tolist())
        expected = CubicSpline(chords(around), around, bc_type="periodic")
        t = np.linspace(-spline.reach, 1 + spline.reach, 211)
    else:
        spline = open_spline(points.tolist(), (False, False))
        expected = CubicSpline(chords(points), points)
        t = np.linspace(-0.02, 1.02, 211)
    for order in range(3):
        wanted = expected(t, nu=order)
        assert np.abs(values(spline, t, order) - wanted).max() < 1e-11 * np.abs(wanted).max()


@pytest.mark.parametrize("seed", range(3))
def test_a_profile_is_odd_and_even_about_its_poles(seed: int) -> None:
    points = measured(seed, 12, closed=False) - [0.2, 0.0]
    points[0, 0] = points[-1, 0] = 0.0
    spline = open_spline(points.tolist(), (True, True))
    assert np.abs(values(spline, chords(points)) - points).max() < 1e-13
    t = np.linspace(0, 0.4 * chords(points)[1], 20)
    for end, sign in ((0.0, 1.0), (1.0, -1.0)):
        for order in range(3):
            there, back = values(spline, end + t, order), values(spline, end - t, order)
            parity = np.array([-1.0, 1.0]) * (-1.0) ** order
            size = np.abs(there).max(axis=0) + np.abs(values(spline, np.array([0.5]), order)).max()
            assert (np.abs(there - parity * back) < 1e-12 * size).all(), (sign, order)


def test_a_profile_through_points_is_one_feature_and_a_cap_at_each_pole() -> None:
    angles = np.linspace(0, np.pi, 15)
    points = np.column_stack([np.sin(angles), -np.cos(angles)]) * 0.1
    points[0, 0] = points[-1, 0] = 0.0
    turned = features_of(make.shape("revolution", points=points.tolist())).features
    assert [feature.name for feature in turned] == ["sheet", "pole_v_min", "pole_v_max"]
    open_ended = features_of(make.shape("revolution", points=points[1:-1].tolist())).features
    assert [feature.name for feature in open_ended] == ["sheet", "rim_v_min", "rim_v_max"]
    ring = np.column_stack([np.cos(2 * angles[:-1]), np.sin(2 * angles[:-1])]).tolist()
    solid = features_of(make.extrusion(0.1, points=ring, smooth=True)).features
    assert [f.name for f in solid if f.dimension == 2] == ["side", "top", "top_core", "bottom", "bottom_core"]
    assert [f.name for f in solid if f.dimension == 1] == ["rim_top", "rim_bottom"]


def test_all_profiles_of_as_many_points_are_one_kind() -> None:
    shapes = [make.shape("revolution", points=(measured(seed, 9, closed=False)).tolist()) for seed in (1, 2)]
    assert shapes[0].chart == shapes[1].chart
    assert [name for name, _ in shapes[0].parameters] == [name for name, _ in shapes[1].parameters]
    assert shapes[0].parameters != shapes[1].parameters


@pytest.mark.parametrize("seed", range(2))
def test_an_extrusion_of_a_closed_spline_has_the_moments_of_its_area(seed: int) -> None:
    """By Gauss's rule, exact for polynomials, over each span of SciPy's spline."""
    points = measured(seed, 14, closed=True)
    around = np.vstack([points, points[:1]])
    u = chords(around)
    spline = CubicSpline(u, around, bc_type="periodic")
    nodes, weights = np.polynomial.legendre.leggauss(12)
    t = ((u[1:] + u[:-1])[:, None] / 2 + np.diff(u)[:, None] / 2 * nodes).ravel()
    w = (np.diff(u)[:, None] / 2 * weights).ravel()
    (x, y), (dx, dy) = spline(t).T, spline(t, nu=1).T
    swept = (x * dy - y * dx) * w
    area = swept.sum() / 2
    centre = np.array([x @ swept, y @ swept]) / (3 * area)
    mass, at, inertia = mass_properties(make.extrusion(0.3, points=points.tolist(), smooth=True), 7.0)
    assert mass == pytest.approx(7.0 * 0.3 * area, rel=1e-13)
    assert np.abs(at - [*centre, 0]).max() < 1e-14
    about = ((x - centre[0]) ** 2 + (y - centre[1]) ** 2) @ (
        ((x - centre[0]) * dy - (y - centre[1]) * dx) * w
    )
    assert inertia[2, 2] == pytest.approx(7.0 * 0.3 * about / 4, rel=1e-12)


def test_a_revolution_through_points_has_the_moments_of_its_profile() -> None:
    points = measured(4, 10, closed=False) - [0.2, 0.0]
    points[0, 0] = points[-1, 0] = 0.0
    spline = open_spline(points.tolist(), (True, True))
    breaks = sorted({*chords(points), chords(points)[1] / 2, (chords(points)[-2] + 1) / 2})

    def over(power: int, height: int) -> float:
        """Exact: each part is a polynomial, of degree 14 at most."""
        nodes, weights = np.polynomial.legendre.leggauss(8)
        total = 0.0
        for a, b in pairwise(breaks):
            t = (a + b) / 2 + (b - a) / 2 * nodes
            (r, z), dz = values(spline, t).T, values(spline, t, 1)[:, 1]
            total += (b - a) / 2 * float(weights @ (r**power * z**height * dz))
        return total

    mass, at, inertia = mass_properties(make.shape("revolution", points=points.tolist()), 3.0)
    assert mass == pytest.approx(3.0 * np.pi * over(2, 0), rel=1e-11)
    assert at[2] == pytest.approx(over(2, 1) / over(2, 0), rel=1e-10)
    assert inertia[2, 2] == pytest.approx(3.0 * np.pi / 2 * over(4, 0), rel=1e-11)


def test_the_bounding_radius_of_a_surface_through_points_holds_it() -> None:
    shape = make.shape("revolution", points=measured(5, 8, closed=False).tolist())
    numbers = [value for _, value in shape.parameters]
    reach = max(np.hypot(*point) for point in measured(5, 8, closed=False))
    assert reach <= surface_of(shape).bounding(numbers) < 1.5 * reach


@pytest.mark.parametrize(
    ("keys", "found"),
    [
        ({"points": [[0.1, z] for z in range(5)]}, "5 points"),
        ({"points": [[0.1, 0], [0.1, 0], *([0.1, z] for z in range(1, 6))]}, r"points\[1\]: a point equal"),
        ({"points": [[0.1, z] for z in range(8)], "r": "t"}, "'points' and 'r' together"),
        ({"r": "t"}, "a profile without z"),
        ({"points": [[0.1, 0], [0.1, 1], [-0.1, 2], [0.1, 3], [0.1, 4], [0.1, 5]]}, "r is positive"),
        ({"points": [[0.1, z] for z in (0, 1, 1 + 1e-13, 2, 3, 4, 5)]}, "uneven"),
    ],
)
def test_points_that_are_no_profile_are_refused(keys: dict, found: str) -> None:
    with pytest.raises(SceneError, match=found):
        make.shape("revolution", **keys)
