"""The material of the shapes of bodies with contacts, as plain values for the manifest."""

from __future__ import annotations

from typing import Any

from modelgen.assembly.masses import pose_numbers
from modelgen.geometry.solid_terms import is_thin, terms_of
from modelgen.model import Model
from modelgen.scene.scene_types import Shape


def solids_of(model: Model) -> list[dict[str, Any]]:
    """The shapes of all bodies that contacts name, by body: placement about the centre of mass and terms; no
    terms where a shape has no material, None where no terms describe it."""
    named = {name for pair in model.scene.contacts for name, _ in pair.between}
    return [
        {
            "body": k,
            "shape": shape.name,
            "cavity": shape.cavity,
            "placement": list(pose_numbers(shape.pose, model.bodies[k].centre_of_mass)),
            "terms": _terms(shape),
        }
        for k, body in enumerate(model.scene.bodies)
        if body.name in named
        for shape in body.shapes
    ]


def _terms(shape: Shape) -> list[dict[str, Any]] | None:
    if is_thin(shape):
        return []
    terms = terms_of(shape)
    if terms is None:
        return None
    return [{"kind": term.kind, "numbers": list(term.numbers)} for term in terms]
