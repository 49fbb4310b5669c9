"""Welded bodies of a MuJoCo model as one rigid body with its mass and state; poses and motions of members."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.name_conversion import Names
from modelgen.rotations import rotation_of, unit
from modelgen.scene.pose_arithmetic import compose, to_inner
from modelgen.scene.quaternions import conjugate, product
from modelgen.scene.scene_types import Pose

WORLD = "world"
GROUND = "ground"  # the body of what the world itself has


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Bodies of the model that are welded together, in axes of the first.

    Attributes:
        members: numbers of bodies of the model.
        pose: of the axes in the world at the start.
        mass: kg; 0 if fixed.
        centre: (3,) m, of mass.
        inertia: (3, 3) kg m^2, about the centre.
        velocity, spin: (3,) of the centre, m/s, and rad/s, world axes.
    """

    name: str
    fixed: bool
    members: tuple[int, ...]
    pose: Pose
    mass: float
    centre: Array
    inertia: Array
    velocity: Array
    spin: Array

    def inside(self, placed: Pose) -> Pose:
        """A pose in the world at the start as the body sees it."""
        back = conjugate(self.pose.quaternion)
        x, y, z = (float(each) for each in to_inner(self.pose, placed.position))
        return Pose((x, y, z), unit(product(back, placed.quaternion)))


def rigid_bodies(source: Compiled) -> dict[int, RigidBody]:
    """By body of the model, the rigid body that it belongs to; what rests has one for each of its own."""
    model, names = source.model, Names()
    names.taken.add(WORLD)
    owners = {b: b if model.body_weldid[b] == 0 else int(model.body_weldid[b]) for b in range(model.nbody)}
    found: dict[int, RigidBody] = {}
    for first in dict.fromkeys(owners.values()):
        members = tuple(b for b, owner in owners.items() if owner == first)
        name = names.of(_written(source, first), f"body{first}")
        found |= dict.fromkeys(members, _rigid(source, name, members))
    return found


def pose_at(source: Compiled, body: int) -> Pose:
    """The pose of a body's axes in the world at the state of the data."""
    x, y, z = (float(each) for each in source.data.xpos[body])
    return Pose((x, y, z), unit(source.data.xquat[body]))


def motion_at(source: Compiled, body: int, point: Array) -> tuple[Array, Array]:
    """Velocity of a point (3,) of a body, m/s, and its angular velocity, rad/s, world axes."""
    twist = np.zeros(6)
    source.mj.mj_objectVelocity(source.model, source.data, source.mj.mjtObj.mjOBJ_XBODY, body, twist, 0)
    spin, velocity = twist[:3], twist[3:]
    arm = rotation_of(pose_at(source, body).quaternion) @ point
    return velocity + np.cross(spin, arm), spin


def attached(position: Array, quaternion: Array) -> Pose:
    x, y, z = (float(each) for each in position)
    return Pose((x, y, z), unit(quaternion))


def _written(source: Compiled, body: int) -> str:
    return GROUND if body == 0 else source.name("body", body)


def _rigid(source: Compiled, name: str, members: tuple[int, ...]) -> RigidBody:
    model, first = source.model, members[0]
    fixed, pose = bool(model.body_weldid[first] == 0), pose_at(source, first)
    zero = np.zeros(3)
    if fixed:
        return RigidBody(name, True, members, pose, 0.0, zero, np.zeros((3, 3)), zero, zero)
    mass, centre, inertia = _inertia(source, members, pose)
    velocity, spin = motion_at(source, first, centre)
    return RigidBody(name, False, members, pose, mass, centre, inertia, velocity, spin)


def _inertia(source: Compiled, members: tuple[int, ...], pose: Pose) -> tuple[float, Array, Array]:
    """Mass, centre (3,) and inertia (3, 3) about it of bodies together, in the axes of a pose."""
    model = source.model
    parts = []
    for body in members:
        local = compose(
            pose_in(source, body, members[0]), attached(model.body_ipos[body], model.body_iquat[body])
        )
        turn = rotation_of(local.quaternion)
        parts.append(
            (float(model.body_mass[body]), np.array(local.position), turn * model.body_inertia[body] @ turn.T)
        )
    mass = sum(m for m, _, _ in parts)
    centre = np.asarray(sum(m * at for m, at, _ in parts) / mass)
    inertia = np.zeros((3, 3))
    for m, at, own in parts:
        arm = at - centre
        inertia += own + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, centre, inertia


def pose_in(source: Compiled, body: int, owner: int) -> Pose:
    """The pose of a body in the axes of one that it is welded to, through the bodies between."""
    model, found = source.model, Pose()
    while body != owner:
        found = compose(attached(model.body_pos[body], model.body_quat[body]), found)
        body = int(model.body_parentid[body])
    return found
