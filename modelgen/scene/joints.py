"""Joints: frames put into their bodies, what follows from the start, and what cannot be."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import cos, hypot, pi, sin
from typing import Any

import numpy as np

from modelgen.name_suggestions import nearest
from modelgen.scene.expression import Expression
from modelgen.scene.finite_expressions import finite
from modelgen.scene.plausibility_remarks import remark_on_angles
from modelgen.scene.pose_arithmetic import frame
from modelgen.scene.pose_input import read_pose
from modelgen.scene.prescribed_motions import check_motion, motion_names, motion_start
from modelgen.scene.quaternions import conjugate, product, rows_of, turned
from modelgen.scene.scene_types import Body, Joint, Pose
from modelgen.scene.source_location import Place

WORLD, PLANAR = "world", "planar"
TURNING = ("revolute", "universal")  # kinds whose first coordinate is an angle that may turn on
_OPTIONAL = ("limits", "limits_y", "restitution", "stiffness", "damping", "rest")
Written = Iterable[tuple[Place, Mapping[str, Any]]]


def with_world(bodies: tuple[Body, ...], read: Written) -> tuple[Body, ...]:
    """The bodies; also one at rest named `world` if there is none, and a joint or a planar body needs it."""
    named = any(WORLD in values["between"] for _, values in read) or any(each.normal for each in bodies)
    if not named or any(body.name == WORLD for body in bodies):
        return bodies
    return (*bodies, Body(WORLD, "fixed"))


def joints(read: Written, bodies: Mapping[str, Body]) -> tuple[Joint, ...]:
    """The joints, each with its frame in both bodies, those of planar bodies first; raises SceneError."""
    found = {joint.name: joint for joint in _planar_joints(bodies)}
    for place, values in read:
        joint = _joint(values, bodies, place)
        if joint.name in found:
            raise place.key("name").error(
                f"the name {joint.name!r} a second time", "each joint has a name of its own", "name both"
            )
        found[joint.name] = joint
    return tuple(found.values())


def _planar_joints(bodies: Mapping[str, Body]) -> Iterator[Joint]:
    """The joint that keeps each planar body in its plane."""
    for body in bodies.values():
        if body.normal is not None:
            normal = np.array(body.normal)
            across = np.eye(3)[np.argmin(np.abs(normal))]
            across = across - (across @ normal) * normal
            plane = frame(body.pose.position, across / np.linalg.norm(across), normal)
            name = "_".join((WORLD, body.name, PLANAR))
            yield Joint(name, PLANAR, (WORLD, body.name), (plane, _inside(body.pose, plane)))


def pose_at_start(body: Body, place: Place) -> Pose:
    """Pose of the body's axes in the world at t = 0; of a driven body its pose and its path."""
    if body.path is None:
        return body.pose
    start = motion_start(place)
    x, y, z = (finite(each, start, place) for each in body.path.position)
    vector = [finite(each, start, place) for each in body.path.rotation_vector]
    angle = hypot(*vector)
    part = sin(angle / 2) / angle if angle else 0.0
    turn = (cos(angle / 2), part * vector[0], part * vector[1], part * vector[2])
    a, b, c = body.pose.position
    return Pose((a + x, b + y, c + z), product(turn, body.pose.quaternion))


def _joint(values: Mapping[str, Any], bodies: Mapping[str, Body], place: Place) -> Joint:
    _check_between(values["between"], bodies, place.key("between"))
    first, second = (pose_at_start(bodies[name], place) for name in values["between"])
    frames = _frames(values, first, second, place)
    motion = values.get("motion")
    name = values["name"] or "_".join((*values["between"], values["kind"]))
    joint = Joint(
        name,
        values["kind"],
        values["between"],
        frames,
        _numbers(values, (first, second), frames, place),
        motion=None if motion is None else _motion(motion, place.key("motion")),
        armature=_armature(values.get("armature", 0.0)),
        **{key: values[key] for key in _OPTIONAL if key in values},
    )
    _check_limits(joint, place)
    _check_idle(joint, place)
    if joint.kind in TURNING:
        remark_on_angles(joint.limits, place.key("limits"))
    return joint


def _armature(given: float | tuple[float, ...]) -> tuple[float, ...]:
    """Of each rate that may have one; empty where there is none."""
    each = given if isinstance(given, tuple) else (given,)
    return each if any(each) else ()


def _motion(text: str, place: Place) -> Expression:
    motion = place.expression(text, motion_names(place))
    check_motion(motion, place)
    return motion


def _frames(values: Mapping[str, Any], first: Pose, second: Pose, place: Place) -> tuple[Pose, Pose]:
    if values["frames"] is None:
        placed = read_pose(values, place)
        return _inside(first, placed), _inside(second, placed)
    at = place.key("frames")
    a, b = (read_pose(each, at.item(index)) for index, each in enumerate(values["frames"]))
    return a, b


def _inside(outer: Pose, placed: Pose) -> Pose:
    """A frame of the world as a body at `outer` sees it."""
    back = conjugate(outer.quaternion)
    x, y, z = (a - b for a, b in zip(placed.position, outer.position, strict=True))
    return Pose(turned(back, (x, y, z)), product(back, placed.quaternion))


def _numbers(
    values: Mapping[str, Any], bodies: Sequence[Pose], frames: Sequence[Pose], place: Place
) -> tuple[float, ...]:
    match values["kind"]:
        case "screw":
            if not values["lead"]:
                raise place.key("lead").error("a lead of 0", "any other is allowed", "use a revolute joint")
            return (values["lead"],)
        case "distance":
            return (_distance(values, place),)
        case "gear":
            return (*_teeth(values["teeth"], place), *_starts(bodies, frames))
    return ()


def _distance(values: Mapping[str, Any], place: Place) -> float:
    """That at t = 0 where a motion gives it; no row depends on it then."""
    if (values["distance"] is None) == (values["motion"] is None):
        found = "neither a distance nor a motion" if values["motion"] is None else "a distance and a motion"
        raise place.error(
            found, "one of the two is allowed", 'write distance = 0.5 or motion = "0.5 + 0.1*t"'
        )
    return 0.0 if values["distance"] is None else float(values["distance"])


def _teeth(teeth: Sequence[int], place: Place) -> tuple[float, float]:
    if 0 in teeth:
        raise place.key("teeth").error("a wheel without teeth", "whole numbers but 0 are allowed", "")
    return float(teeth[0]), float(teeth[1])


def _starts(bodies: Sequence[Pose], frames: Sequence[Pose]) -> tuple[float, ...]:
    """The rotations (9 each, column by column) of both frames in the world at t = 0."""
    turns = [product(body.quaternion, frame.quaternion) for body, frame in zip(bodies, frames, strict=True)]
    return tuple(rows_of(turn)[i][j] for turn in turns for j in range(3) for i in range(3))


def _check_between(names: tuple[str, str], bodies: Mapping[str, Body], place: Place) -> None:
    for name in names:
        if name not in bodies:
            others = [each for each in bodies if each != WORLD]
            allowed = "bodies: " + ", ".join([*others[:20], WORLD])
            raise place.error(f"no body named {name!r}", allowed, nearest(name, (*others, WORLD)))
    if names[0] == names[1]:
        raise place.error(f"the body {names[0]!r} with itself", "", "name two different bodies")
    if "dynamic" not in (bodies[name].motion for name in names):
        found = " and ".join(f"{name!r} ({bodies[name].motion})" for name in names)
        raise place.error(found, "one of the two must be dynamic", "remove the joint or free a body")


def _check_idle(joint: Joint, place: Place) -> None:
    """Raise SceneError for keys of limits or a spring that the kind of joint does not have."""
    unlimited = joint.limits == joint.limits_y == (None, None)
    if joint.restitution and unlimited:
        remedy = "add limits = [least, largest], or remove it"
        raise place.key("restitution").error(f"{joint.restitution:g} without limits", "", remedy)
    if joint.rest and not joint.stiffness:
        remedy = "add stiffness, or remove it"
        raise place.key("rest").error(f"{joint.rest:g} without stiffness", "", remedy)


def _check_limits(joint: Joint, place: Place) -> None:
    for key, (low, high) in (("limits", joint.limits), ("limits_y", joint.limits_y)):
        if low is not None and high is not None and not low < high:
            remedy = "write the least first"
            raise place.key(key).error(f"{low:g} to {high:g}", "the first is the smaller one", remedy)
    if joint.kind == "spherical" and not all(0 < each < pi for each in joint.limits if each is not None):
        found, allowed = "a tilt that is no angle of a cone", "between 0 and pi, ends excluded, are allowed"
        raise place.key("limits").error(found, allowed, 'write limits = ["none", 0.5]')
    if joint.kind == "rope" and joint.limits == (None, None):
        raise place.key("limits").error("a rope without limits", "", 'write limits = ["none", length]')
    if joint.motion is not None and (joint.limits != (None, None) or joint.is_sprung or joint.armature):
        raise place.key("motion").error(
            "a given motion together with limits, stiffness, damping or armature",
            "a coordinate whose motion is given has none of them",
            "remove one",
        )
