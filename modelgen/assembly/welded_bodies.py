"""Bodies that are fixed, or held together by welds, and where each stands among them."""

from __future__ import annotations

from collections.abc import Sequence

from modelgen.geometry.face_regions import to_axes
from modelgen.model import BodyMotion
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose, Scene

FIXED = -1  # in place of a body: all that are fixed

Stand = tuple[int, Pose]  # of a body: the first body to which it is welded, or FIXED, and where it is on that


def stands_of(scene: Scene, motions: Sequence[BodyMotion]) -> list[Stand]:
    """Where each body stands: fixed ones in the world, others on the first to which welds join them."""
    number = {body.name: k for k, body in enumerate(scene.bodies)}
    welds: dict[int, list[tuple[int, Pose]]] = {}
    for joint in scene.joints:
        if joint.kind == "weld":
            (a, b), (of_a, of_b) = (number[name] for name in joint.between), joint.frames
            welds.setdefault(a, []).append((b, compose(of_a, to_axes(of_b, Pose()))))
            welds.setdefault(b, []).append((a, compose(of_b, to_axes(of_a, Pose()))))
    found: dict[int, Stand] = {}
    fixed = [k for k, motion in enumerate(motions) if motion == "fixed"]
    for first in (*fixed, *range(len(motions))):
        if first in found:
            continue
        is_fixed = motions[first] == "fixed"
        found[first] = (FIXED, scene.bodies[first].pose) if is_fixed else (first, Pose())
        left = [first]
        while left:
            body = left.pop()
            for other, pose in welds.get(body, ()):
                if other not in found:
                    found[other] = (found[body][0], compose(found[body][1], pose))
                    left.append(other)
    return [found[k] for k in range(len(motions))]
