"""Pieces of an outline in the x-y plane: line, arc, involute. Lengths in m, angles in rad, t from 0 to 1.

A piece runs from t = 0 to t = 1; on a closed outline with the material on its left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, cos, hypot, pi, sin

Point = tuple[float, float]

WIDEST = 2 * pi / 3  # of an arc that is one piece


@dataclass(frozen=True, slots=True)
class Line:
    start: Point
    end: Point

    def point(self, t: float) -> Point:
        (a, b), (c, d) = self.start, self.end
        return a + (c - a) * t, b + (d - b) * t

    def direction(self, t: float) -> Point:
        """The unit tangent."""
        return _unit((self.end[0] - self.start[0], self.end[1] - self.start[1]))

    def turned(self, angle: float) -> Line:
        return Line(rotated(self.start, angle), rotated(self.end, angle))


@dataclass(frozen=True, slots=True)
class Arc:
    """A piece of a circle between two angles, counterclockwise if they increase."""

    centre: Point
    radius: float
    angles: tuple[float, float]

    def point(self, t: float) -> Point:
        angle = self._angle(t)
        return self.centre[0] + self.radius * cos(angle), self.centre[1] + self.radius * sin(angle)

    def direction(self, t: float) -> Point:
        angle, sign = self._angle(t), 1.0 if self.is_convex else -1.0
        return -sign * sin(angle), sign * cos(angle)

    def turned(self, angle: float) -> Arc:
        a, b = self.angles
        return Arc(rotated(self.centre, angle), self.radius, (a + angle, b + angle))

    @property
    def is_convex(self) -> bool:
        """Whether the material is on the side of the centre."""
        return self.angles[1] > self.angles[0]

    @property
    def parts(self) -> tuple[Arc, ...]:
        """Arcs of at most WIDEST, one after the other."""
        a, b = self.angles
        count = max(1, ceil(abs(b - a) / WIDEST - 1e-9))
        ends = [a + (b - a) * k / count for k in range(count)] + [b]
        return tuple(replace(self, angles=(ends[k], ends[k + 1])) for k in range(count))

    def _angle(self, t: float) -> float:
        return self.angles[0] + (self.angles[1] - self.angles[0]) * t


@dataclass(frozen=True, slots=True)
class Involute:
    """The curve that the end of a string draws which is unwound from a base circle about the origin.

    With the signed roll r, counterclockwise, and e(a) = (cos a, sin a), the point is
    radius (e(start + r) - r e'(start + r)) and its derivative by r is radius r e(start + r).
    """

    radius: float  # of the base circle
    start: float  # angle at which the curve leaves the base circle
    rolls: tuple[float, float]  # both positive or both negative

    def point(self, t: float) -> Point:
        roll = self._roll(t)
        angle = self.start + roll
        return (
            self.radius * (cos(angle) + roll * sin(angle)),
            self.radius * (sin(angle) - roll * cos(angle)),
        )

    def direction(self, t: float) -> Point:
        angle = self.start + self._roll(t)
        sign = 1.0 if (self.rolls[1] - self.rolls[0]) * self.rolls[0] > 0 else -1.0
        return sign * cos(angle), sign * sin(angle)

    def turned(self, angle: float) -> Involute:
        return replace(self, start=self.start + angle)

    def _roll(self, t: float) -> float:
        return self.rolls[0] + (self.rolls[1] - self.rolls[0]) * t


Piece = Line | Arc | Involute


@dataclass(frozen=True, slots=True)
class Side:
    """A piece of an outline with the name that its features are named after."""

    name: str
    piece: Piece


Outline = tuple[Side, ...]  # closed, counterclockwise, end to start


def rotated(point: Point, angle: float) -> Point:
    """The point turned about the origin."""
    x, y = point
    return x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)


def samples(pieces: Sequence[Piece], count: int) -> list[Point]:
    """`count` points of each piece, from its start on, without its end."""
    return [piece.point(k / count) for piece in pieces for k in range(count)]


def _unit(vector: Point) -> Point:
    length = hypot(*vector)
    return vector[0] / length, vector[1] / length
