"""The friction constraints of every contact in the tables of the core (modelgen.h)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.runtime.tables.planar_contacts import patch_friction, points_with_friction

FRICTION_KINDS = ("slip", "spin", "roll")  # MG_FRICTION_SLIP ..
FRICTION_ROWS = {
    "slip": 2,
    "spin": 5,
    "roll": 5,
}  # rows below the normal one that a contact with this friction constraint has

PATCH_FRICTION_ROWS = 5  # and the first point of a patch with friction


class FrictionTables:
    """`integers`, `reals`: arrays of mg_system; `count`, `rows`: of all contacts."""

    def __init__(self, instance: Mapping[str, Any]) -> None:
        of_contacts = [instance["pairs"][each["pair"]].get("friction", []) for each in instance["contacts"]]
        points = [
            PATCH_FRICTION_ROWS if has_friction else 0 for has_friction in points_with_friction(instance)
        ]
        of_contacts += [[]] * (len(instance["limits"]) + len(points))
        more = [0] * (len(of_contacts) - len(points)) + points
        constraints = [constraint for listed in of_contacts for constraint in listed]
        first, below = [0], [0]
        for listed, rows in zip(of_contacts, more, strict=True):
            first.append(first[-1] + len(listed))
            below.append(
                below[-1] + max((FRICTION_ROWS[constraint["kind"]] for constraint in listed), default=rows)
            )
        self.count, self.rows = len(constraints), below[-1]
        self.integers: dict[str, list[int]] = {
            "contact_friction_row": below,
            "contact_friction": first,
            "friction_kind": [FRICTION_KINDS.index(constraint["kind"]) for constraint in constraints],
            "friction_row": [constraint["row"] for constraint in constraints],
            "friction_body": [constraint["body"] for constraint in constraints],
        }
        self.reals: dict[str, list[float]] = {
            f"friction_{key}": [value for constraint in constraints for value in constraint[key]]
            for key in ("static", "kinetic", "direction")
        } | {"patch_friction": patch_friction(instance)}
