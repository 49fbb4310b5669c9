"""Pieces of an outline in the x-y plane: line, arc, involute. Lengths in m, angles in rad.

A piece runs from t = 0 to t = 1, on a closed outline counterclockwise, with the material on its left. All
pieces of one kind have the same formula, and differ in its parameters alone.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, replace
from math import ceil, cos, hypot, pi, sin

from modelgen.scene.expression import Expression, parse_expression

Point = tuple[float, float]

WIDEST = 2 * pi / 3  # of an arc that is one piece


@dataclass(frozen=True, slots=True)
class Line:
    """(x0, y0) + ((x1, y1) - (x0, y0)) t."""

    x0: float
    y0: float
    x1: float
    y1: float

    def point(self, t: float) -> Point:
        return self.x0 + (self.x1 - self.x0) * t, self.y0 + (self.y1 - self.y0) * t

    def velocity(self, t: float) -> Point:
        """The derivative of the point by t."""
        return self.x1 - self.x0, self.y1 - self.y0

    def turned(self, angle: float) -> Line:
        """The piece turned about the origin."""
        return Line(*rotated((self.x0, self.y0), angle), *rotated((self.x1, self.y1), angle))

    def scaled(self, factor: float) -> Line:
        return Line(self.x0 * factor, self.y0 * factor, self.x1 * factor, self.y1 * factor)


@dataclass(frozen=True, slots=True)
class Arc:
    """(cx, cy) + radius (cos a, sin a), a from angle_0 to angle_1: counterclockwise if that is larger."""

    cx: float
    cy: float
    radius: float
    angle_0: float
    angle_1: float

    def point(self, t: float) -> Point:
        angle = self.angle_0 + (self.angle_1 - self.angle_0) * t
        return self.cx + self.radius * cos(angle), self.cy + self.radius * sin(angle)

    def velocity(self, t: float) -> Point:
        turn = self.angle_1 - self.angle_0
        angle = self.angle_0 + turn * t
        return -self.radius * turn * sin(angle), self.radius * turn * cos(angle)

    def turned(self, angle: float) -> Arc:
        cx, cy = rotated((self.cx, self.cy), angle)
        return Arc(cx, cy, self.radius, self.angle_0 + angle, self.angle_1 + angle)

    def scaled(self, factor: float) -> Arc:
        return replace(self, cx=self.cx * factor, cy=self.cy * factor, radius=self.radius * factor)


@dataclass(frozen=True, slots=True)
class Involute:
    """The curve that the end of a string draws which is unwound from a base circle about the origin.

    With the roll r from roll_0 to roll_1, positive counterclockwise, and e(a) = (cos a, sin a):
    radius (e(start + r) - r e'(start + r)), whose derivative by r is radius r e(start + r).
    """

    radius: float  # of the base circle
    start: float  # angle at which the curve leaves the base circle
    roll_0: float
    roll_1: float

    def point(self, t: float) -> Point:
        roll = self.roll_0 + (self.roll_1 - self.roll_0) * t
        angle = self.start + roll
        x, y = cos(angle) + roll * sin(angle), sin(angle) - roll * cos(angle)
        return self.radius * x, self.radius * y

    def velocity(self, t: float) -> Point:
        roll = self.roll_0 + (self.roll_1 - self.roll_0) * t
        speed = self.radius * roll * (self.roll_1 - self.roll_0)
        return speed * cos(self.start + roll), speed * sin(self.start + roll)

    def turned(self, angle: float) -> Involute:
        return replace(self, start=self.start + angle)

    def scaled(self, factor: float) -> Involute:
        return replace(self, radius=self.radius * factor)


Piece = Line | Arc | Involute

_ANGLE = "(angle_0 + (angle_1 - angle_0)*t)"
_ROLL = "(roll_0 + (roll_1 - roll_0)*t)"
_FORMULAS: dict[type[Piece], tuple[str, str]] = {
    Line: ("x0 + (x1 - x0)*t", "y0 + (y1 - y0)*t"),
    Arc: (f"cx + radius*cos{_ANGLE}", f"cy + radius*sin{_ANGLE}"),
    Involute: (
        f"radius*(cos(start + {_ROLL}) + {_ROLL}*sin(start + {_ROLL}))",
        f"radius*(sin(start + {_ROLL}) - {_ROLL}*cos(start + {_ROLL}))",
    ),
}


@dataclass(frozen=True, slots=True)
class Side:
    """A piece of an outline with the name that its features are named after."""

    name: str
    piece: Piece


Outline = tuple[Side, ...]  # closed and counterclockwise, each from the end of the one before


def formulas_of(piece: Piece) -> tuple[Expression, Expression]:
    """x and y as expressions of t and the fields of the piece."""
    names = ("t", *type(piece).__dataclass_fields__)
    x, y = (parse_expression(text, names) for text in _FORMULAS[type(piece)])
    return x, y


def numbers_of(piece: Piece) -> tuple[tuple[str, float], ...]:
    """The parameters of the formulas."""
    return tuple(zip(type(piece).__dataclass_fields__, astuple(piece), strict=True))


def direction(piece: Piece, t: float) -> Point:
    """The unit tangent."""
    x, y = piece.velocity(t)
    length = hypot(x, y)
    return x / length, y / length


def parts_of(piece: Piece) -> tuple[Piece, ...]:
    """The piece, or arcs of at most WIDEST in its place, one after the other."""
    if not isinstance(piece, Arc):
        return (piece,)
    a, turn = piece.angle_0, piece.angle_1 - piece.angle_0
    count = max(1, ceil(abs(turn) / WIDEST - 1e-9))
    ends = [*(a + turn * k / count for k in range(count)), piece.angle_1]
    return tuple(replace(piece, angle_0=ends[k], angle_1=ends[k + 1]) for k in range(count))


def rotated(point: Point, angle: float) -> Point:
    """The point turned about the origin."""
    x, y = point
    return x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)
