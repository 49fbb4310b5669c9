"""Hulls of overlaps: what holds of all regions, and brute force."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from modelgen.runtime.region_overlap import Arc, Overlap, overlap
from tests.core.conftest import CoreBuild
from tests.core.planar import (
    CUBIC,
    EDGE,
    FRAME,
    LETTER,
    Array,
    annulus,
    at,
    brute_margin,
    curve,
    disc,
    ellipse,
    facing,
    moved,
    polygon,
    rectangle,
    regular,
    stadium,
    wave,
)

SAIL = [Arc(CUBIC, (0.0, 0.1, 0.4, 0.3), (-1.0, 1.0)), *polygon([[1, 0.8], [-1, 0.0]])[:1]]
POINTS = np.random.default_rng(4).uniform(-1.5, 1.5, (12, 2))


@st.composite
def stars(draw: st.DrawFn) -> list[Arc]:
    """Polygons that are seen whole from their centre, convex or not."""
    radii = draw(st.lists(st.floats(0.3, 1), min_size=3, max_size=8))
    angle = 2 * pi * np.arange(len(radii)) / len(radii)
    return polygon(np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def regions() -> st.SearchStrategy[list[Arc]]:
    length = st.floats(0.2, 1)
    return st.one_of(
        stars(),
        st.builds(disc, length),
        st.builds(ellipse, length, length),
        st.builds(stadium, length, length),
        st.builds(wave, st.just(0.7), st.floats(0.02, 0.4), st.integers(2, 6)),
        st.builds(annulus, st.just(1.0), st.floats(0.2, 0.8)),
        st.sampled_from([rectangle(0.6, 0.3), polygon(LETTER), FRAME, SAIL]),
    )


def poses() -> st.SearchStrategy[Array]:
    place = st.floats(-0.8, 0.8)
    return st.builds(facing, place, place, st.floats(-pi, pi))


tables = st.one_of(st.just([]), regions())


@settings(deadline=None, max_examples=8)
@given(o=tables, f=regions(), pose=poses())
@example(o=wave(0.7, 0.17311904473615258, 3), f=disc(0.49), pose=facing(-0.1, -0.3, 0.0))
@example(o=annulus(1, 0.5), f=polygon(LETTER), pose=facing(0.7, -0.2, pi / 2))
def test_margins_are_those_of_a_dense_polygon(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array
) -> None:
    expected = brute_margin(o, f, pose, POINTS)
    assume(expected is not None)
    found = overlap(plane_core, o, f, pose, POINTS)
    low, high = -np.inf, np.inf
    for slip, n in ((0.0, 200), (1e-9, 200), (0.0, 1600)):  # a touch that is not quite one; narrow tongues
        brute = brute_margin(o, f, pose + slip * np.eye(12)[0], POINTS, n)
        low, high = np.maximum(low, brute), np.minimum(high, brute)
    assert np.all((found.margin >= high - 3e-3) & (found.margin <= low + 3e-3))


@settings(deadline=None, max_examples=40)
@given(o=tables, f=regions(), pose=poses())
def test_a_margin_is_the_distance_to_a_point_of_the_boundary(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array
) -> None:
    found = overlap(plane_core, o, f, pose, POINTS)
    assume(found.sides)
    for i, x in enumerate(POINTS):
        ends = found.support_position[i, : found.supports[i], 2:]
        side = ends[-1] - ends[0]
        part = np.clip((x - ends[0]) @ side / (side @ side), 0, 1) if side @ side else 0.0
        assert np.hypot(*(ends[0] + part * side - x)) == pytest.approx(abs(found.margin[i]), rel=0, abs=1e-13)


@settings(deadline=None, max_examples=40)
@given(o=tables, f=regions(), pose=poses())
def test_supports_are_where_their_arcs_are(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array
) -> None:
    found = overlap(plane_core, o, f, pose, POINTS)
    arcs, places = [*o, *f], [at()] * len(o) + [pose] * len(f)
    for i, count in enumerate(found.supports):
        for (side, arc, other), (t, u, *point) in zip(
            found.identity[i], found.support_position[i][:count], strict=False
        ):
            assert side == (arc >= len(o))
            for index, parameter in [(arc, t), (other, u)][: 1 + (other >= 0)]:
                there = moved(places[index], curve(arcs[index], np.array([parameter])))[0]
                assert there == pytest.approx(point, rel=0, abs=1e-12)


@settings(deadline=None, max_examples=40)
@given(o=regions(), f=regions(), pose=poses())
def test_the_hull_is_convex_and_holds_the_outline(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array
) -> None:
    found = overlap(plane_core, o, f, pose)
    assume(found.sides > 2)
    sides = np.roll(found.hull, -1, axis=0) - found.hull
    following = np.roll(sides, -1, axis=0)
    assert np.all(sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0] >= -1e-12)
    for loop in found.outline:
        assert overlap(plane_core, o, f, pose, loop).margin.min() >= -1e-12


def test_the_hull_grows_only_where_regions_overlap_more(plane_core: CoreBuild) -> None:
    """A disc that slides off a table: the margin of its centre falls by no more than the way."""
    way = np.linspace(0, 1, 2001)
    margins = [
        overlap(plane_core, rectangle(1, 1), disc(0.6), facing(0.3 + s), np.array([[0.3 + s, 0.1]])).margin[0]
        for s in way
    ]
    assert np.all(np.abs(np.diff(margins)) <= 2 * way[1] + 1e-13)


convex = st.one_of(
    st.builds(disc, st.floats(0.3, 1)),
    st.builds(ellipse, st.floats(0.3, 1), st.floats(0.3, 1)),
    st.builds(stadium, st.floats(0.2, 0.7), st.floats(0.2, 0.5)),
    st.sampled_from([rectangle(0.8, 0.5), regular(5), regular(6)]),
)


@settings(deadline=None, max_examples=40)
@given(
    o=convex,
    f=convex,
    pose=poses(),
    step=st.floats(1e-9, 1e-3),
    way=st.floats(-pi, pi),
    turn=st.floats(-1, 1),
)
def test_the_margin_is_continuous_in_the_motion(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array, step: float, way: float, turn: float
) -> None:
    """Convex regions of a diameter below 4 that share a ball of radius r: where one moves by a length, their
    intersection does by at most 4 / r of it."""
    before = _at_centre(plane_core, o, f, pose)
    assume(before is not None and before.margin[0] > 0.05)
    assert before is not None
    angle = np.arctan2(pose[4], pose[3]) + step * turn
    then = facing(pose[0] + step * np.cos(way), pose[1] + step * np.sin(way), angle)
    centre = before.hull.mean(axis=0)
    after = overlap(plane_core, o, f, then, centre[None])
    moved_by = 3 * step
    assert abs(after.margin[0] - before.margin[0]) <= 4 / before.margin[0] * moved_by + 1e-12


def _at_centre(core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array) -> Overlap | None:
    hull = overlap(core, o, f, pose).hull
    return overlap(core, o, f, pose, hull.mean(axis=0)[None]) if len(hull) > 2 else None


@settings(deadline=None, max_examples=40)
@given(o=tables, f=regions(), pose=poses(), size=st.sampled_from([1e-6, 1e-3, 1e3]))
def test_the_margin_scales_with_the_size(
    plane_core: CoreBuild, o: list[Arc], f: list[Arc], pose: Array, size: float
) -> None:
    assume(all(arc.shape not in (3, CUBIC) for arc in [*o, *f]))
    scaled_pose = np.concatenate([size * pose[:3], pose[3:]])
    small = overlap(plane_core, o, f, pose, POINTS)
    scaled = overlap(plane_core, _scaled(o, size), _scaled(f, size), scaled_pose, size * POINTS)
    assume(small.sides > 2)
    assert scaled.margin == pytest.approx(size * small.margin, rel=0, abs=1e-12 * size)


def _scaled(arcs: list[Arc], size: float) -> list[Arc]:
    return [
        Arc(
            arc.shape,
            [size * x for x in arc.parameters],
            (size * arc.ends[0], size * arc.ends[1]) if arc.shape == EDGE else arc.ends,
            (*(size * x for x in arc.placement[:3]), *arc.placement[3:]),
            arc.loop,
        )
        for arc in arcs
    ]


@settings(deadline=None)
@given(
    shape=st.sampled_from([disc(0.7), ellipse(0.9, 0.5), stadium(0.5, 0.3), rectangle(0.8, 0.5), regular(5)]),
    apart=st.floats(-17, -6),
    way=st.floats(-pi, pi),
)
def test_equal_regions_nearly_on_each_other_have_nearly_the_whole_margin(
    plane_core: CoreBuild, shape: list[Arc], apart: float, way: float
) -> None:
    """Through the tolerance within which their boundaries count as one."""
    slip = 10**apart
    pose = facing(slip * np.cos(way), slip * np.sin(way))
    points = np.array([[0.1, 0.05], [-0.2, 0.1]])
    whole = overlap(plane_core, [], shape, points=points).margin
    found = overlap(plane_core, shape, shape, pose, points).margin
    assert np.all(np.abs(found - whole) <= 2 * slip + 4e-13)
