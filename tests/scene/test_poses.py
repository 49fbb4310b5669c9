"""Poses compose, invert and survive the conversion to matrices; quaternions agree with SciPy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from modelgen.rotations import quaternion_of, quaternions_of, rotation_of
from modelgen.scene.pose_arithmetic import compose, frame, to_inner, to_outer
from modelgen.scene.scene_types import Pose


@given(st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(x * x for x in q) > 1e-2))
def test_poses_compose_and_invert(q: tuple[float, float, float, float]) -> None:
    unit = tuple(x / np.linalg.norm(q) for x in q)
    pose = Pose((1.0, -2.0, 0.5), unit)  # type: ignore[arg-type]
    x = np.array([0.3, 0.2, -1.0])
    np.testing.assert_allclose(to_inner(pose, to_outer(pose, x)), x, atol=1e-14)
    np.testing.assert_allclose(
        to_outer(compose(pose, pose), x), to_outer(pose, to_outer(pose, x)), atol=2e-14
    )
    R = rotation_of(pose.quaternion)
    np.testing.assert_allclose(rotation_of(quaternion_of(R)), R, atol=1e-14)
    np.testing.assert_allclose(rotation_of(frame([0, 0, 0], R[:, 0], R[:, 2]).quaternion), R, atol=1e-14)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1e-300, 1e-17, 1e-9, 1e-4, 1e-2, 1.0]))
def test_quaternions_of_many_matrices_are_those_of_scipy(seed: int, off: float) -> None:
    """Also near half turns about the axes, where three of the four components vanish."""
    rng = np.random.default_rng(seed)
    q = np.vstack([rng.normal(size=(8, 4)), np.eye(4) + off * rng.normal(size=(4, 4))])
    matrices = Rotation.from_quat(q).as_matrix().reshape(3, 4, 3, 3)
    expected = np.roll(Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat(), 1, axis=1)
    found = quaternions_of(matrices).reshape(-1, 4)
    np.testing.assert_allclose(np.abs((found * expected).sum(axis=1)), 1, atol=1e-15)
    assert (found[:, 0] >= 0).all()
    np.testing.assert_allclose([rotation_of(each) for each in found], matrices.reshape(-1, 3, 3), atol=2e-15)
