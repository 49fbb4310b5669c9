"""The features of boxes that are fixed together are those of their union: judged by distances of points."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from modelgen.geometry.convex_cells import Cell, cells_of, ends_of, range_of
from modelgen.geometry.exposed_features import Beside, exposed, is_hidden
from modelgen.geometry.face_regions import to_axes
from modelgen.geometry.shape_features import features_of
from modelgen.rotations import rotation_of
from modelgen.scene import python_scenes as make
from modelgen.scene.pose_arithmetic import to_outer
from modelgen.scene.scene_types import Feature, Pose

Array = np.ndarray[Any, np.dtype[np.float64]]
Box = tuple[tuple[int, int, int], tuple[int, int, int]]  # lower corner and size on a grid, m

REACH, FLUSH = 1e-4, 1e-9
WHOLE = make.box(2.0, 2.0, 2.0)


def placed(box: Box, off: float) -> tuple[Array, Array]:
    low, size = (np.array(each, dtype=float) for each in box)
    return low - 1.0 + off, low - 1.0 + off + size


def cell_of(low: Array, high: Array) -> Cell:
    x, y, z = map(float, high - low)
    (cell,) = cells_of(make.box(x, y, z))
    middle = (low + high) / 2
    return cell.placed(Pose((float(middle[0]), float(middle[1]), float(middle[2]))))


def distance(x: Array, solids: list[tuple[Array, Array]]) -> float:
    return min(float(np.linalg.norm(np.maximum(np.maximum(low - x, x - high), 0.0))) for low, high in solids)


def is_normal(x: Array, n: Array, solids: list[tuple[Array, Array]]) -> bool:
    """Whether the point of the union nearest to one that is a little off x along n is x."""
    return distance(x + REACH * n, solids) > REACH * (1 - 1e-5)


boxes = st.lists(
    st.tuples(
        st.tuples(*[st.integers(-2, 3)] * 3), st.tuples(*[st.integers(1, 3)] * 3)
    ),
    min_size=1, max_size=3,
)  # fmt: skip


@given(boxes, st.sampled_from([0.0, 1e-16, -1e-12, 1e-10]), st.integers(0, 2**32 - 1))
def test_features_left_are_those_of_the_union(others: list[Box], off: float, seed: int) -> None:
    """`off`: by how much the others are off the grid, m."""
    random = np.random.default_rng(seed)
    beside = [placed(each, off) for each in others]
    solids = [(np.full(3, -1.0), np.full(3, 1.0)), *beside]
    features = features_of(WHOLE).features
    left = [
        each
        for each in exposed(features, [Beside(cell_of(*each), False) for each in beside], FLUSH)
        if not is_hidden(each)
    ]
    for feature in features:
        parts = [each for each in left if each.name.split(".")[0] == feature.name]
        if feature.dimension == 0:
            check_vertex(feature, parts, solids, random)
        elif feature.dimension == 1:
            check_edge(feature, parts, solids, random)
        else:
            check_face(feature, parts, solids, random)


def check_vertex(
    vertex: Feature, parts: list[Feature], solids: list[tuple[Array, Array]], random: np.random.Generator
) -> None:
    at = np.array([value for _, value in vertex.shape.parameters])
    found = [
        is_normal(at, n / np.linalg.norm(n), solids) for n in np.sign(at) * random.uniform(0.2, 1, (9, 3))
    ]
    assert bool(parts) == all(found)


def check_edge(
    edge: Feature, parts: list[Feature], solids: list[tuple[Array, Array]], random: np.random.Generator
) -> None:
    """At points that are off the grid, and well within it or not; parts end on the grid."""
    a, b = ends_of(edge)
    assert all(abs(end - np.rint(end)) < FLUSH / 2 for each in parts for end in range_of(each))
    outward = np.sign((a + b) / 2)
    for share in (random.integers(0, 2, 6) + random.uniform(0.1, 0.9, 6)) / 2:
        at = a + share * (b - a)
        normals = outward * random.uniform(0.2, 1, (4, 3))
        found = [is_normal(at, n / np.linalg.norm(n), solids) for n in normals]
        t = range_of(edge)[0] + share * np.linalg.norm(b - a)
        assert any(low < t < high for low, high in map(range_of, parts)) == all(found)


def check_face(
    face: Feature, parts: list[Feature], solids: list[tuple[Array, Array]], random: np.random.Generator
) -> None:
    """Nothing that can be touched is hidden; what is hidden along a border cannot be touched."""
    normal = rotation_of(face.shape.pose.quaternion)[:, 2]
    for i, j in product((-0.5, 0.5), repeat=2):
        local = np.array([i, j, 0.0]) + np.append(random.uniform(-0.4, 0.4, 2), 0.0)
        is_left = any(
            all(each.numbers[0] + local @ each.numbers[1:4] > 0 for each in part.conditions) for part in parts
        )
        assert is_left or not is_normal(to_outer(face.shape.pose, local), normal, solids)


@pytest.mark.parametrize("turn", range(5))
def test_it_does_not_matter_how_the_scene_is_turned(turn: int) -> None:
    rotation = Rotation.random(random_state=turn)
    quaternion = np.roll(rotation.as_quat(), 1)
    w, x, y, z = map(float, quaternion)
    beside = make.box(1.0, 2.0, 2.0)
    own = Pose((0.3, 0.1 + 0.2, -0.7), (w, x, y, z))
    other = Pose(tuple(map(float, to_outer(own, [1.5, 0.0, 0.0]))), (w, x, y, z))  # type: ignore[arg-type]
    (cell,) = cells_of(beside)
    beside = [Beside(cell.placed(to_axes(own, other)), False)]
    left = exposed(features_of(WHOLE).features, beside, FLUSH)
    hidden = {each.name for each in left if is_hidden(each)}
    assert hidden == {each.name for each in features_of(WHOLE).features if "right" in each.name}
