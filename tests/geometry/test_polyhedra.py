"""Convex hulls as faces, edges and vertices: closed, and with the faces of one plane merged."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from modelgen.geometry.shape_features import features_of
from modelgen.scene import python_scenes as build

from .composites import SPECIMENS, by_name


@pytest.mark.parametrize("name", ["box", "tetrahedron", "gem"])
def test_a_polyhedron_obeys_euler(name: str) -> None:
    counts = Counter(feature.dimension for feature in features_of(SPECIMENS[name].shape).features)
    assert counts[0] - counts[1] + counts[2] == 2


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(4, 30), st.floats(-100, 100))
def test_any_polyhedron_is_closed(seed: int, count: int, shift: float) -> None:
    """Euler, adjacency, and every edge in two faces, for hulls of random points on a coarse lattice."""
    random = np.random.default_rng(seed)
    points = random.integers(-2, 3, (count, 3)).astype(float)
    if np.linalg.matrix_rank(points - points[0]) < 3:
        return
    features = by_name(build.polyhedron((points + shift).tolist()))
    counts = Counter(feature.dimension for feature in features.values())
    assert counts[0] - counts[1] + counts[2] == 2
    ends = Counter(c.next for f in features.values() if f.dimension == 2 for c in f.conditions)
    assert all(ends[name] == 2 for name, feature in features.items() if feature.dimension == 1)
    corners = Counter(c.next for f in features.values() if f.dimension == 0 for c in f.conditions)
    assert all(corners[name] == 2 for name, feature in features.items() if feature.dimension == 1)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.floats(-14, -4))
@example(287, -13.5)
def test_corners_that_are_nearly_in_one_plane_leave_no_gap(seed: int, decade: float) -> None:
    """Faces end at edges or at each other, edges at vertices, however a lattice is disturbed."""
    random = np.random.default_rng(seed)
    points = random.integers(-2, 3, (random.integers(8, 30), 3)) + 10**decade * random.normal(size=3)
    if np.linalg.matrix_rank(points - points[0]) < 3:
        return
    points += 10**decade * random.normal(size=points.shape)
    features = features_of(build.polyhedron(points.tolist())).features
    assert all(condition.next is not None for feature in features for condition in feature.conditions)
    ends = Counter(c.next for f in features if f.dimension == 2 for c in f.conditions)
    assert all(ends[feature.name] == 2 for feature in features if feature.dimension == 1)


@pytest.mark.slow
def test_faces_of_one_plane_are_merged_and_points_inside_left_out() -> None:
    """A cube told by its corners, middles of edges and faces, and its centre: 6, 12 and 8."""
    points = [[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    counts = Counter(feature.dimension for feature in features_of(build.polyhedron(points)).features)
    assert counts == {2: 6, 1: 12, 0: 8}
    corner = by_name(build.polyhedron(points))["v26"]
    assert [value for _, value in corner.shape.parameters] == [1, 1, 1]


def test_a_dodecahedron_in_decimals_has_pentagons() -> None:
    g = round((1 + 5**0.5) / 2, 11)
    cube = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    rest = [[0, s / g, t * g] for s in (-1, 1) for t in (-1, 1)]
    points = cube + [p[k:] + p[:k] for p in rest for k in range(3)]
    features = features_of(build.polyhedron(points)).features
    counts = Counter(feature.dimension for feature in features)
    assert counts == {2: 12, 1: 30, 0: 20}
    assert {len(feature.conditions) for feature in features if feature.dimension == 2} == {5}
