"""The mode of a run at its present state, for functions in that mode."""

from __future__ import annotations

import numpy as np

from modelgen.composition.contact_mode import (
    PATCH_FRICTION_ROWS,
    SUPPORT_POINTS,
    ContactMode,
    FrictionMode,
    FrictionState,
    PatchMode,
    contact_count,
    friction_of_contacts,
)
from modelgen.errors import ModelgenError
from modelgen.model import Model
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.friction_rows import FRICTION_ROWS

STICKING, SLIP_ONSET, START_FLAT = 1, 2, 1  # MG_STICKING, MG_SLIP_ONSET, MG_START_FLAT (modelgen.h)


def run_mode(model: Model, session: Session) -> ContactMode:
    """The mode of a run of the model: what carries force, on which features, what sticks and slips.

    Raises ModelgenError where friction rubs over a whole face, or a face begins to roll from flat: the
    equations of both are no rows of points.
    """
    n, active = len(model.contacts), session.active
    pairs = tuple(int(session.feature_pair[k]) for k in range(n))
    for k in range(n):
        if session.rolling_start[k] == START_FLAT and active[k]:
            raise _refused(model, f"contact {model.contacts[k].name!r} begins to roll from flat")
    friction = tuple(_friction(session, number) for number, _ in enumerate(friction_of_contacts(model)))
    patches = tuple(_patches(model, session))
    reference = _reference(model, session, patches) if session.run.forces_redundant else ()
    return ContactMode(
        feature_pairs=pairs,
        active=tuple(bool(active[k]) for k in range(contact_count(model))),
        friction=friction,
        patches=patches,
        reference=reference,
    )


def _refused(model: Model, found: str) -> ModelgenError:
    return ModelgenError(
        f"{model.scene.source}: mode", found, "contacts at points, and faces that rest or stick",
        "take the mode at another time, or leave the friction of the face out",
    )  # fmt: skip


def _friction(session: Session, number: int) -> FrictionMode:
    code = int(session.friction_mode[number])
    state: FrictionState = "off" if code == 0 else "sticks" if code == STICKING else "slips"
    x, y, z = session.run_arrays["slip_direction"][3 * number : 3 * number + 3].astype(float)
    return FrictionMode(state, (float(x), float(y), float(z)))


def _patches(model: Model, session: Session) -> list[PatchMode]:
    found = []
    first = contact_count(model)
    pairs = len(model.feature_pairs) + len(model.limits)
    for slot in range(session.n_patch_slot):
        at = first + SUPPORT_POINTS * slot
        if session.feature_pair[at] < 0:
            continue
        number = (int(session.feature_pair[at]) - pairs) // SUPPORT_POINTS
        patch, code = model.patches[number], int(session.run_arrays["patch_mode"][slot])
        rubs = patch.friction_kind >= 0 and patch.friction[1] > 0 and bool(session.active[at])
        if rubs and code >= SLIP_ONSET:
            raise _refused(model, f"face {patch.name!r} slips")
        points = session.run_arrays["point"][3 * at : 3 * at + 9].astype(float).reshape(3, 3)
        holds = [bool(session.active[at + k]) for k in range(SUPPORT_POINTS)]
        found.append(
            PatchMode(
                number,
                (holds[0], holds[1], holds[2]),
                tuple(tuple(map(float, point)) for point in points),  # type: ignore[arg-type]
                rubs and code == STICKING,
            )
        )
    return found


def _reference(model: Model, session: Session, patches: tuple[PatchMode, ...]) -> tuple[float, ...]:
    """The reference forces of the rows, from the core's order to that of `force`."""
    forces = session.run_arrays["reference_force"].astype(float)
    shown = contact_count(model)
    of_supports = [
        shown + SUPPORT_POINTS * slot + k
        for slot in range(session.n_patch_slot)
        if session.feature_pair[shown + SUPPORT_POINTS * slot] >= 0
        for k in range(SUPPORT_POINTS)
    ]
    joints = session.n_contact + 1
    below = joints + int(session.system.n_joint_row)
    begins = _friction_begins(model)
    friction = [
        below + begins[index] + constraint.row + k
        for index, constraint in friction_of_contacts(model)
        for k in range(constraint.rows)
    ]
    held = [joints + joint.row + k for joint in model.joints for k in range(joint.rows)]
    places = [*range(shown), *friction, *held, *of_supports]
    values = [float(forces[place]) for place in places]
    of_patches = np.zeros(PATCH_FRICTION_ROWS * sum(each.sticks for each in patches))
    return (*values, *of_patches)


def _friction_begins(model: Model) -> list[int]:
    """The first friction row of each contact in the core."""
    begins, at = [], 0
    for contact in model.contacts:
        begins.append(at)
        kinds = [constraint.kind for constraint in model.pairs[contact.pair].friction]
        at += max((FRICTION_ROWS[kind] for kind in kinds), default=0)
    return begins
