"""A start that rigid limits and contacts allow: joints within limits, and no geoms within each other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_compilation import Array, Compiled
from modelgen.importing.mujoco_contacts import Touches

LARGEST = 0.05  # of a shift, against the extent of the model
CLEARANCE = 1e-6  # left after a shift, against the same: MuJoCo's search is as exact
ROUNDS = 20


def within_limits(source: Compiled, notes: Notes) -> None:
    """Put hinges and slides that start beyond a limit on it. The state of `source.data` is changed."""
    model, kinds = source.model, source.mj.mjtJoint
    if source.is_disabled("LIMIT"):
        return
    for joint in range(model.njnt):
        q = int(model.jnt_qposadr[joint])
        is_coordinate = int(model.jnt_type[joint]) in (kinds.mjJNT_HINGE, kinds.mjJNT_SLIDE)
        if not (model.jnt_limited[joint] and is_coordinate):
            continue
        least, largest = (float(each) for each in model.jnt_range[joint])
        begun = float(source.data.qpos[q])
        if not least <= begun <= largest:
            source.data.qpos[q] = min(max(begun, least), largest)
            notes.approximate(
                f"{source.told('joint', joint)} starts at its limit, {source.data.qpos[q]:g}, "
                f"not beyond it at {begun:g}"
            )
    source.mj.mj_forward(model, source.data)


def without_overlaps(source: Compiled, found: Touches, notes: Notes) -> Touches:
    """The pairs of geoms that do not penetrate at the start; free bodies in something are moved out.

    The state of `source.data` is changed.
    """
    _move_out(source, found, notes)
    deep = {pair: depth for pair, depth, _ in _penetrating(source, found)}
    for (a, b), depth in deep.items():
        notes.omit(
            f"contact of {source.told('geom', a)} and {source.told('geom', b)}, which are {depth:.2g} m "
            "within each other at the start"
        )
    return {pair: touch for pair, touch in found.items() if pair not in deep}


def _penetrating(source: Compiled, found: Touches) -> Iterator[tuple[tuple[int, int], float, Array]]:
    """Pairs, depths in m, and normals (3,) from the first to the second geom."""
    source.mj.mj_forward(source.model, source.data)
    for contact in source.data.contact[: source.data.ncon]:
        pair = tuple(sorted((int(contact.geom[0]), int(contact.geom[1]))))
        if contact.dist < 0 and pair in found:
            normal = np.array(contact.frame[:3])
            yield (pair[0], pair[1]), -float(contact.dist), normal if contact.geom[0] == pair[0] else -normal


def _move_out(source: Compiled, found: Touches, notes: Notes) -> None:
    model, before = source.model, np.array(source.data.qpos)
    extent, moved = float(model.stat.extent), {}
    for _ in range(ROUNDS):
        shifts: dict[int, Array] = {}
        for (a, b), depth, normal in _penetrating(source, found):
            for geom, sign in ((a, -1.0), (b, 1.0)):
                joint, other = _free_joint(source, geom), b if geom == a else a
                if joint is not None and model.body_weldid[model.geom_bodyid[other]] == 0:
                    shift = sign * (depth + CLEARANCE * extent) * normal
                    known = shifts.get(joint)
                    if known is None or np.linalg.norm(shift) > np.linalg.norm(known):
                        shifts[joint] = shift
        if not shifts:
            break
        for joint, shift in shifts.items():
            at = int(model.jnt_qposadr[joint])
            source.data.qpos[at : at + 3] += shift
            moved[joint] = source.data.qpos[at : at + 3] - before[at : at + 3]
    for joint, way in list(moved.items()):
        name = source.told("body", int(model.jnt_bodyid[joint]))
        if np.linalg.norm(way) > LARGEST * extent:
            at = int(model.jnt_qposadr[joint])
            source.data.qpos[at : at + 3] = before[at : at + 3]
            continue
        notes.approximate(
            f"{name} starts {np.linalg.norm(way):.2g} m beside its place, out of what it stands in"
        )
    source.mj.mj_forward(model, source.data)


def _free_joint(source: Compiled, geom: int) -> int | None:
    """The free joint of the tree that a geom belongs to."""
    model = source.model
    root = int(model.body_rootid[model.geom_bodyid[geom]])
    first = int(model.body_jntadr[root])
    if model.body_jntnum[root] and int(model.jnt_type[first]) == source.mj.mjtJoint.mjJNT_FREE:
        return first
    return None
