"""Friction and resistances in the tables of the core (modelgen.h): the grips of every contact."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.runtime.tables.planar_contacts import patch_friction, rubbing_points

ASPECTS = ("slip", "spin", "roll")  # MG_FRICTION_SLIP ..
BELOW = {"slip": 2, "spin": 5, "roll": 5}  # rows below the normal one that a contact with this grip has

RUBBING = 5  # and the first point of a patch with friction


class Grips:
    """`integers`, `reals`: arrays of mg_system; `count`, `rows`: of all contacts."""

    def __init__(self, sentence: Mapping[str, Any]) -> None:
        of_contacts = [sentence["pairs"][each["pair"]].get("grips", []) for each in sentence["contacts"]]
        points = [RUBBING if rubs else 0 for rubs in rubbing_points(sentence)]
        of_contacts += [[]] * (len(sentence["limits"]) + len(points))
        more = [0] * (len(of_contacts) - len(points)) + points
        grips = [grip for listed in of_contacts for grip in listed]
        first, below = [0], [0]
        for listed, rows in zip(of_contacts, more, strict=True):
            first.append(first[-1] + len(listed))
            below.append(below[-1] + max((BELOW[grip["aspect"]] for grip in listed), default=rows))
        self.count, self.rows = len(grips), below[-1]
        self.integers: dict[str, list[int]] = {
            "contact_below": below,
            "contact_grip": first,
            "grip_aspect": [ASPECTS.index(grip["aspect"]) for grip in grips],
            "grip_row": [grip["row"] for grip in grips],
            "grip_body": [grip["body"] for grip in grips],
        }
        self.reals: dict[str, list[float]] = {
            f"grip_{key}": [value for grip in grips for value in grip[key]]
            for key in ("static", "kinetic", "direction")
        } | {"patch_friction": patch_friction(sentence)}
