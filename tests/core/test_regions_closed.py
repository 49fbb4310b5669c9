"""Hulls of overlaps against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from modelgen.errors import SimulationError
from modelgen.runtime.region_overlap import Arc, overlap
from tests.core.conftest import CoreBuild
from tests.core.planar import (
    FRAME,
    LETTER,
    annulus,
    at,
    disc,
    ellipse,
    facing,
    polygon,
    rectangle,
    regular,
    signed_distance,
    stadium,
)

Build = Callable[[str], CoreBuild]
CLOSE = 2e-15
ALIKE_AFTER_HALF = [stadium(0.4, 0.3), ellipse(1, 0.6)]
POINTS = np.array([[0, 0], [0.3, -0.2], [0.7, 0.1], [1.2, 0.4], [-2.0, 0.5], [0.0, 1.0]])
number = st.floats(-1.5, 1.5).filter(lambda x: abs(x) > 1e-9)


@pytest.mark.cases(2)
@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize("holed", [False, True])
def test_in_a_disc_or_ring_the_margin_is_radius_less_distance(
    plane_core: CoreBuild, size: float, holed: bool
) -> None:
    region = annulus(size, size / 2) if holed else disc(size)
    found = overlap(plane_core, [], region, points=size * POINTS)
    assert found.margin == pytest.approx(size * (1 - np.hypot(*POINTS.T)), rel=0, abs=CLOSE * size)


@settings(deadline=None)
@given(angle=st.floats(-pi, pi), depth=st.one_of(st.floats(0, 0.249), st.floats(0, 1e-12)))
@example(angle=pi, depth=7e-14)
@example(angle=pi, depth=3e-13)
@example(angle=0, depth=7e-14)
def test_in_an_ellipse_the_margin_is_the_depth_along_its_normal(
    plane_core: CoreBuild, angle: float, depth: float
) -> None:
    """Up to the least radius of curvature, b^2/a, the foot of a point is where its normal starts."""
    a, b = 1.0, 0.5
    foot = np.array([a * np.cos(angle), b * np.sin(angle)])
    normal = np.array([foot[0] / a**2, foot[1] / b**2])
    normal /= np.hypot(*normal)
    both = np.stack([foot - depth * normal, foot + 4 * depth * normal])
    found = overlap(plane_core, [], ellipse(a, b), points=both)
    assert found.margin == pytest.approx([depth, -4 * depth], rel=0, abs=8 * CLOSE)
    assert found.normal == pytest.approx(np.array([normal, normal]), abs=1e-6)


@settings(deadline=None)
@given(x=number, y=number)
def test_in_a_rectangle_the_margin_is_that_of_the_nearest_side(
    plane_core: CoreBuild, x: float, y: float
) -> None:
    a, b = 1.0, 0.6
    beyond = np.array([abs(x) - a, abs(y) - b])
    expected = -np.hypot(*np.maximum(beyond, 0)) if beyond.max() > 0 else -beyond.max()
    found = overlap(plane_core, [], rectangle(a, b), points=np.array([[x, y]]))
    assert found.margin[0] == pytest.approx(expected, rel=0, abs=CLOSE)


@settings(deadline=None)
@given(x=number, y=number)
def test_in_a_stadium_the_margin_is_radius_less_distance_to_the_segment(
    plane_core: CoreBuild, x: float, y: float
) -> None:
    a, r = 0.8, 0.5
    expected = r - np.hypot(max(abs(x) - a, 0), y)
    found = overlap(plane_core, [], stadium(a, r), points=np.array([[x, y]]))
    assert found.margin[0] == pytest.approx(expected, rel=0, abs=CLOSE)


@settings(deadline=None)
@given(distance=st.floats(0.01, 1.99), x=number, y=number)
def test_two_discs_share_a_lens(plane_core: CoreBuild, distance: float, x: float, y: float) -> None:
    """Its margin: the lesser depth in the discs, or the distance to a tip in the tip's normal cone."""
    c = distance / 2
    tip = np.array([0, sqrt(1 - c * c)])
    point = np.array([x, abs(y)])
    depth = min(1 - np.hypot(x - c, y), 1 - np.hypot(x + c, y))
    off = point - tip
    cone = min(np.dot(off, [tip[1], c]), np.dot(off, [-tip[1], c])) > 0
    expected = -np.hypot(*off) if cone else depth
    found = overlap(plane_core, disc(1, c), disc(1), facing(-c), np.array([[x, y]]))
    assert found.margin[0] == pytest.approx(expected, rel=0, abs=1e-12 / distance)


def test_a_disc_over_an_edge_of_a_table_keeps_the_part_on_it(plane_core: CoreBuild) -> None:
    table = rectangle(3, 2)
    found = overlap(plane_core, table, disc(1), facing(2.6), np.array([[2.9, 0], [3.5, 0.2], [1.7, 0.0]]))
    assert found.margin == pytest.approx([0.1, -0.5, 0.1], abs=CLOSE * 4)
    assert found.supports.tolist() == [2, 2, 1]
    ends = found.support_position[0, :, 2:]
    half = sqrt(1 - 0.4**2)
    assert sorted(ends[:, 1]) == pytest.approx([-half, half], abs=1e-15)
    assert ends[:, 0] == pytest.approx([3, 3], abs=1e-15)
    assert {tuple(one) for one in found.identity[0, :, 1:]} in ({(4, 1)}, {(1, 4)})
    assert found.identity[2, 0].tolist() == [1, 4, -1]


def test_the_hull_of_a_letter_spans_its_notch(plane_core: CoreBuild) -> None:
    found = overlap(plane_core, [], polygon(LETTER), points=np.array([[0.6, 0.6], [0.5, 0.5], [0, 0]]))
    assert found.sides == 5
    slope = (1.4 - 1.2) / sqrt(2)
    assert found.margin == pytest.approx([slope, slope + 0.2 / sqrt(2), 0], abs=CLOSE)
    assert [len(loop) for loop in found.outline] == [6]


def test_a_hole_is_part_of_the_hull(plane_core: CoreBuild) -> None:
    found = overlap(plane_core, FRAME, disc(0.9), facing(), np.zeros((1, 2)))
    assert found.margin[0] == pytest.approx(0.9, abs=CLOSE)
    assert len(found.outline) == 2


@pytest.mark.parametrize("quarter", range(4))
@pytest.mark.parametrize(
    "shape", [rectangle(1, 1), regular(8), disc(1), FRAME, stadium(0.4, 0.3), ellipse(1, 0.6)]
)
def test_equal_regions_exactly_on_each_other_overlap_wholly(
    plane_core: CoreBuild, shape: list[Arc], quarter: int
) -> None:
    if shape in ALIKE_AFTER_HALF:
        quarter *= 2
    alone = overlap(plane_core, [], shape, points=POINTS)
    found = overlap(plane_core, shape, shape, facing(0, 0, quarter * pi / 2), POINTS)
    assert found.margin == pytest.approx(alone.margin, rel=0, abs=1e-14)


@settings(deadline=None)
@given(slide=st.floats(-1.9, 1.9), x=number, y=number)
@example(slide=4.33e-13, x=-1.0, y=-1.0)  # sides so near are one
def test_bricks_with_sides_in_one_line_share_a_rectangle(
    plane_core: CoreBuild, slide: float, x: float, y: float
) -> None:
    low, high = max(-1, slide - 1), min(1, slide + 1)
    corners = np.array([[low, -1], [high, -1], [high, 1], [low, 1]])
    found = overlap(plane_core, rectangle(1, 1), rectangle(1, 1), facing(slide), np.array([[x, y]]))
    assert found.sides == 4
    off = 1e-13 if abs(slide) > 1e-12 else 1e-12
    assert found.margin[0] == pytest.approx(signed_distance(corners, np.array([x, y])), rel=0, abs=off)


def test_regions_apart_have_no_hull(plane_core: CoreBuild) -> None:
    found = overlap(plane_core, disc(1), rectangle(1, 1), facing(5), np.zeros((1, 2)))
    assert (found.sides, found.outline) == (0, ())
    assert found.margin[0] == -np.inf


def test_a_vertex_on_an_edge_is_a_hull_of_one_point(plane_core: CoreBuild) -> None:
    found = overlap(plane_core, rectangle(1, 1), regular(4), facing(2), np.array([[1, 0], [1, 3.0]]))
    assert found.sides == 1
    assert found.margin == pytest.approx([0, -3], abs=CLOSE)


def test_sides_that_touch_are_a_hull_of_a_segment(plane_core: CoreBuild) -> None:
    found = overlap(
        plane_core, rectangle(1, 1), rectangle(1, 0.5), facing(2), np.array([[1, 0], [1.2, 0], [1, 2.5]])
    )
    assert found.sides == 2
    assert found.margin == pytest.approx([0, -0.2, -2], abs=CLOSE)


@pytest.mark.cases(1)
@pytest.mark.parametrize(("real", "close"), [("float", 1e-6), ("double", 1e-15), ("long double", 1e-18)])
def test_every_real_type_is_exact_to_its_rounding(regions_in: Build, real: str, close: float) -> None:
    core = regions_in(real)
    points = np.array([[0, 0], [0.25, 0.5], [2, 0]], dtype=core.dtype)
    found = overlap(core, rectangle(1, 1), disc(0.75), facing(), points)
    assert np.all(np.abs(found.margin - (core.dtype(0.75) - np.hypot(*points.T))) <= close)


def test_a_placed_curve_is_where_it_is_placed(plane_core: CoreBuild) -> None:
    turned = Arc(2, (1.0, 0.5), (-pi, pi), tuple(at(0.5, 0.2, 0.7)))
    tip = np.array([0.5 + np.cos(0.7), 0.2 + np.sin(0.7)])
    mirrored = np.array([1 + tip[0], 2 - tip[1]])
    assert overlap(plane_core, [], [turned], points=tip[None]).margin[0] == pytest.approx(0, abs=CLOSE)
    found = overlap(plane_core, [], [turned], facing(1, 2), mirrored[None])
    assert found.margin[0] == pytest.approx(0, abs=CLOSE)


def test_a_region_without_boundary_is_refused(plane_core: CoreBuild) -> None:
    with pytest.raises(SimulationError, match="no arcs"):
        overlap(plane_core, disc(1), [])
