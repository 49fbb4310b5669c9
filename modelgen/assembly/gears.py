"""What a gear couples: the turns of two bodies, which the other joints must permit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from modelgen.errors import SceneError
from modelgen.joint.joint_kernels import rows_kernel
from modelgen.model import JointEntry, JointKind
from modelgen.notation import SETTING_SIZE
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, Scene, Vector

Array = np.ndarray[Any, Any]
TURNS, DEPENDENT = 1e-6, 1e-9  # a share of a motion of norm 1 that is a turn; singular values of J that are 0


def check_gears(
    scene: Scene, joints: Sequence[JointEntry], kinds: Sequence[JointKind], centres: Sequence[Vector]
) -> None:
    """Raises SceneError for a gear on a body that the other joints keep from turning about the gear's axis: a
    gear couples two turns, and would hold the other body fast."""
    gears = [index for index, joint in enumerate(joints) if kinds[joint.kind].kind == "gear"]
    if not gears:
        return
    free = _permitted_motions(scene, joints, kinds, centres)
    for index in gears:
        gear = joints[index]
        for body, frame in zip((gear.a, gear.b), gear.frames, strict=True):
            own = scene.bodies[body]
            spin = rotation_of(frame.quaternion)[:, 2] @ free[6 * body + 3 : 6 * body + 6]
            if own.motion == "driven" or np.abs(spin).max(initial=0.0) > TURNS:
                continue
            raise SceneError(
                f"{scene.source}: joint[{index}] (joint {gear.name!r})",
                f"the body {own.name!r} cannot turn about the z axis of the gear",
                "a gear couples the turns of two bodies",
                "join the body by one that has that angle, as revolute; a gear moves no rack",
            )


def _permitted_motions(
    scene: Scene, joints: Sequence[JointEntry], kinds: Sequence[JointKind], centres: Sequence[Vector]
) -> Array:
    """(6 bodies, k) orthonormal: velocities of the bodies at the start, spins in their axes, that all joints
    but gears permit; zero of bodies that no force moves."""
    from scipy.linalg import null_space  # slow to import, and needed by gears alone

    n = 6 * len(scene.bodies)
    rows = [np.eye(n)[6 * k : 6 * k + 6] for k, body in enumerate(scene.bodies) if body.motion != "dynamic"]
    poses = [_start_pose(body, centre) for body, centre in zip(scene.bodies, centres, strict=True)]
    for joint in joints:
        kind = kinds[joint.kind]
        if kind.kind == "gear" or not joint.rows:
            continue
        settings = [np.zeros(SETTING_SIZE * len(kind.inputs))] if kind.inputs else []
        still = np.zeros(6)
        _, J, *_ = rows_kernel(kind)(
            0.0, poses[joint.a], still, poses[joint.b], still, joint.parameters, *settings
        )
        held = np.array(J).reshape(-1, 12)[: joint.rows]
        own = np.zeros((joint.rows, n))
        for body, columns in ((joint.a, held[:, :6]), (joint.b, held[:, 6:])):
            own[:, 6 * body : 6 * body + 6] = columns
        rows.append(own)
    return np.asarray(null_space(np.vstack([np.zeros((1, n)), *rows]), rcond=DEPENDENT))


def _start_pose(body: Body, centre: Vector) -> Array:
    """(12,) of the axes about the centre of mass."""
    R = rotation_of(body.pose.quaternion)
    return np.array([*(np.array(body.pose.position) + R @ np.array(centre)), *R.ravel(order="F")])
