"""Joints of a MuJoCo model: hinges, slides and balls, with links between where a body has several."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.name_conversion import Names
from modelgen.importing.welded_bodies import (
    WORLD,
    RigidBody,
    attached,
    motion_at,
    pose_at,
    pose_in,
)
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose

LIGHT = 1e-6  # mass and inertia of a link between two joints of one body, against that body
KINDS = {0: "free", 1: "spherical", 2: "prismatic", 3: "revolute"}  # mjtJoint
OPPOSITE = -1 + 1e-12  # z of an axis that is -z


@dataclass(frozen=True, eq=False)
class ModelJoint:
    """One joint of the scene.

    Attributes:
        number: of the joint in the model.
        between: names of two bodies.
        frames: in each of them; the coordinate of the scene is that of the model.
        keys: limits, stiffness, damping, rest and armature, as scene files have them.
    """

    number: int
    name: str
    kind: str
    between: tuple[str, str]
    frames: tuple[Pose, Pose]
    keys: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Jointed:
    """The joints of a model, and the links between them that no body of the model is."""

    joints: tuple[ModelJoint, ...]
    links: tuple[RigidBody, ...]

    def by_number(self) -> dict[int, ModelJoint]:
        return {joint.number: joint for joint in self.joints}


def jointed(source: Compiled, bodies: Mapping[int, RigidBody], notes: Notes) -> Jointed:
    """The joints of all bodies."""
    names, links = Names(), Names()
    links.taken |= {body.name for body in bodies.values()} | {WORLD}
    joints: list[ModelJoint] = []
    between: list[RigidBody] = []
    for body in dict.fromkeys(bodies.values()):
        numbers = joints_of(source, body)
        if body.fixed or not numbers or _is_free(source, numbers, notes):
            continue
        on_world = bodies[int(source.model.body_parentid[body.members[0]])].fixed
        chain = [*_links(source, body, numbers, on_world, links), body]
        between += chain[:-1]
        joints += _chain(source, bodies, numbers, chain, names, notes)
        if len(chain) > 1:
            notes.approximate(
                f"body {body.name!r} has {len(numbers)} joints: between them are links of {LIGHT:g} of its "
                "mass and inertia"
            )
    return Jointed(tuple(joints), tuple(between))


def joints_of(source: Compiled, body: RigidBody) -> list[int]:
    """Numbers of the joints of a body, in the order in which they move it."""
    model, first = source.model, body.members[0]
    start = int(model.body_jntadr[first])
    return list(range(start, start + int(model.body_jntnum[first])))


def _is_free(source: Compiled, numbers: list[int], notes: Notes) -> bool:
    free = KINDS[int(source.model.jnt_type[numbers[0]])] == "free"
    if free:
        _omit_free(source, numbers[0], notes)
    return free


def _omit_free(source: Compiled, number: int, notes: Notes) -> None:
    model, told = source.model, source.told("joint", number)
    first = int(model.jnt_dofadr[number])
    for values, what in ((model.dof_damping, "damping"), (model.dof_armature, "armature")):
        if np.any(values[first : first + 6]):
            notes.omit(f"{what} of the free {told}")
    if model.jnt_stiffness[number]:
        notes.omit(f"stiffness of the free {told}")


def _links(
    source: Compiled, body: RigidBody, numbers: list[int], on_world: bool, names: Names
) -> Iterator[RigidBody]:
    """A link after each joint but the last, where the joints before it have put it.

    One that does not turn, because slides alone carry it, has the inertia of the body: its joints are then
    well conditioned, and no motion depends on it.
    """
    first, inertia = body.members[0], _about_joints(source, body, numbers)
    for k in range(1, len(numbers)):
        turns = not on_world or any(not _slides(source, number) for number in numbers[:k])
        at = _with_joints_at_rest(source, numbers[k:])
        velocity, spin = motion_at(at, first, body.centre)
        yield replace(
            body,
            name=names.of(f"{body.name}_{source.name('joint', numbers[k - 1]) or k}", body.name),
            members=(),
            pose=pose_at(at, first),
            mass=LIGHT * body.mass,
            inertia=(LIGHT if turns else 1.0) * inertia,
            velocity=velocity,
            spin=spin,
        )


def _slides(source: Compiled, number: int) -> bool:
    return KINDS[int(source.model.jnt_type[number])] == "prismatic"


def _about_joints(source: Compiled, body: RigidBody, numbers: list[int]) -> Array:
    """(3, 3): the inertia of a body with its mass at the farthest of its joints."""
    model, arms = source.model, [0.0]
    for k in numbers:
        if _slides(source, k):
            arms.append(float(abs(model.qpos0[model.jnt_qposadr[k]])))
        else:
            arms.append(float(np.linalg.norm(model.jnt_pos[k] - body.centre)))
    return np.asarray(body.inertia + body.mass * max(arms) ** 2 * np.eye(3))


def _with_joints_at_rest(source: Compiled, numbers: list[int]) -> Compiled:
    """The model with some joints where the file draws its bodies."""
    model, data = source.model, source.mj.MjData(source.model)
    data.qpos[:], data.qvel[:] = source.data.qpos, source.data.qvel
    for number in numbers:
        q, u = int(model.jnt_qposadr[number]), int(model.jnt_dofadr[number])
        width = 4 if KINDS[int(model.jnt_type[number])] == "spherical" else 1
        data.qpos[q : q + width] = model.qpos0[q : q + width]
        data.qvel[u : u + (3 if width == 4 else 1)] = 0
    source.mj.mj_forward(model, data)
    return replace(source, data=data)


def _chain(
    source: Compiled,
    bodies: Mapping[int, RigidBody],
    numbers: list[int],
    chain: list[RigidBody],
    names: Names,
    notes: Notes,
) -> Iterator[ModelJoint]:
    model, first = source.model, chain[-1].members[0]
    above = int(model.body_parentid[first])
    parent = bodies[above]
    outer = pose_at(source, above) if parent.fixed else pose_in(source, above, parent.members[0])
    into = compose(outer, attached(model.body_pos[first], model.body_quat[first]))
    before = WORLD if parent.fixed else parent.name
    for number, after in zip(numbers, chain, strict=True):
        kind = KINDS[int(model.jnt_type[number])]
        place = chain[-1].centre if kind == "prismatic" else model.jnt_pos[number]  # a slide may be anywhere
        frame = _along(place, model.jnt_axis[number])
        name = names.of(source.name("joint", number), f"{after.name}_joint")
        keys = {} if kind == "spherical" else _keys(source, number)
        armature = _linear(source.model, "dof_armature", int(model.jnt_dofadr[number]))
        keys |= {"armature": armature} if armature else {}
        frames = (compose(into, frame), compose(frame, _reference(source, number, kind)))
        yield ModelJoint(number, name, kind, (before, after.name), frames, keys)
        _note(source, number, kind, parent.fixed, notes)
        before, into = after.name, Pose()


def _along(position: Array, axis: Array) -> Pose:
    """The frame at a position whose z axis is the axis, turned from z on the shortest way."""
    x, y, z = axis / np.linalg.norm(axis)
    half = np.array([1 + z, -y, x, 0.0]) if z > OPPOSITE else np.array([0.0, 1.0, 0.0, 0.0])
    return attached(position, half)


def _reference(source: Compiled, number: int, kind: str) -> Pose:
    """The second frame from the first where the file draws the body: at the reference of the coordinate."""
    q = float(source.model.qpos0[source.model.jnt_qposadr[number]])
    if kind == "revolute":
        return Pose(quaternion=(float(np.cos(q / 2)), 0.0, 0.0, float(np.sin(q / 2))))
    return Pose((0.0, 0.0, q)) if kind == "prismatic" else Pose()


def _keys(source: Compiled, number: int) -> dict[str, Any]:
    model = source.model
    keys: dict[str, Any] = {}
    if model.jnt_limited[number] and not source.is_disabled("LIMIT"):
        keys["limits"] = [float(each) for each in model.jnt_range[number]]
    stiffness, damping = _linear(model, "jnt_stiffness", number), _damping(model, number)
    if stiffness > 0 and not source.is_disabled("SPRING"):
        keys["stiffness"] = stiffness
        keys["rest"] = float(model.qpos_spring[model.jnt_qposadr[number]])
    if damping > 0 and not source.is_disabled("DAMPER"):
        keys["damping"] = damping
    return {key: value for key, value in keys.items() if key != "rest" or value}


def _linear(model: Any, name: str, number: int) -> float:
    return float(np.atleast_1d(getattr(model, name)[number])[0])


def _damping(model: Any, number: int) -> float:
    return float(np.atleast_1d(model.dof_damping[model.jnt_dofadr[number]])[0])


def _note(source: Compiled, number: int, kind: str, on_world: bool, notes: Notes) -> None:
    """Note what of a joint the scene has not."""
    model, told = source.model, source.told("joint", number)
    u = int(model.jnt_dofadr[number])
    if model.jnt_limited[number] and kind == "spherical":
        notes.omit(f"limit of the whole rotation of the ball {told}")
    elif model.jnt_limited[number]:
        notes.approximate("limits of joints are rigid, and give nothing back")
    if model.dof_frictionloss[u]:
        notes.omit(f"dry friction of {told}, {_linear(model, 'dof_frictionloss', u):g}")
    if kind == "spherical" and model.jnt_stiffness[number]:
        notes.omit(f"stiffness of the ball {told}")
    if kind == "spherical" and _damping(model, number) and not on_world:
        notes.omit(f"damping of the ball {told}")
    for name, what in (("jnt_stiffnesspoly", "stiffness"), ("dof_dampingpoly", "damping")):
        values = getattr(model, name, None)
        if values is not None and np.any(values[number if name.startswith("jnt") else u]):
            notes.omit(f"powers of the {what} of {told}")
