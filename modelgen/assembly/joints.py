"""Joints with their limits and springs: kinds (structure, generated) and parameters (numbers of the
instance)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from modelgen.assembly.contact_kinds import find_body
from modelgen.assembly.gears import check_gears
from modelgen.assembly.inputs_of_expressions import inputs_of_expressions
from modelgen.assembly.kind_list import KindList
from modelgen.assembly.masses import pose_numbers
from modelgen.joint.joint_kernels import held_row_count, inertial_row_count
from modelgen.joint.joint_limits import is_turn
from modelgen.model import JointEntry, JointKind, LimitEntry, LimitKind, LoadEntry, LoadKind
from modelgen.scene.joint_format import ARMATURE
from modelgen.scene.scene_types import Input, Joint, Scene, Vector

UNLIMITED = 1e30  # N or N m, in place of a limit that is not given
_ENDS = ((0, "min"), (0, "max"), (1, "y_min"), (1, "y_max"))  # coordinates and names of the bounds


@dataclass(frozen=True, slots=True)
class Joined:
    """Kinds, parameters, limits and springs of the joints of a scene."""

    joint_kinds: tuple[JointKind, ...]
    limit_kinds: tuple[LimitKind, ...]
    joints: tuple[JointEntry, ...]
    limits: tuple[LimitEntry, ...]
    springs: tuple[LoadEntry, ...]


def joined(
    scene: Scene, centres: Sequence[Vector], length: float, eta: int, loads: KindList[LoadKind]
) -> Joined:
    """The joints of the scene; angles are measured by `length`, m; the eta of limits starts at `eta`."""
    kinds: KindList[JointKind] = KindList()
    limit_kinds: KindList[LimitKind] = KindList()
    joints: list[JointEntry] = []
    limits: list[LimitEntry] = []
    springs: list[LoadEntry] = []
    for index, joint in enumerate(scene.joints):
        row = joints[-1].row + joints[-1].rows + joints[-1].inertial_rows if joints else 0
        a, b = (find_body(scene, name, f"{scene.source}: joint[{index}]") for name in joint.between)
        numbers = _parameters(joint, (centres[a], centres[b]), length)
        kind = kinds.index(_kind(joint, scene.inputs))
        rows = held_row_count(kinds.kinds[kind]), inertial_row_count(kinds.kinds[kind])
        armature = tuple(each for each in joint.armature if each)
        joints.append(JointEntry(joint.name, kind, a, b, row, *rows, joint.frames, numbers, armature))
        first = limits[-1].eta + limits[-1].room if limits else eta
        limits += _limits(joint, index, joints[-1], first, limit_kinds)
        if joint.is_sprung:
            spring = loads.index(LoadKind(f"{joint.kind}_spring", "joint_spring", (), joint=joint.kind))
            springs.append(LoadEntry(spring, (a, b), (*numbers, joint.stiffness, joint.damping, joint.rest)))
    check_gears(scene, joints, kinds.kinds, centres)
    springs += _actuators(scene, joints, loads)
    return Joined(kinds.kinds, limit_kinds.kinds, tuple(joints), tuple(limits), tuple(springs))


def _actuators(scene: Scene, joints: Sequence[JointEntry], loads: KindList[LoadKind]) -> list[LoadEntry]:
    """The loads of the actuators: parameters of the joint, gain, and limits where there are some."""
    named = {entry.name: (entry, joint) for entry, joint in zip(joints, scene.joints, strict=True)}
    found = []
    for actuator in scene.actuators:
        if actuator.joint not in named:
            continue  # of a part of the scene that is left out
        entry, joint = named[actuator.joint]
        limited = actuator.limits != (None, None)
        used = inputs_of_expressions(scene.inputs, (actuator.force,))
        kind = LoadKind(
            f"{joint.kind}_actuator", "actuator", (), (actuator.force.text,), joint=joint.kind,
            law=actuator.force, limited=limited, inputs=used,
        )  # fmt: skip
        low, high = actuator.limits
        ends = (-UNLIMITED if low is None else low, UNLIMITED if high is None else high) if limited else ()
        numbers = (*entry.geometry, actuator.gain, *ends)
        found.append(LoadEntry(loads.index(kind), (entry.a, entry.b), numbers))
    return found


def _kind(joint: Joint, inputs: Sequence[Input]) -> JointKind:
    if joint.motion is None:
        names = ARMATURE.get(joint.kind, ())
        of = tuple(name for name, each in zip(names, joint.armature, strict=False) if each)
        return JointKind("_".join((joint.kind, *of, *(["armature"] if of else []))), joint.kind, armature=of)
    used = inputs_of_expressions(inputs, (joint.motion,))
    return JointKind(f"{joint.kind}_moved", joint.kind, joint.motion, used)


def _parameters(joint: Joint, centres: tuple[Vector, Vector], length: float) -> tuple[float, ...]:
    """Both frames (12 each) from the centres of mass, the characteristic length, the kind's numbers."""
    frames = zip(joint.frames, centres, strict=True)
    return (*(x for frame, centre in frames for x in pose_numbers(frame, centre)), length, *joint.numbers)


def _limits(
    joint: Joint, index: int, entry: JointEntry, eta: int, kinds: KindList[LimitKind]
) -> list[LimitEntry]:
    found: list[LimitEntry] = []
    for (coordinate, end), bound in zip(_ENDS, (*joint.limits, *joint.limits_y), strict=True):
        if bound is None:
            continue
        room = int(is_turn(joint.kind))
        kind = kinds.index(LimitKind(f"{joint.kind}_{end}", joint.kind, end.endswith("max"), coordinate))
        at = eta + room * len(found)
        found.append(
            LimitEntry(
                f"{joint.name}:{end}", kind, index, entry.a, entry.b, at, room, joint.restitution,
                (*entry.geometry, bound),
            )
        )  # fmt: skip
    return found
