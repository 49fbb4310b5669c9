"""Shapes that are a centre and a radius: a sphere, a cavity (radius negative), a point (radius 0)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Partner
from modelgen.contact.kernels import Foot
from modelgen.geometry.frames import cross, dot, zeros
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import exterior_sign
from modelgen.model import ShapeKind


def has_centre(shape: ShapeKind) -> bool:
    """Whether the shape is a sphere, a spherical cavity or a point."""
    return shape.kind == "sphere" or is_point(shape)


@dataclass(frozen=True)
class Centre:
    """The centre as a material point of its body."""

    partner: Partner
    radius: ca.SX  # (1,) m, signed
    lever: ca.SX  # (3,) m, shape axes, from the centre of mass

    @property
    def position(self) -> ca.SX:
        """(3,) m, world."""
        return self.partner.centre + ca.mtimes(self.partner.rotation, self.lever)

    @property
    def velocity(self) -> ca.SX:
        """(3,) m/s, world."""
        return self.partner.velocity + ca.mtimes(self.partner.rotation, cross(self.partner.spin, self.lever))

    def row(self, N: ca.SX) -> ca.SX:
        """Coefficients of N.velocity in u, N in world axes."""
        return self.partner.row(N, cross(self.lever, self._turned(N)))

    def pull(self, N: ca.SX) -> ca.SX:
        """N.(w x (w x lever))."""
        spin = self.partner.spin
        return -dot(cross(spin, self._turned(N)), cross(spin, self.lever))

    def foot(self, N: ca.SX, outward: int) -> Foot:
        """The contact point, which is off the centre along N (`outward` 1, on o) or against it (-1, on f)."""
        return Foot(self.lever, zeros(3), self._turned(N), outward * self.radius)

    def _turned(self, N: ca.SX) -> ca.SX:
        return ca.mtimes(self.partner.rotation.T, N)


def centre_of(partner: Partner) -> Centre:
    if is_point(partner.shape):
        return Centre(partner, zeros(1), partner.arm + partner.parameters)
    return Centre(partner, exterior_sign(partner.shape) * partner.parameters[0], partner.arm)
