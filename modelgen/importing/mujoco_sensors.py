"""Sensors of a MuJoCo model that a scene has too."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_actuators import site_in
from modelgen.importing.mujoco_compilation import Compiled
from modelgen.importing.mujoco_joints import ModelJoint
from modelgen.importing.name_conversion import expression_names
from modelgen.importing.scene_writing import Section, vector
from modelgen.importing.welded_bodies import RigidBody, pose_in
from modelgen.scene.scene_types import Pose

OF_JOINT = {"JOINTPOS": "coordinate", "JOINTVEL": "rate"}
OF_POINT = {"FRAMEPOS": "position", "FRAMELINVEL": "velocity", "FRAMELINACC": "acceleration"}
OF_BODY = {
    "FRAMEQUAT": "orientation",
    "FRAMEANGVEL": "angular_velocity",
    "FRAMEANGACC": "angular_acceleration",
}


def sensors(
    source: Compiled, bodies: Mapping[int, RigidBody], joints: Mapping[int, ModelJoint], notes: Notes
) -> list[Section]:
    """The tables of sensors of joints, bodies and sites; notes on the others."""
    names, found = expression_names(), []
    for number in range(source.model.nsensor):
        table = _sensor(source, number, bodies, joints)
        if table is None:
            notes.omit(f"{source.told('sensor', number)}, a {_kind(source, number).lower()}")
        else:
            name = names.of(source.name("sensor", number), f"sensor{number}")
            found.append(Section("sensor", {"name": name, **table}))
    return found


def _kind(source: Compiled, number: int) -> str:
    value = int(source.model.sensor_type[number])
    return str(source.mj.mjtSensor(value).name).removeprefix("mjSENS_")


def _sensor(
    source: Compiled, number: int, bodies: Mapping[int, RigidBody], joints: Mapping[int, ModelJoint]
) -> dict[str, Any] | None:
    model, kind = source.model, _kind(source, number)
    target = int(model.sensor_objid[number])
    if kind in OF_JOINT:
        joint = joints.get(target)
        return None if joint is None else {"of": f"{joint.name}.{OF_JOINT[kind]}"}
    placed = _placed(source, number, target, bodies)
    if placed is None or model.sensor_refid[number] >= 0:
        return None
    body, frame = placed
    if body.fixed:
        return None
    point = {"point": vector(frame.position)}
    if kind in OF_POINT:
        return {"of": f"{body.name}.{OF_POINT[kind]}", **point}
    turned = any(vector(frame.quaternion)[1:])
    if kind == "ACCELEROMETER" and not turned:
        return {"of": f"{body.name}.proper_acceleration", **point}
    if kind in OF_BODY and (kind != "FRAMEQUAT" or not turned):
        return {"of": f"{body.name}.{OF_BODY[kind]}"}
    return None


def _placed(
    source: Compiled, number: int, target: int, bodies: Mapping[int, RigidBody]
) -> tuple[RigidBody, Pose] | None:
    """The rigid body that a sensor is on, and the frame of what is measured there."""
    mj, model = source.mj, source.model
    match int(model.sensor_objtype[number]):
        case mj.mjtObj.mjOBJ_SITE:
            body = bodies[int(model.site_bodyid[target])]
            return body, site_in(source, target, body)
        case mj.mjtObj.mjOBJ_XBODY:
            body = bodies[target]
            return body, Pose() if body.fixed else pose_in(source, target, body.members[0])
        case mj.mjtObj.mjOBJ_BODY:
            body = bodies[target]
            if body.fixed or len(body.members) > 1:
                return None
            x, y, z = (float(each) for each in model.body_ipos[target])
            w, i, j, k = (float(each) for each in model.body_iquat[target])
            return body, Pose((x, y, z), (w, i, j, k))
    return None
