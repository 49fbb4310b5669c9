"""A side of a contact as a map alpha -> point, with 2, 1 or 0 coordinates: surface, curve, point.

Only the definition c(alpha) of a shape is taken from the package; every derivative is algorithmic.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import casadi as ca

from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.model import ShapeKind

INSET = 0.15  # share of a bounded range kept away from its ends, where charts have poles


@dataclass(frozen=True)
class Feature:
    """A shape, and the ranges that its coordinates are drawn from."""

    shape: ShapeKind
    ranges: tuple[tuple[float, float], ...]

    @property
    def dimension(self) -> int:
        return len(self.ranges)

    def point(self, alpha: ca.SX, p: ca.SX) -> ca.SX:
        """c(alpha) (3,) m, shape frame."""
        if is_point(self.shape):
            return p
        if is_curve(self.shape):
            return curve_of(self.shape).components(alpha, p)
        return surface_of(self.shape).jet(alpha, p).x

    def normal(self, tangents: ca.SX) -> ca.SX:
        """Exterior unit normal (3,) of a surface from its tangents (3,2)."""
        area = exterior_sign(self.shape) * ca.cross(tangents[:, 0], tangents[:, 1])
        return area / ca.norm_2(area)


def feature_of(shape: ShapeKind, length: float) -> Feature:
    """`length` (m) takes the place of a bound that is none."""
    if is_point(shape):
        return Feature(shape, ())
    if is_curve(shape):
        curve = curve_of(shape)
        return Feature(shape, (_range(curve.domain, curve.periodic, length),))
    surface = surface_of(shape)
    sides = zip(surface.domain, surface.periodic, strict=True)
    return Feature(shape, tuple(_range(domain, periodic, length) for domain, periodic in sides))


def _range(domain: tuple[float, float], periodic: bool, length: float) -> tuple[float, float]:
    low, high = domain
    if not isfinite(low) and not isfinite(high):
        return -length, length
    low = low if isfinite(low) else high - 3 * length
    high = high if isfinite(high) else low + 3 * length
    inset = 0.0 if periodic else INSET * (high - low)
    return low + inset, high - inset
