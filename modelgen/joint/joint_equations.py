"""Equations of each kind of joint: what two frames keep (Theta of (2.3)), and the coordinates they leave.

Every row is in metres: angles are measured by the characteristic length. A row that holds an angle uses its
sine, so that no branch of an arc tangent is met.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from modelgen.geometry.frames import cross, dot
from modelgen.joint.joint_frames import Meeting

Measure = Literal["angle", "length", "tilt"]  # a tilt: an angle from 0 to pi, in which nothing turns whole
Value = Callable[[Meeting, ca.SX], ca.SX]  # of the frames and the kind's own numbers


@dataclass(frozen=True)
class Coordinate:
    """A coordinate of a joint; an angle lies within half a turn."""

    name: str
    measure: Measure
    value: Value


@dataclass(frozen=True)
class JointForm:
    """One kind of joint. Springs, limits and a given motion act on its first coordinate."""

    keeps: str  # the rows in words: r from the first origin to the second, axes of both, L the length
    rows: Callable[[Meeting, ca.SX], list[ca.SX]]
    coordinates: tuple[Coordinate, ...] = ()
    numbers: tuple[str, ...] = ()  # the kind's own parameters
    given: Callable[[Meeting, ca.SX], ca.SX] | None = None  # the row that holds the coordinate at a value
    moves: bool = False  # that row takes the place of the others, which hold the coordinate where it is


def _together(m: Meeting) -> list[ca.SX]:
    return list(ca.vertsplit(m.span))


def _parallel(m: Meeting) -> list[ca.SX]:
    return [m.length * m.cosine("xa", "zb"), m.length * m.cosine("ya", "zb")]


def _aligned(m: Meeting) -> list[ca.SX]:
    pairs = (("ya", "zb"), ("za", "xb"), ("xa", "yb"))
    return [m.length * m.cosine(*pair) for pair in pairs]


def _on_axis(m: Meeting) -> list[ca.SX]:
    return [m.along("xa"), m.along("ya")]


def _turn(m: Meeting, _: ca.SX) -> ca.SX:
    return ca.atan2(m.cosine("ya", "xb"), m.cosine("xa", "xb"))


def _lift(m: Meeting, _: ca.SX) -> ca.SX:
    return m.along("za")


def _distance(m: Meeting, _: ca.SX) -> ca.SX:
    return ca.sqrt(dot(m.span, m.span))


def _tilt(m: Meeting, _: ca.SX) -> ca.SX:
    return ca.atan2(ca.norm_2(cross(m.axis("za"), m.axis("zb"))), m.cosine("za", "zb"))


def _sine_off(m: Meeting, angle: ca.SX) -> ca.SX:
    """sin(turn - angle)."""
    return m.cosine("ya", "xb") * ca.cos(angle) - m.cosine("xa", "xb") * ca.sin(angle)


def _screw(m: Meeting, numbers: ca.SX) -> ca.SX:
    """lift = lead turn/(2 pi): the sine of the turn beyond that of the lift."""
    lead = numbers[0] / (2 * ca.pi)
    return lead * _sine_off(m, m.along("za") / lead)


def _mesh(m: Meeting, numbers: ca.SX) -> ca.SX:
    """n_a turn_a + n_b turn_b = 0 about axes at rest; whole turns do not count, as n_a and n_b are whole."""
    turns = (
        _turn_past(numbers[2:11], m.a.rotation),
        _turn_past(numbers[11:20], m.b.rotation),
    )
    return m.length * ca.sin(numbers[0] * turns[0] + numbers[1] * turns[1]) / ca.norm_2(numbers[0:2])


def _turn_past(start: ca.SX, rotation: ca.SX) -> ca.SX:
    """Angle about its own z axis by which a frame has turned from its orientation at the start."""
    rest = ca.reshape(start, 3, 3)
    return ca.atan2(dot(rest[:, 1], rotation[:, 0]), dot(rest[:, 0], rotation[:, 0]))


_TURN = Coordinate("angle", "angle", _turn)
_LIFT = Coordinate("displacement", "length", _lift)
_MESH_NUMBERS = (
    "teeth_a",
    "teeth_b",
    *(f"start_{side}_{i}{j}" for side in "ab" for j in "xyz" for i in "xyz"),
)

FORMS: Mapping[str, JointForm] = {
    "revolute": JointForm(
        "r = 0, L x_a.z_b = L y_a.z_b = 0; angle: from x_a to x_b about z_a",
        lambda m, _: [*_together(m), *_parallel(m)],
        (_TURN,),
        given=lambda m, angle: m.length * _sine_off(m, angle),
    ),
    "prismatic": JointForm(
        "x_a.r = y_a.r = 0, L y_a.z_b = L z_a.x_b = L x_a.y_b = 0; displacement: z_a.r",
        lambda m, _: [*_on_axis(m), *_aligned(m)],
        (_LIFT,),
        given=lambda m, lift: m.along("za") - lift,
    ),
    "cylindrical": JointForm(
        "x_a.r = y_a.r = 0, L x_a.z_b = L y_a.z_b = 0; displacement: z_a.r, angle: from x_a to x_b about z_a",
        lambda m, _: [*_on_axis(m), *_parallel(m)],
        (_LIFT, _TURN),
    ),
    "spherical": JointForm(
        "r = 0; tilt: from z_a to z_b", lambda m, _: _together(m), (Coordinate("tilt", "tilt", _tilt),)
    ),
    "universal": JointForm(
        "r = 0, L x_a.y_b = 0; angle_x: from y_a to y_b about x_a, angle_y: from x_a to x_b about y_b",
        lambda m, _: [*_together(m), m.length * m.cosine("xa", "yb")],
        (
            Coordinate("angle_x", "angle", lambda m, _: ca.atan2(m.cosine("za", "yb"), m.cosine("ya", "yb"))),
            Coordinate("angle_y", "angle", lambda m, _: ca.atan2(m.cosine("xa", "zb"), m.cosine("xa", "xb"))),
        ),
    ),
    "planar": JointForm(
        "z_a.r = 0, L x_a.z_b = L y_a.z_b = 0; x: x_a.r, y: y_a.r, angle: from x_a to x_b about z_a",
        lambda m, _: [m.along("za"), *_parallel(m)],
        (
            Coordinate("x", "length", lambda m, _: m.along("xa")),
            Coordinate("y", "length", lambda m, _: m.along("ya")),
            _TURN,
        ),
    ),
    "weld": JointForm(
        "r = 0, L y_a.z_b = L z_a.x_b = L x_a.y_b = 0", lambda m, _: [*_together(m), *_aligned(m)]
    ),
    "screw": JointForm(
        "x_a.r = y_a.r = 0, L x_a.z_b = L y_a.z_b = 0, lead/(2 pi) sin(angle - 2 pi displacement/lead) = 0; "
        "displacement: z_a.r, angle: from x_a to x_b about z_a",
        lambda m, numbers: [*_on_axis(m), *_parallel(m), _screw(m, numbers)],
        (_LIFT, _TURN),
        ("lead",),
        given=lambda m, lift: m.along("za") - lift,
    ),
    "distance": JointForm(
        "|r| - distance = 0; distance: |r|",
        lambda m, numbers: [_distance(m, numbers) - numbers[0]],
        (Coordinate("distance", "length", _distance),),
        ("distance",),
        given=lambda m, distance: _distance(m, distance) - distance,
        moves=True,
    ),
    "rope": JointForm(
        "nothing; distance: |r|", lambda m, _: [], (Coordinate("distance", "length", _distance),)
    ),
    "gear": JointForm(
        "L sin(n_a turn_a + n_b turn_b)/|(n_a, n_b)| = 0, turns about z_a and z_b since the start",
        lambda m, numbers: [_mesh(m, numbers)],
        numbers=_MESH_NUMBERS,
    ),
}
