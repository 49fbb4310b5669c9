"""Springs and ropes from tendons of a MuJoCo model, and the frames of its sites."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from modelgen.importing.import_losses import Notes
from modelgen.importing.mujoco_actuators import site_in
from modelgen.importing.mujoco_compilation import Compiled
from modelgen.importing.mujoco_shapes import pose_keys
from modelgen.importing.name_conversion import Names
from modelgen.importing.scene_writing import Section, vector
from modelgen.importing.welded_bodies import WORLD, RigidBody
from modelgen.scene.pose_arithmetic import compose
from modelgen.scene.scene_types import Pose

Bodies = Mapping[int, RigidBody]


def tendons(source: Compiled, bodies: Bodies, notes: Notes) -> list[Section]:
    """Springs and ropes between two points each."""
    names = Names()
    found: list[Section] = []
    for number in range(source.model.ntendon):
        told, ends = source.told("tendon", number), _straight(source, number, bodies)
        if ends is None:
            if _acts(source, number):
                notes.refuse("tendons", f"{told} is not straight between two sites")
            continue
        if source.model.tendon_frictionloss[number]:
            notes.omit(f"dry friction of {told}")
        found += _tendon(
            source, number, ends, names.of(source.name("tendon", number), f"tendon{number}"), notes
        )
    return found


Ends = tuple[tuple[str, Pose], tuple[str, Pose]]


def _straight(source: Compiled, number: int, bodies: Bodies) -> Ends | None:
    """Body and frame of both sites of a tendon; None where it has others, or bends."""
    mj, model = source.mj, source.model
    first, count = int(model.tendon_adr[number]), int(model.tendon_num[number])
    wraps = range(first, first + count)
    if count != 2 or any(int(model.wrap_type[k]) != mj.mjtWrap.mjWRAP_SITE for k in wraps):
        return None
    one, other = (site_end(source, int(model.wrap_objid[k]), bodies) for k in wraps)
    return one, other


def site_end(source: Compiled, site: int, bodies: Bodies) -> tuple[str, Pose]:
    """The body of a site, and its frame there; in the world where the body is at rest."""
    body = bodies[int(source.model.site_bodyid[site])]
    placed = site_in(source, site, body)
    return (WORLD, compose(body.pose, placed)) if body.fixed else (body.name, placed)


def _acts(source: Compiled, number: int) -> bool:
    """Whether a tendon does anything by itself; what pulls at it is an actuator."""
    model = source.model
    values = (
        "tendon_stiffness",
        "tendon_damping",
        "tendon_limited",
        "tendon_frictionloss",
        "tendon_armature",
    )
    return any(np.any(getattr(model, name)[number]) for name in values if hasattr(model, name))


def _tendon(source: Compiled, number: int, ends: Ends, name: str, notes: Notes) -> Iterator[Section]:
    model, told = source.model, source.told("tendon", number)
    (one, here), (other, there) = ends
    if one == other:
        return
    stiffness, damping = (
        float(np.atleast_1d(values[number])[0]) for values in (model.tendon_stiffness, model.tendon_damping)
    )
    low, high = (float(each) for each in model.tendon_lengthspring[number])
    if stiffness and low != high:
        notes.refuse("tendons", f"{told} has a spring without force from {low:g} m to {high:g} m")
    elif stiffness or damping:
        values = {
            "between": [one, other],
            "anchors": [vector(here.position), vector(there.position)],
            "stiffness": stiffness,
            **({"damping": damping} if damping else {}),
            "rest_length": high,
        }
        yield Section("spring", values)
    if model.tendon_limited[number] and not source.is_disabled("LIMIT"):
        least, largest = (float(each) for each in model.tendon_range[number])
        values = {
            "kind": "rope", "name": name, "between": [one, other],
            "frames": [pose_keys(here), pose_keys(there)],
            "limits": ["none" if least <= 0 else least, largest],
        }  # fmt: skip
        yield Section("joint", values)
