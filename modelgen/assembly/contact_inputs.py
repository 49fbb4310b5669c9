"""What the contacts of a scene follow from: where it is the same in two scenes, so are their contacts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from modelgen.model import BodyMotion, Model
from modelgen.scene.scene_types import Scene, Vector

Inputs = tuple[Any, ...]


def contact_inputs(scene: Scene, motions: Iterable[BodyMotion], centres: Iterable[Vector]) -> Inputs:
    """What pairs, feature pairs, contacts, faces and patches follow from, of bodies with these motions and
    centres of mass. Bodies that move may be anywhere."""
    bodies = tuple(
        (
            *(body.name, body.shapes, motion, centre, body.repeated, body.placed),
            body.pose if motion == "fixed" else None,
        )
        for body, motion, centre in zip(scene.bodies, motions, centres, strict=True)
    )
    return bodies, scene.contacts, scene.source, scene.fold, scene.run.form


def contact_inputs_of(model: Model) -> Inputs:
    """Those of the scene of a model."""
    motions = (model.body_kinds[entry.kind].motion for entry in model.bodies)
    return contact_inputs(model.scene, motions, (entry.centre_of_mass for entry in model.bodies))
