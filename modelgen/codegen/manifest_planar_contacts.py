"""Faces and patches as plain values for the manifest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from modelgen.assembly.masses import pose_numbers
from modelgen.model import FaceEntry, Model, PatchEntry


def face_table(model: Model, entry: FaceEntry) -> dict[str, Any]:
    """A planar region: its axes in the centre-of-mass axes of its body, its boundary in its own axes."""
    return {
        "name": entry.name,
        "body": entry.body,
        "placement": list(pose_numbers(entry.pose, model.bodies[entry.body].centre_of_mass)),
        "boundary": [
            {
                "kind": arc.kind,
                "parameters": [value for _, value in arc.curve.parameters],
                "placement": list(pose_numbers(arc.pose, (0.0, 0.0, 0.0))),
                "ends": list(arc.ends),
                "loop": arc.loop,
            }
            for arc in entry.boundary
        ],
    }


def patch_tables(entries: Sequence[PatchEntry]) -> list[dict[str, Any]]:
    """The patches: their two faces, their support points, and the feature pairs that lie in them."""
    points = {id(entry.parameters): [list(numbers) for numbers in entry.parameters] for entry in entries}
    return [_patch_table(entry, points[id(entry.parameters)]) for entry in entries]


def _patch_table(entry: PatchEntry, support_points: list[list[float]]) -> dict[str, Any]:
    friction = (
        {"friction_kind": entry.friction_kind, "friction": list(entry.friction)}
        if entry.friction_kind >= 0
        else {}
    )
    shares = [[each.pair, *each.boundary_o, *each.boundary_f] for each in entry.shares]
    return {
        **friction,
        **({"shares": shares} if shares else {}),
        "name": entry.name,
        "pair": entry.pair,
        "kind": entry.kind,
        "faces": list(entry.faces),
        "support_points": support_points,
        "feature_pairs": list(entry.feature_pairs),
        "patch_slots": list(entry.patch_slots),
    }
