"""A file of MJCF or URDF as the text of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.importing.admissible_start import within_limits, without_overlaps
from modelgen.importing.contact_tables import contact_tables
from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_actuators import actuated
from modelgen.importing.mujoco_compilation import Compiled, compiled
from modelgen.importing.mujoco_constraints import constraints
from modelgen.importing.mujoco_contacts import touches
from modelgen.importing.mujoco_joints import ModelJoint, jointed
from modelgen.importing.mujoco_loads import other_loads
from modelgen.importing.mujoco_sensors import sensors
from modelgen.importing.mujoco_shapes import Shapes, pose_keys, shapes
from modelgen.importing.mujoco_tendons import tendons
from modelgen.importing.scene_writing import Section, moments, scene_text, vector
from modelgen.importing.welded_bodies import RigidBody, rigid_bodies

DIAGONAL = 1e-12  # an inertia whose other entries are zero, against its largest


@dataclass(frozen=True)
class Reading:
    """How a file of MJCF or URDF is read: see `Choices` of import_formats.py."""

    urdf: bool
    key: str | None
    floating: bool
    corners: int


def robot_text(path: Path, reading: Reading, until: float, notes: Notes) -> str:
    """The text of the scene of a file; raises ModelgenError."""
    source = compiled(path, reading.urdf, reading.key, reading.floating, notes)
    within_limits(source, notes)
    found = without_overlaps(source, touches(source, notes), notes)
    bodies = rigid_bodies(source)
    _note_mocap(source, notes)
    chain = jointed(source, bodies, notes)
    numbered = chain.by_number()
    used = shapes(source, bodies, {geom for pair in found for geom in pair}, reading.corners, notes)
    loads = [
        *constraints(source, bodies, notes),
        *tendons(source, bodies, notes),
        *actuated(source, bodies, numbered, notes),
        *other_loads(source, bodies, numbered, notes),
    ]
    measured = sensors(source, bodies, numbered, notes)
    notes.check()
    if all(body.fixed for body in bodies.values()):
        remedy = "let its first link move with --floating" if reading.urdf else "add a joint"
        raise ModelgenError(str(path), "nothing in it moves", "a scene has a body that forces move", remedy)
    sections = [
        Section("run", {"until": until}, single=True),
        *_bodies(source, [*dict.fromkeys(bodies.values()), *chain.links], used),
        *(_joint(joint) for joint in chain.joints),
        *loads,
        *contact_tables(found, used, chain.joints),
        *measured,
    ]
    gravity = np.zeros(3) if source.is_disabled("GRAVITY") else source.model.opt.gravity
    return scene_text(_head(path, source, reading.urdf, notes), {"gravity": vector(gravity)}, sections)


def _head(path: Path, source: Compiled, urdf: bool, notes: Notes) -> list[str]:
    kind = "URDF" if urdf else "MJCF"
    begins = f" It begins with keyframe {source.key!r}." if source.key else ""
    lines = [f"{path.name}, imported from {kind} by modelgen.{begins}"]
    for title, sentences in (("Taken otherwise", notes.approximated), ("Left out", notes.left_out)):
        if sentences:
            lines += [f"{title}:", *(f"- {sentence}" for sentence in sentences)]
    return lines


def _note_mocap(source: Compiled, notes: Notes) -> None:
    for body in range(source.model.nbody):
        if source.model.body_mocapid[body] >= 0:
            notes.approximate(f"{source.told('body', body)}, which a program places, is at rest")


def _bodies(source: Compiled, bodies: Sequence[RigidBody], used: Shapes) -> Iterator[Section]:
    owned: dict[str, list[dict[str, Any]]] = {}
    for body, table in used.values():
        owned.setdefault(body.name, []).append(table)
    for body in bodies:
        own = owned.get(body.name, [])
        if own or not body.fixed:
            yield _body(body, own)


def _body(body: RigidBody, own: Sequence[Mapping[str, Any]]) -> Section:
    values: dict[str, Any] = {"name": body.name}
    if body.fixed:
        values["motion"] = "fixed"
    values |= pose_keys(body.pose)
    if not body.fixed:
        values |= _motion(body)
    return Section("body", values, inner=[Section("body.shape", table) for table in own])


def _motion(body: RigidBody) -> dict[str, Any]:
    """Mass, centre, inertia and velocities of a body."""
    inertia = body.inertia
    off = np.abs(inertia - np.diag(np.diag(inertia))).max()
    plain = off <= DIAGONAL * np.abs(inertia).max()
    values: dict[str, Any] = {
        "mass": body.mass,
        "inertia": moments(np.diag(inertia))
        if plain
        else [moments(row) for row in (inertia + inertia.T) / 2],
    }
    for name, each in (
        ("center_of_mass", body.centre), ("velocity", body.velocity), ("angular_velocity", body.spin)
    ):  # fmt: skip
        if any(vector(each)):
            values[name] = vector(each)
    return values


def _joint(joint: ModelJoint) -> Section:
    values = {
        "kind": joint.kind,
        "name": joint.name,
        "between": list(joint.between),
        "frames": [pose_keys(frame) for frame in joint.frames],
        **joint.keys,
    }
    return Section("joint", values)
