"""Minima of the distance of two circles in space, in 50 digits, independent of the project's code.

The distance of a point of the second circle from the first one is known in closed form; its derivative along
the second circle changes its sign at each minimum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from mpmath import mp, mpf

from tests.laws.exhaustive_minima import Array

DIGITS = 50
PARTS = 360  # of the second circle, in each of which one minimum at most is seen

Vector = tuple[mpf, mpf, mpf]


def dot(a: Vector, b: Vector) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a: Vector) -> Vector:
    size = mp.sqrt(dot(a, a))
    return (a[0] / size, a[1] / size, a[2] / size)


@dataclass(frozen=True)
class Minimum:
    """One minimum: distance (m), how regular it is, and both points (m, axes of the first body)."""

    distance: float
    margin: float  # determinant of the second derivatives of distance^2/2 by the angles, over (R r)^2
    points: Array  # (6,)


class CirclePair:
    """A circle of radius R about the z axis of the first body, and one of radius r about that of the second.

    pose: position (m) and rotation by columns of the second body in the axes of the first.
    """

    def __init__(self, R: float, r: float, pose: Array) -> None:
        self.R, self.r = mpf(R), mpf(r)
        at = [mpf(float(x)) for x in pose]
        with mp.workdps(DIGITS):
            self.centre: Vector = (at[0], at[1], at[2])
            self.u = unit((at[3], at[4], at[5]))
            v = (at[6], at[7], at[8])
            along = dot(self.u, v)
            self.v = unit((v[0] - along * self.u[0], v[1] - along * self.u[1], v[2] - along * self.u[2]))

    def point(self, t: mpf) -> tuple[Vector, Vector]:
        """Point of the second circle at an angle, and its derivative."""
        c, s = self.r * mp.cos(t), self.r * mp.sin(t)
        x = [p + c * a + s * b for p, a, b in zip(self.centre, self.u, self.v, strict=True)]
        along = [c * b - s * a for a, b in zip(self.u, self.v, strict=True)]
        return (x[0], x[1], x[2]), (along[0], along[1], along[2])

    def slope(self, t: mpf) -> mpf:
        """Half the derivative of the squared distance from the first circle, m^2."""
        x, along = self.point(t)
        rho = mp.sqrt(x[0] ** 2 + x[1] ** 2)
        return dot(x, along) - self.R * (x[0] * along[0] + x[1] * along[1]) / rho

    @cached_property
    def minima(self) -> list[Minimum]:
        """All minima that lie in different parts of the second circle."""
        with mp.workdps(DIGITS):
            ends = [(k + mpf("0.317")) / PARTS * 2 * mp.pi for k in range(PARTS + 1)]
            slopes = [self.slope(t) for t in ends[:-1]]
            slopes.append(slopes[0])
            return [
                self.at(self.root(ends[k], ends[k + 1], slopes[k], slopes[k + 1]))
                for k in range(PARTS)
                if slopes[k] < 0 <= slopes[k + 1]
            ]

    def root(self, low: mpf, high: mpf, at_low: mpf, at_high: mpf) -> mpf:
        """A root of the slope between two angles, by regula falsi (Illinois)."""
        change = high - low
        while at_high and abs(change) > mpf(10) ** -30:
            t = high - at_high * (high - low) / (at_high - at_low)
            value, change = self.slope(t), t - high
            if (value < 0) == (at_high < 0):
                at_low /= 2
            else:
                low, at_low = high, at_high
            high, at_high = t, value
        return high

    def beside(self, x: Array) -> Minimum:
        """What is next to a point x of the second circle; a minimum only where `gradient` is zero."""
        with mp.workdps(DIGITS):
            return self.at(self.angle(x))

    def gradient(self, x: Array) -> float:
        """Change of half the squared distance along the second circle at a point of it, m."""
        with mp.workdps(DIGITS):
            return float(self.slope(self.angle(x)) / self.r)

    def angle(self, x: Array) -> mpf:
        """Angle of a point of the second circle."""
        span = [mpf(float(a)) - p for a, p in zip(x, self.centre, strict=True)]
        at = (span[0], span[1], span[2])
        return mp.atan2(dot(at, self.v), dot(at, self.u))

    def at(self, t: mpf) -> Minimum:
        """The point of the second circle at t, and the point of the first that is nearest to it."""
        x, along = self.point(t)
        rho = mp.sqrt(x[0] ** 2 + x[1] ** 2)
        foot = (self.R * x[0] / rho, self.R * x[1] / rho, mpf(0))
        span = (x[0] - foot[0], x[1] - foot[1], x[2] - foot[2])
        arm = (x[0] - self.centre[0], x[1] - self.centre[1], x[2] - self.centre[2])
        first, second = self.R**2 + dot(foot, span), self.r**2 - dot(arm, span)
        mixed = foot[0] * along[1] - foot[1] * along[0]
        margin = (first * second - mixed**2) / (self.R * self.r) ** 2
        points = np.array([float(a) for a in (*foot, *x)])
        return Minimum(float(mp.sqrt(dot(span, span))), float(margin), points)
