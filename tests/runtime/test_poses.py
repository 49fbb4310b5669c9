"""Poses that a caller gives: [R | p], rotations row by row, and none that are no rotations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import closest_points, distance_minima
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.poses import pose_matrices, pose_rows
from modelgen.scene import python_scenes as make
from tests.running import library_of

Array = np.ndarray[Any, Any]
N = 1000
PLACES, RADII = (np.array([0.7, -0.4, 0.2]), np.array([-0.1, 0.5, 0.9])), (0.3, 0.2)
HERE = np.eye(3, 4)


def balls() -> Library:
    """Two bodies with a ball each beside their centres of mass."""
    bodies = [
        make.dynamic(name, make.sphere(radius, position=list(place)), mass=1.0, inertia=[1.0, 1.0, 1.0])
        for name, place, radius in zip("ab", PLACES, RADII, strict=True)
    ]
    return library_of(make.scene("balls", bodies, contact=[{"between": ["a", "b"]}]))


def rings(*, fixed: bool) -> Library:
    ring = make.torus(1.0, 0.1)
    first = make.fixed("a", ring) if fixed else make.dynamic("a", ring, density=1.0)
    second = make.dynamic("b", make.torus(0.6, 0.1), density=1.0, position=[0.0, 0.0, 1.0])
    return library_of(make.scene("rings", [first, second], contact=[{"between": ["a", "b"]}]))


def drawn(n: int, seed: int) -> Array:
    random = np.random.default_rng(seed)
    R = Rotation.random(n, random_state=random).as_matrix()
    return np.concatenate([R, random.normal(size=(n, 3, 1)) * 2], axis=2)


def transposed(poses: Array) -> Array:
    return np.concatenate([np.swapaxes(poses[..., :3], -1, -2), poses[..., 3:]], axis=-1)


def test_distances_are_those_of_points_at_R_x_plus_p() -> None:
    o, f = drawn(N, 1), drawn(N, 2)
    centres = [poses[..., :3] @ place + poses[..., 3] for poses, place in zip((o, f), PLACES, strict=True)]
    wanted = np.linalg.norm(centres[1] - centres[0], axis=1) - sum(RADII)
    found = closest_points(balls(), "a-b", o, f)
    assert np.abs(found.d - wanted).max() < 1e-12
    assert (np.abs(closest_points(balls(), "a-b", transposed(o), f).d - wanted) > 1e-9).mean() > 0.99


def test_distances_of_tori_do_not_change_where_both_are_moved_together() -> None:
    o, f, both = drawn(20, 3), drawn(20, 4), drawn(20, 5)
    moved = [
        np.concatenate([both[..., :3] @ each[..., :3], both[..., :3] @ each[..., 3:] + both[..., 3:]], axis=2)
        for each in (o, f)
    ]
    library = rings(fixed=False)
    first, second = closest_points(library, "a-b", o, f), closest_points(library, "a-b", *moved)
    assert np.abs(first.d - second.d).max() < 1e-9


def test_the_rows_of_the_core_come_back_as_matrices() -> None:
    poses = drawn(50, 6)
    np.testing.assert_array_equal(pose_matrices(pose_rows("poses", poses)), poses)


@pytest.mark.parametrize(
    ("pose", "told"),
    [
        (np.append(np.zeros(3), np.eye(3)), r"\(3, 4\)"),
        (np.tile(np.append(np.zeros(3), np.eye(3)), (2, 1)), r"\(3, 4\)"),
        (HERE * [[1.1], [1.0], [1.0]], r"R R\^T differs from 1"),
        (HERE + 1e-3 * np.eye(3, 4, 1), r"R R\^T differs from 1"),
        (HERE * [[-1.0], [1.0], [1.0]], "a reflection"),
        (np.stack([HERE, HERE[[1, 0, 2]]]), "row 1"),
    ],
)
def test_what_is_no_rotation_is_refused(pose: Array, told: str) -> None:
    library = rings(fixed=False)
    for call in (closest_points, distance_minima):
        with pytest.raises(ModelgenError, match=told):
            call(library, "a-b", pose, HERE)


def test_a_body_fixed_at_the_world_frame_is_not_moved() -> None:
    library, pose = rings(fixed=True), drawn(1, 7)[0]
    turned = np.column_stack([Rotation.from_euler("z", np.pi / 2).as_matrix(), np.zeros(3)])
    free = closest_points(rings(fixed=False), "a-b", HERE, pose)
    assert closest_points(library, "a-b", HERE, pose).d == pytest.approx(free.d, abs=1e-12)
    for moved in (turned, pose):
        for call in (closest_points, distance_minima):
            with pytest.raises(ModelgenError, match="fixed at the world frame"):
                call(library, "a-b", moved, pose)
            with pytest.raises(ModelgenError, match="fixed at the world frame"):
                call(library, "a-b", np.stack([HERE, moved]), pose)
