"""Remarks on values that are allowed but seldom meant: degrees, other units, other orders."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import pi
from typing import Any

from modelgen.scene.source_location import Place

TURN = 2 * pi  # rad; orientations that turn by more are rather degrees
AIR = 1.3  # kg/m^3; bodies of less are rather of g/cm^3
LAST_OF_FOUR = (0.0, 0.0, 0.0, 1.0)


def remark_on_orientation(values: Mapping[str, Any], place: Place) -> None:
    """On angles beyond a whole turn, and on a quaternion that is no rotation if its order is x, y, z, w."""
    if values["quaternion"] == LAST_OF_FOUR:
        place.key("quaternion").remark(
            "[0, 0, 0, 1] is half a turn about z: the order is w, x, y, z", "[1, 0, 0, 0] is no rotation"
        )
    angles = values["rpy"] or ()
    remark_on_angles(angles, place.key("rpy"))
    if values["axis_angle"] is not None:
        remark_on_angles([values["axis_angle"]["angle"]], place.key("axis_angle").key("angle"))


def remark_on_angles(angles: Iterable[float | None], place: Place) -> None:
    """On the first angle of more than a whole turn."""
    for angle in angles:
        if angle is not None and abs(angle) > TURN:
            turns = abs(angle) / TURN
            place.remark(
                f"{angle:g} rad are {turns:.3g} turns: angles are in rad",
                f'if degrees are meant, write "{angle:g}*pi/180"',
            )
            return


def remark_on_density(density: float, place: Place) -> None:
    """On a density below that of air."""
    if density <= AIR:
        place.remark(f"{density:g} kg/m^3 is no more than air has", "water has 1000, steel 7850 kg/m^3")


def remark_on_gravity(gravity: tuple[float, ...], place: Place) -> None:
    """On gravity along +z, the exterior side of a plane as it is written without rotation."""
    if gravity[2] > 0 and not any(gravity[:2]):
        place.remark(
            "gravity points up, along +z", f"write [0.0, 0.0, -{gravity[2]:g}] for one that points down"
        )
