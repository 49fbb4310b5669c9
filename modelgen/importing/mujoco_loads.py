"""Compensated gravity and damped balls of a MuJoCo model, and media and plugins that it refuses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Compiled
from modelgen.importing.mujoco_joints import ModelJoint
from modelgen.importing.mujoco_tendons import Bodies
from modelgen.importing.scene_writing import Section, rounded, vector
from modelgen.importing.welded_bodies import WORLD, attached, pose_in
from modelgen.scene.pose_arithmetic import compose


def other_loads(
    source: Compiled, bodies: Bodies, joints: Mapping[int, ModelJoint], notes: Notes
) -> list[Section]:
    """Compensated gravity, and the damping of balls on the world; notes on media, flexes and plugins."""
    model = source.model
    if model.opt.density or model.opt.viscosity:
        notes.refuse(
            "fluid", f"a medium of density {model.opt.density:g} and viscosity {model.opt.viscosity:g}"
        )
    if model.nflex:
        notes.refuse("deformables", f"{model.nflex} flexes")
    if model.nplugin:
        notes.refuse("plugins", f"{model.nplugin} plugins")
    return [*_compensations(source, bodies), *_ball_dampings(source, joints)]


def _compensations(source: Compiled, bodies: Bodies) -> Iterator[Section]:
    model = source.model
    if source.is_disabled("GRAVITY"):
        return
    for member, body in bodies.items():
        share = float(model.body_gravcomp[member])
        if share and not body.fixed:
            placed = compose(
                pose_in(source, member, body.members[0]),
                attached(model.body_ipos[member], model.body_iquat[member]),
            )
            pull = -share * float(model.body_mass[member]) * np.array(model.opt.gravity)
            values: dict[str, Any] = {"body": body.name, "force": vector(pull)}
            if any(vector(placed.position)):
                values["point"] = vector(placed.position)
            yield Section("force", values, "compensates gravity")


def _ball_dampings(source: Compiled, joints: Mapping[int, ModelJoint]) -> Iterator[Section]:
    model = source.model
    for number, joint in joints.items():
        damping = float(np.atleast_1d(model.dof_damping[model.jnt_dofadr[number]])[0])
        if (
            joint.kind == "spherical"
            and joint.between[0] == WORLD
            and damping
            and not source.is_disabled("DAMPER")
        ):
            torque = [f"{-rounded(damping)!r}*w{axis}" for axis in "xyz"]
            yield Section("torque", {"body": joint.between[1], "torque": torque}, f"damping of {joint.name}")
