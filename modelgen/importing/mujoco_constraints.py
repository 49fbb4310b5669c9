"""Equality constraints of a MuJoCo model as joints: welds and points."""

from __future__ import annotations

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Compiled
from modelgen.importing.mujoco_shapes import pose_keys
from modelgen.importing.mujoco_tendons import Bodies, Ends, site_end
from modelgen.importing.name_conversion import Names
from modelgen.importing.scene_writing import Section
from modelgen.importing.welded_bodies import WORLD, attached, pose_at, pose_in
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose


def constraints(source: Compiled, bodies: Bodies, notes: Notes) -> list[Section]:
    """Equality constraints that are active at the start: welds and points."""
    mj, model, names, found = source.mj, source.model, Names(), []
    if source.is_disabled("EQUALITY"):
        return []
    for number in range(model.neq):
        if not model.eq_active0[number]:
            notes.omit(f"{source.told('equality', number)}, which is not active")
            continue
        kind = int(model.eq_type[number])
        if kind not in (mj.mjtEq.mjEQ_CONNECT, mj.mjtEq.mjEQ_WELD):
            notes.refuse("constraints", f"{source.told('equality', number)} is neither a weld nor a point")
            continue
        (one, here), (other, there) = _held(source, number, bodies)
        if one == other:
            continue
        notes.approximate("equality constraints are rigid; in MuJoCo they give way")
        values = {
            "kind": "weld" if kind == mj.mjtEq.mjEQ_WELD else "spherical",
            "name": names.of(source.name("equality", number), f"constraint{number}"),
            "between": [one, other],
            "frames": [pose_keys(here), pose_keys(there)],
        }
        found.append(Section("joint", values))
    return found


def _held(source: Compiled, number: int, bodies: Bodies) -> Ends:
    """Body and frame of both sides of a weld or point."""
    mj, model = source.mj, source.model
    objects = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
    if int(model.eq_objtype[number]) == mj.mjtObj.mjOBJ_SITE:
        one, other = (site_end(source, site, bodies) for site in objects)
        return one, other
    data = model.eq_data[number]
    if int(model.eq_type[number]) == mj.mjtEq.mjEQ_WELD:
        frames = attached(data[3:6], data[6:10]), Pose()
    else:
        still = np.array([1.0, 0.0, 0.0, 0.0])
        frames = attached(data[:3], still), attached(data[3:6], still)
    one, other = (_end(source, body, frame, bodies) for body, frame in zip(objects, frames, strict=True))
    return one, other


def _end(source: Compiled, member: int, frame: Pose, bodies: Bodies) -> tuple[str, Pose]:
    body = bodies[member]
    if body.fixed:
        return WORLD, compose(pose_at(source, member), frame)
    return body.name, compose(pose_in(source, member, body.members[0]), frame)
