"""B-splines and height fields as cells: scipy's values, and no trace of the joins."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline, RectBivariateSpline

from modelgen.geometry.composites.splines import Line
from modelgen.geometry.shape_features import features_of, is_composite
from modelgen.scene import python_scenes as build
from modelgen.scene.free_form_values import ControlPolygon, Net
from modelgen.scene.scene_types import Feature, Shape
from tests.geometry.joins import COUNT, change, curvatures, features, forms_of, jets, numbers_of
from tests.laws.configurations import Array

RANDOM = np.random.default_rng(11)
FLAT = np.stack(np.meshgrid(np.arange(7.0), np.arange(6.0), indexing="ij"), axis=-1)
POINTS = np.concatenate([FLAT, np.zeros((7, 6, 1))], axis=-1) / 4 + RANDOM.normal(size=(7, 6, 3)) / 20
PHI, TURN = 2 * np.pi * FLAT[..., 0] / 7, 2 * np.pi * FLAT[..., 1] / 6
OUT = 1.5 + 0.7 * np.cos(TURN)
RING = np.stack([OUT * np.cos(PHI), OUT * np.sin(PHI), 0.7 * np.sin(TURN)], axis=-1) + POINTS / 20
KNOTS = [[0, 0, 0, 0, 0.4, 1, 1.2, 2, 2, 2, 2], [-1, -0.5, -0.1, 0, 0.2, 0.7, 1, 1, 2, 2.5]]
BREAKS = [[0, 0.3, 1, 1.4, 2, 2.2, 3, 4], [0, 1, 2, 3, 3.5, 4, 5]]
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def surface(
    degree: int = 3, periodic: tuple[bool, bool] = (False, False), at: float = 0.0, **keys: object
) -> Shape:
    points = RING if any(periodic) else POINTS + at
    return build.bspline(points.tolist(), degree=degree, periodic=[*periodic], **keys)


NETS = {
    "cubic": surface(),
    "quartic": surface(4),
    "quintic": surface(5),
    "tube": surface(3, (True, False)),
    "torus": surface(4, (True, True)),
    "own knots": surface(knots=KNOTS),
    "own breakpoints": surface(periodic=(True, True), knots=BREAKS),
    "far away": surface(at=100.0),
}
WAVES = build.height_field(
    x := [0, 0.1, 0.25, 0.4, 0.5, 0.7],
    y := [-0.3, -0.1, 0, 0.1, 0.2, 0.35, 0.5],
    heights := (0.02 * np.sin(9 * np.array(x))[:, None] * np.cos(7 * np.array(y)) + 3).tolist(),
    name="waves",
)
WIRES = {
    "open": build.bspline_curve(POINTS[:, 0].tolist()),
    "closed": build.bspline_curve(POINTS[:, 0].tolist(), periodic=True),
    "quintic": build.bspline_curve(POINTS[:, 0].tolist(), degree=5, knots=[*[0] * 6, 0.7, *[1] * 6]),
    "far away": build.bspline_curve((POINTS[:, 0] + 100).tolist()),
}  # fmt: skip


def index_of(feature: Feature) -> list[int]:
    return [int(part) for part in feature.name.split("_")[1:]]


def wrapped(points: Array, lines: list[Line]) -> Array:
    """The control points, those of periodic directions repeated for scipy."""
    for axis, line in enumerate(lines):
        if line.periodic:
            head = np.take(points, range(line.degree), axis=axis)
            points = np.concatenate([points, head], axis=axis)
    return points


@pytest.mark.parametrize("name", NETS)
def test_cells_are_the_surface_of_scipy(name: str) -> None:
    net = NETS[name].spline
    assert isinstance(net, Net)
    u, v = (Line(net.knots[k], net.degree, net.periodic[k]) for k in (0, 1))
    points = wrapped(np.array(net.points), [u, v])
    inside = RANDOM.uniform(size=(2, 3))
    for feature in features_of(NETS[name]).features:
        i, j = index_of(feature)
        (a, b), (c, d) = u.ends(i), v.ends(j)
        x, first, second = jets(feature.shape, inside)
        found = [x, *np.moveaxis(first, -1, 0), *np.moveaxis(second, -1, 0)]
        for (du, dv), value in zip(ORDERS, found, strict=True):
            along = BSpline(u.knots, points, net.degree)(a + (b - a) * inside[0], nu=du)
            wanted = [
                BSpline(v.knots, row, net.degree)(c + (d - c) * t, nu=dv)
                for row, t in zip(along, inside[1], strict=True)
            ]
            scale = (b - a) ** du * (d - c) ** dv
            np.testing.assert_allclose(
                value, np.array(wanted) * scale, atol=2e-15 * np.abs(points).max() * 40
            )


def test_a_height_field_is_the_spline_of_scipy_through_the_heights() -> None:
    spline = RectBivariateSpline(x, y, heights, s=0)
    inside = RANDOM.uniform(size=(2, 4))
    for feature in features_of(WAVES).features:
        points, first, second = jets(feature.shape, inside)
        at, widths = points[:, :2].T, numbers_of(feature.shape)[[1, 3]]
        np.testing.assert_allclose(points[:, 2], spline(*at, grid=False), atol=1e-14)
        np.testing.assert_allclose(first[:, 2, 0], spline(*at, dx=1, grid=False) * widths[0], atol=1e-13)
        np.testing.assert_allclose(
            second[:, 2, 1], spline(*at, dx=1, dy=1, grid=False) * widths.prod(), atol=1e-13
        )
        np.testing.assert_allclose(
            second[:, 2, 2], spline(*at, dy=2, grid=False) * widths[1] ** 2, atol=1e-13
        )
    assert float(spline(x[2], y[3])[0, 0]) == pytest.approx(heights[2][3], abs=1e-15)


@pytest.mark.parametrize("name", WIRES)
def test_pieces_are_the_curve_of_scipy(name: str) -> None:
    polygon = WIRES[name].spline
    assert isinstance(polygon, ControlPolygon)
    line = Line(polygon.knots, polygon.degree, polygon.periodic)
    curve = BSpline(line.knots, wrapped(np.array(polygon.points), [line]), polygon.degree)
    inside = RANDOM.uniform(size=(1, 5))
    for feature in features_of(WIRES[name]).features:
        a, b = line.ends(*index_of(feature))
        found = jets(feature.shape, inside)
        for order in range(3):
            wanted = curve(a + (b - a) * inside[0], nu=order) * (b - a) ** order
            np.testing.assert_allclose(
                found[order].reshape(-1, 3), wanted, atol=2e-15 * np.abs(curve.c).max() * 40
            )


def joins(shape: Shape) -> list[tuple[Feature, Feature, int]]:
    """Pairs of a cell and the next one along an axis."""
    parts = features(shape)
    return [
        (feature, parts[condition.next], k // 2)
        for feature in parts.values()
        for k, condition in enumerate(feature.conditions)
        if k % 2 and condition.next is not None
    ]


def across(axis: int, size: int, random: np.random.Generator) -> tuple[Array, Array]:
    """Random coordinates on the side where a cell ends along an axis, in the cell and in the next one."""
    inside = random.uniform(0, 1, (size, COUNT))
    end, start = inside.copy(), inside.copy()
    end[axis], start[axis] = 1.0, 0.0
    return end, start


@pytest.mark.cases(9)
@pytest.mark.parametrize(
    ("name", "form"),
    [*product(NETS, ("mixed", "block")), *product(["waves"], ("implicit", "mixed", "block"))],
)
def test_joins_of_cells_leave_no_trace(name: str, form: str) -> None:
    """d, N, J, gamma of a contact on a join are those of both cells, 100 m from the origin too."""
    shape = (NETS | {"waves": WAVES})[name]
    pairs = joins(shape)
    assert form in forms_of(pairs[0][0].shape)
    random = np.random.default_rng(7)
    for seed in random.integers(0, len(pairs), 6):
        one, other, axis = pairs[seed]
        end, start = across(axis, 2, random)
        assert change((one.shape, end), (other.shape, start), form, int(seed)) < 1e-12


@pytest.mark.parametrize(
    ("name", "form"), [*product(["open", "closed", "quintic"], ("curve_implicit", "curve_block"))]
)
def test_joins_of_pieces_leave_no_trace(name: str, form: str) -> None:
    random = np.random.default_rng(8)
    for one, other, _ in joins(WIRES[name]):
        assert form in forms_of(one.shape)
        end, start = across(0, 1, random)
        assert change((one.shape, end), (other.shape, start), form, 3) < 1e-12


@pytest.mark.parametrize("name", ["cubic", "far away"])
def test_curvature_is_continuous_far_from_the_origin(name: str) -> None:
    """Mean and Gauss curvature agree on both sides of every join to 1e-12 of their largest values."""
    for one, other, axis in joins(NETS[name]):
        end, start = across(axis, 2, np.random.default_rng(9))
        for a, b in zip(curvatures(one.shape, end)[1:], curvatures(other.shape, start)[1:], strict=True):
            np.testing.assert_allclose(a, b, rtol=0, atol=1e-12 * np.abs(a).max())


@pytest.mark.parametrize("shape", [*NETS.values(), WAVES, *WIRES.values()])
def test_neighbours_lead_back(shape: Shape) -> None:
    assert is_composite(shape)
    parts = features(shape)
    for name, feature in parts.items():
        for k, condition in enumerate(feature.conditions):
            back = None if condition.next is None else parts[condition.next].conditions[k ^ 1].next
            assert back == (None if condition.next is None else name)


@given(st.tuples(*[st.floats(0.02, 0.98)] * 2))
def test_a_height_field_of_a_paraboloid_has_its_curvature(at: tuple[float, float]) -> None:
    grid = np.linspace(-0.5, 0.5, 6)
    z = grid[:, None] ** 2 / (2 * 0.8) + grid**2 / (2 * 1.4)
    shape = build.height_field(grid.tolist(), grid.tolist(), z.tolist())
    for feature in features_of(shape).features:
        x, _, _ = jets(feature.shape, np.array(at)[:, None])
        _, mean, gauss = curvatures(feature.shape, np.array(at)[:, None])
        fx, fy = x[0, 0] / 0.8, x[0, 1] / 1.4
        w = 1 + fx**2 + fy**2
        assert gauss[0] == pytest.approx(1 / (0.8 * 1.4 * w**2), rel=1e-10)
        assert mean[0] == pytest.approx(-((1 + fy**2) / 0.8 + (1 + fx**2) / 1.4) / (2 * w**1.5), rel=1e-10)


def test_walls_of_a_height_field_are_in_metres() -> None:
    """The conditions of its cells hold at points, not at chart coordinates: any form may carry them."""
    feature = features(WAVES)["cell_0_0"]
    shape = feature.shape
    for condition in feature.conditions:
        c, b = condition.numbers[0], np.array(condition.numbers[1:4])
        assert condition.kind == "quadric"
        assert np.linalg.norm(b) == 1
        for corner in product((0.0, 1.0), repeat=2):
            assert c + b @ jets(shape, np.array(corner)[:, None])[0][0] > -1e-15
