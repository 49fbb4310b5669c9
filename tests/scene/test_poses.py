"""Poses compose, invert and survive the way through matrices."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from modelgen.scene.poses import compose, frame, quaternion_of, rotation_of, to_inner, to_outer
from modelgen.scene.types import Pose


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
