"""The open edges of charts and splines and the open ends of curves, which touch nothing, and the shapes that
contacts pair with them."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from modelgen.codegen.manifest_unlisted_shapes import placed_entry, shape_entry
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.open_edges import is_sheet, open_edge_points
from modelgen.model import Model
from modelgen.scene.scene_types import Shape

PART = 0.2  # of the radius of the ball around the smallest partner, distance of points of an edge


def open_edges_of(model: Model) -> dict[str, Any]:
    """Edges as points and their partners as shapes, and which edge may meet which shape."""
    scene = model.scene
    of_body = [(k, shape) for k, body in enumerate(scene.bodies) for shape in body.shapes]
    index = {(scene.bodies[k].name, shape.name): at for at, (k, shape) in enumerate(of_body)}
    partners: dict[int, list[int]] = {}
    for pair in scene.contacts:
        a, b = (index[partner] for partner in pair.between)
        partners.setdefault(a, []).append(b)
        partners.setdefault(b, []).append(a)
    shapes: list[dict[str, Any]] = []
    pairs: list[list[int]] = []
    place: dict[int, int] = {}
    for one, others in sorted(partners.items()):
        if not is_sheet(of_body[one][1]):
            continue
        entry = _edges(model, *of_body[one], [of_body[each][1] for each in others])
        if entry is None:
            continue
        edge = len(shapes)
        shapes.append(entry)
        for other in others:
            if other not in place:
                place[other] = len(shapes)
                shapes.append(shape_entry(model, other, *of_body[other]))
            pairs.append([edge, place[other]])
    return {"shapes": shapes, "pairs": pairs}


def _edges(model: Model, body: int, shape: Shape, partners: list[Shape]) -> dict[str, Any] | None:
    """The open edges or ends of a shape; None if it has none."""
    radii = [
        radius for radius in (bounding_ball(each)[1] for each in partners) if isfinite(radius) and radius
    ]
    spacing = PART * min(radii, default=bounding_ball(shape)[1])
    points = open_edge_points(shape, spacing)
    if not len(points):
        return None
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return {
        **placed_entry(model, body, shape),
        "centre": centre.tolist(),
        "radius": max(float(np.linalg.norm(points - centre, axis=1).max()), spacing),
        "cavity": False,
        "thin": True,
        "kind": "sampled",
        "parameters": [spacing],
        "points": points.ravel().tolist(),
        "normals": [],
    }
