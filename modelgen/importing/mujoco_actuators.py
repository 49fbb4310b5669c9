"""Actuators of a MuJoCo model as inputs and as forces along joints or at sites."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.mujoco_joints import ModelJoint
from modelgen.importing.name_conversion import expression_names
from modelgen.importing.scene_writing import Section, rounded, vector
from modelgen.importing.welded_bodies import RigidBody, attached, pose_at, pose_in
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose

PART = "actuators"


@dataclass(frozen=True, eq=False)
class Law:
    """The scalar force of an actuator: gain u + constant + by_length length + by_rate rate, within limits."""

    gain: float
    constant: float
    by_length: float
    by_rate: float
    limits: tuple[float, float] | None

    @property
    def is_open(self) -> bool:
        return not self.by_length and not self.by_rate


@dataclass
class Actuated:
    """Tables of inputs, actuators and forces."""

    sections: list[Section] = field(default_factory=list)
    inputs: list[Section] = field(default_factory=list)


def actuated(
    source: Compiled, bodies: Mapping[int, RigidBody], joints: Mapping[int, ModelJoint], notes: Notes
) -> list[Section]:
    """The tables of all actuators: their inputs first."""
    if source.is_disabled("ACTUATION"):
        return []
    names, found = expression_names(), Actuated()
    for number in range(source.model.nu):
        _add(
            source,
            number,
            bodies,
            joints,
            (names.of(source.name("actuator", number), f"u{number}"), found),
            notes,
        )
    return [*found.inputs, *found.sections]


def _add(
    source: Compiled,
    number: int,
    bodies: Mapping[int, RigidBody],
    joints: Mapping[int, ModelJoint],
    given: tuple[str, Actuated],
    notes: Notes,
) -> None:
    mj, model, (name, found) = source.mj, source.model, given
    told, law = source.told("actuator", number), _law(source, number)
    if law is None:
        notes.refuse(PART, f"{told} has activation dynamics, a muscle or a gain that varies")
        return
    kind, target = int(model.actuator_trntype[number]), model.actuator_trnid[number]
    gear = np.array(model.actuator_gear[number], dtype=float)
    moved = _moved(source, kind, int(target[0]), joints)
    if moved and (law.is_open or len(moved) == 1):
        for joint, share in moved:
            found.sections.append(_along(source, joint, law, share * float(gear[0]), name))
    elif kind == mj.mjtTrn.mjTRN_SITE and law.is_open and _is_steady(source, int(target[1])):
        found.sections += _at_site(source, bodies, (int(target[0]), int(target[1])), _text(law, name), gear)
    else:
        notes.refuse(PART, f"{told} acts neither along a joint nor as a force at a site")
        return
    found.inputs.append(_input(source, number, name))


def _moved(
    source: Compiled, kind: int, target: int, joints: Mapping[int, ModelJoint]
) -> list[tuple[ModelJoint, float]]:
    """Joints that an actuator acts along, with their parts in its length: of a joint, or a fixed tendon."""
    mj, model = source.mj, source.model
    parts: list[tuple[int, float]] = []
    if kind in (mj.mjtTrn.mjTRN_JOINT, mj.mjtTrn.mjTRN_JOINTINPARENT):
        parts = [(target, 1.0)]
    elif kind == mj.mjtTrn.mjTRN_TENDON:
        first, count = int(model.tendon_adr[target]), int(model.tendon_num[target])
        if all(int(model.wrap_type[k]) == mj.mjtWrap.mjWRAP_JOINT for k in range(first, first + count)):
            parts = [
                (int(model.wrap_objid[k]), float(model.wrap_prm[k])) for k in range(first, first + count)
            ]
    found = [(joints[number], share) for number, share in parts if number in joints]
    coordinates = all(joint.kind != "spherical" for joint, _ in found)
    return found if coordinates and len(found) == len(parts) else []


def _law(source: Compiled, number: int) -> Law | None:
    mj, model = source.mj, source.model
    gains, biases = model.actuator_gainprm[number], model.actuator_biasprm[number]
    if int(model.actuator_dyntype[number]) != mj.mjtDyn.mjDYN_NONE:
        return None
    if int(model.actuator_gaintype[number]) != mj.mjtGain.mjGAIN_FIXED:
        return None
    low, high = (float(each) for each in model.actuator_forcerange[number])
    limits = (low, high) if model.actuator_forcelimited[number] else None
    if int(model.actuator_biastype[number]) == mj.mjtBias.mjBIAS_NONE:
        biases = np.zeros(3)
    elif int(model.actuator_biastype[number]) != mj.mjtBias.mjBIAS_AFFINE:
        return None
    constant, by_length, by_rate = (float(each) for each in biases[:3])
    return Law(float(gains[0]), constant, by_length, by_rate, limits)


def _is_steady(source: Compiled, site: int) -> bool:
    """Whether a reference of a site is none, or at rest."""
    model = source.model
    return site < 0 or model.body_weldid[model.site_bodyid[site]] == 0


def linear_text(terms: Sequence[tuple[float, str]]) -> str:
    """The sum of coefficients times names, without zeros and ones; the name may be empty."""
    parts = []
    for coefficient, name in terms:
        if coefficient == 0:
            continue
        number = repr(rounded(coefficient))
        parts.append(number if not name else name if coefficient == 1 else f"{number}*{name}")
    return " + ".join(parts).replace("+ -", "- ") or "0"


def _text(law: Law, name: str) -> str:
    """The force of a law that depends on its input alone, within its limits."""
    text = linear_text([(law.gain, name), (law.constant, "")])
    if law.limits is None:
        return text
    low, high = (repr(rounded(each)) for each in law.limits)
    return f"max({low}, min({high}, {text}))"


def _along(source: Compiled, joint: ModelJoint, law: Law, gear: float, name: str) -> Section:
    """Force along a coordinate; the length of the actuator is gear times the coordinate."""
    terms = [
        (law.gain, name), (law.constant, ""),
        (law.by_length * gear, "coordinate"), (law.by_rate * gear, "rate"),
    ]  # fmt: skip
    values: dict[str, Any] = {"joint": joint.name, "force": linear_text(terms)}
    if gear != 1:
        values["gain"] = gear
    limits = _limits(source, joint, law, gear)
    if limits is not None:
        values["limits"] = list(limits)
    return Section("actuator", values)


def _limits(source: Compiled, joint: ModelJoint, law: Law, gear: float) -> tuple[float, float] | None:
    """Those of the actuator, and of all actuators of the joint."""
    model, low, high = source.model, -np.inf, np.inf
    if law.limits is not None:
        low, high = sorted(gear * each for each in law.limits)
    if model.jnt_actfrclimited[joint.number]:
        least, largest = model.jnt_actfrcrange[joint.number]
        low, high = max(low, float(least)), min(high, float(largest))
    return None if np.isinf(low) and np.isinf(high) else (float(low), float(high))


def _at_site(
    source: Compiled, bodies: Mapping[int, RigidBody], sites: tuple[int, int], text: str, gear: Array
) -> list[Section]:
    """A force and a torque on the body of a site, along axes of the site or of a reference at rest."""
    model, (site, reference) = source.model, sites
    body = bodies[int(model.site_bodyid[site])]
    if body.fixed:
        return []
    placed = site_in(source, site, body)
    turn = rotation_of(placed.quaternion)
    if reference >= 0:
        turn = np.reshape(source.data.site_xmat[reference], (3, 3))
    frame = "body" if reference < 0 else "world"
    found = []
    for key, axis in (("force", gear[:3]), ("torque", gear[3:])):
        if not axis.any():
            continue
        components = [
            linear_text([(each, f"({text})" if " " in text else text)]) for each in vector(turn @ axis)
        ]
        point = {"point": vector(placed.position)} if key == "force" and any(vector(placed.position)) else {}
        found.append(Section(key, {"body": body.name, key: components, **point, "frame": frame}))
    return found


def site_in(source: Compiled, site: int, body: RigidBody) -> Pose:
    """The frame of a site in the axes of its rigid body."""
    model, member = source.model, int(source.model.site_bodyid[site])
    own = attached(model.site_pos[site], model.site_quat[site])
    if body.fixed:
        return body.inside(compose(pose_at(source, member), own))
    return compose(pose_in(source, member, body.members[0]), own)


def _input(source: Compiled, number: int, name: str) -> Section:
    model, values = source.model, {"name": name}
    addresses = getattr(model, "actuator_ctrladr", None)
    default = float(source.control[number if addresses is None else int(addresses[number])])
    table: dict[str, Any] = dict(values)
    if model.actuator_ctrllimited[number]:
        least, largest = (float(each) for each in model.actuator_ctrlrange[number])
        table |= {"default": min(max(default, least), largest), "minimum": least, "maximum": largest}
    elif default:
        table["default"] = default
    return Section("input", table)
