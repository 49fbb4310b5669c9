"""Polylines with rounded corners: one line with a continuous tangent, of the length that geometry says."""

from __future__ import annotations

from math import pi, sqrt, tan

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from modelgen.errors import SceneError
from modelgen.geometry.shape_features import features_of
from modelgen.rotations import rotation_of
from modelgen.scene import python_scenes as build
from modelgen.scene.pose_arithmetic import to_outer
from modelgen.scene.scene_types import Feature, Shape
from tests.geometry.joins import features, jets

HOOK = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 2, 0], [1, 2, 1]]
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
CORNER = st.tuples(*[st.floats(-1, 1)] * 3)


def end(feature: Feature, which: int) -> tuple[np.ndarray, np.ndarray]:
    """Point and unit tangent, frame of the polyline, at the start (0) or the end (1) of a part."""
    _, _, bound = feature.conditions[which].numbers
    x, first, _ = jets(feature.shape, np.array([[bound]]))
    tangent = rotation_of(feature.shape.pose.quaternion) @ first[0, :, 0]
    return to_outer(feature.shape.pose, x[0]), tangent / np.linalg.norm(tangent)


def length(shape: Shape) -> float:
    total = 0.0
    for feature in features_of(shape).features:
        _, _, reach = feature.conditions[1].numbers
        radius = dict(feature.shape.parameters)["radius"] if feature.shape.kind == "circle" else 1.0
        total += 2 * reach * radius
    return total


def assert_joined(shape: Shape, rounding: float = 3e-15) -> None:
    parts = features(shape)
    for feature in parts.values():
        following = feature.conditions[1].next
        if following is not None:
            assert parts[following].conditions[0].next == feature.name
            for here, there in zip(end(feature, 1), end(parts[following], 0), strict=True):
                np.testing.assert_allclose(here, there, atol=rounding)


def test_parts_follow_one_another() -> None:
    shape = build.polyline(HOOK, 0.2)
    assert list(features(shape)) == ["piece_0", "corner_1", "piece_1", "piece_2", "corner_3", "piece_3"]
    assert features(shape)["piece_0"].conditions[0].next is None
    assert features(shape)["piece_3"].conditions[1].next is None
    np.testing.assert_allclose(end(features(shape)["piece_0"], 0)[0], HOOK[0], atol=1e-16)
    np.testing.assert_allclose(end(features(shape)["piece_3"], 1)[0], HOOK[-1], atol=1e-16)
    assert_joined(shape)


@pytest.mark.parametrize("radius", [0.01, 0.3, 0.5])
def test_a_closed_line_comes_back(radius: float) -> None:
    """Four quarters of a circle and what is left of the sides: nothing, where the arcs touch."""
    shape = build.polyline(SQUARE, radius, closed=True)
    assert_joined(shape)
    assert len(features(shape)) == (4 if radius == 0.5 else 8)
    assert all(condition.next for part in features(shape).values() for condition in part.conditions)
    assert length(shape) == pytest.approx(4 * (1 - 2 * radius) + 2 * pi * radius)


@given(st.lists(CORNER, min_size=3, max_size=6), st.booleans())
def test_any_corners_are_joined_smoothly(corners: list[tuple[float, float, float]], closed: bool) -> None:
    points = np.array(corners)
    assume(np.linalg.norm(np.diff(points, axis=0, append=points[:1]), axis=1).min() > 0.2)
    try:
        shape = build.polyline(points.tolist(), 0.02, closed=closed)
    except SceneError:
        assume(False)
    ways = np.diff(points, axis=0, append=points[:1])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    turns = np.linalg.norm(np.cross(ways, np.roll(ways, 1, axis=0)), axis=1)  # sines
    assert_joined(shape, 3e-15 / turns[turns > 0].min(initial=1.0))  # the plane of an arc rounds so


def test_the_radius_is_that_of_the_arcs() -> None:
    shape = build.polyline([[0, 0, 0], [1, 0, 0], [1 + sqrt(0.5), sqrt(0.5), 0]], 0.3)
    corner = features(shape)["corner_1"]
    assert corner.shape.parameters == (("radius", 0.3),)
    assert corner.conditions[1].numbers[2] == pytest.approx(pi / 8)
    assert np.linalg.norm(end(corner, 0)[0] - [1, 0, 0]) == pytest.approx(0.3 * tan(pi / 8))


@pytest.mark.parametrize(
    ("points", "radius", "found"),
    [
        ([[0, 0, 0]], 0.1, "1 points"),
        ([[0, 0, 0], [0, 0, 0]], 0.1, "equal to the one before"),
        ([[0, 0, 0], [1, 0, 0], [0, 0, 0]], 0.1, "a turn of 3.14159 rad"),
        (SQUARE, 0.6, "arcs that need 1.2 m of the 1 m"),
        (SQUARE, 0, "a positive number"),
    ],
)
def test_what_has_no_room_is_refused(points: list[list[float]], radius: float, found: str) -> None:
    with pytest.raises(SceneError, match=found):
        build.polyline(points, radius)
