"""The material of the shapes of a scene, as plain values for the manifest."""

from __future__ import annotations

from typing import Any

from modelgen.assembly.masses import pose_numbers
from modelgen.geometry.solid_terms import about_terms_of, is_thin
from modelgen.model import Model
from modelgen.scene.scene_types import Shape


def solids_of(model: Model) -> list[dict[str, Any]]:
    """All shapes of bodies, by body: placement about the centre of mass and terms.

    There are no terms where a shape has no material, and None where no terms describe it. Of a prism over a
    smooth outline, terms describe a polygon: `about` is true.
    """
    return [_solid(model, k, shape) for k, body in enumerate(model.scene.bodies) for shape in body.shapes]


def _solid(model: Model, body: int, shape: Shape) -> dict[str, Any]:
    terms = () if is_thin(shape) else about_terms_of(shape)
    return {
        "body": body,
        "shape": shape.name,
        "cavity": shape.cavity,
        "placement": list(pose_numbers(shape.pose, model.bodies[body].centre_of_mass)),
        "terms": terms
        if terms is None
        else [{"kind": term.kind, "numbers": list(term.numbers)} for term in terms],
        **({"about": True} if terms and shape.profile is not None else {}),
    }
