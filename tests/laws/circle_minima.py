"""All minima of the distance of two circles in space, in 50 digits, independent of the project's code.

The distance of a point of the second circle from the first one is known in closed form; its derivative along
the second circle changes its sign at each minimum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf

from tests.laws.exhaustive_minima import Array

DIGITS = 50
PARTS = 2000

Vector = tuple[mpf, mpf, mpf]


def dot(a: Vector, b: Vector) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@dataclass(frozen=True)
class CirclePair:
    """A circle of radius R about the z axis of the first body, one of radius r about that of the second.

    pose: position and rotation by columns of the second body in the axes of the first.
    """

    R: float
    r: float
    pose: Array

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Centre, and the two radii of the second circle along its axes, m; the radii are made normal."""
        at = [mpf(float(x)) for x in self.pose]
        u, v = at[3:6], at[6:9]
        u = [x / mp.sqrt(dot(u, u)) for x in u]
        v = [x - dot(u, v) * y for x, y in zip(v, u, strict=True)]
        v = [x / mp.sqrt(dot(v, v)) for x in v]
        return tuple(at[:3]), tuple(self.r * x for x in u), tuple(self.r * x for x in v)

    def point(self, t: mpf, order: int = 0) -> Vector:
        """Point of the second circle at an angle, or its derivative."""
        centre, u, v = self.axes_now
        c, s = mp.cos(t + order * mp.pi / 2), mp.sin(t + order * mp.pi / 2)
        return tuple((a if not order else 0) + b * c + d * s for a, b, d in zip(centre, u, v, strict=True))

    def slope(self, t: mpf) -> mpf:
        """Half the derivative of the squared distance from the first circle, m^2."""
        x, along = self.point(t), self.point(t, 1)
        rho = mp.sqrt(x[0] ** 2 + x[1] ** 2)
        return dot(x, along) - self.R * (x[0] * along[0] + x[1] * along[1]) / rho

    def minima(self) -> list[Minimum]:
        """All minima that lie in different parts of the second circle."""
        with mp.workdps(DIGITS):
            object.__setattr__(self, "axes_now", self.axes)
            ends = [mpf(k + mpf("0.317")) / PARTS * 2 * mp.pi for k in range(PARTS + 1)]
            slopes = [self.slope(t) for t in ends[:-1]]
            slopes.append(slopes[0])
            return [
                self.at(self.root(ends[k], ends[k + 1], slopes[k], slopes[k + 1]))
                for k in range(PARTS)
                if slopes[k] < 0 <= slopes[k + 1]
            ]

    def root(self, low: mpf, high: mpf, at_low: mpf, at_high: mpf) -> mpf:
        """A root of the slope between two angles by regula falsi (Illinois)."""
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

    def at(self, t: mpf) -> Minimum:
        """The point of the second circle at t, and the nearest point of the first."""
        x = self.point(t)
        rho = mp.sqrt(x[0] ** 2 + x[1] ** 2)
        near = (self.R * x[0] / rho, self.R * x[1] / rho, mpf(0))
        span = tuple(a - b for a, b in zip(x, near, strict=True))
        centre = self.axes_now[0]
        first = self.R**2 + dot(near, span)
        second = self.r**2 - dot(tuple(a - b for a, b in zip(x, centre, strict=True)), span)
        along = self.point(t, 1)
        mixed = -near[1] * along[0] + near[0] * along[1]
        margin = (first * second - mixed**2) / (self.R * self.r) ** 2
        return Minimum(
            float(mp.sqrt(dot(span, span))), float(margin), np.array([float(a) for a in (*near, *x)])
        )


@dataclass(frozen=True)
class Minimum:
    """One minimum: distance (m), how regular it is, and both points (m, axes of the first body)."""

    distance: float
    margin: float  # determinant of the second derivatives by the angles over (R r)^2
    points: Array  # (6,)
