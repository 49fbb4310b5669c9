"""Surfaces as zero sets phi(x) = 0, with gradient pointing to the exterior and Hessian in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.geometry.frames import dot, zeros

TINY = 1e-18  # added where a direction is undefined: invisible beside 1e-2, its square is still a float32


@dataclass(frozen=True)
class Implicit:
    """phi and its derivatives at a point; the Hessian is `isotropic` I + `matrix`."""

    value: ca.SX  # (1,)
    gradient: ca.SX  # (3,)
    isotropic: ca.SX  # (1,)
    matrix: ca.SX  # (3,3)

    def times(self, sign: float) -> Implicit:
        return Implicit(sign * self.value, sign * self.gradient, sign * self.isotropic, sign * self.matrix)

    def hessian_times(self, v: ca.SX) -> ca.SX:
        return self.isotropic * v + ca.mtimes(self.matrix, v)


def plane(x: ca.SX, p: ca.SX) -> Implicit:
    """z = 0, exterior +z."""
    return Implicit(x[2], ca.vertcat(zeros(2), 1), zeros(1), zeros(3, 3))


def sphere(x: ca.SX, p: ca.SX) -> Implicit:
    """(|x|^2 - r^2)/2 = 0."""
    return Implicit((dot(x, x) - p[0] * p[0]) / 2, x, ca.SX(1), zeros(3, 3))


def cylinder(x: ca.SX, p: ca.SX) -> Implicit:
    """(x^2 + y^2 - r^2)/2 = 0."""
    across = ca.diag(ca.vertcat(1, 1, zeros(1)))
    g = ca.mtimes(across, x)
    return Implicit((dot(g, x) - p[0] * p[0]) / 2, g, zeros(1), across)


def cone(x: ca.SX, p: ca.SX) -> Implicit:
    """sqrt(x^2 + y^2) + z tan(half_angle) = 0, the nappe z < 0 alone; it has no gradient at the apex."""
    return _conical(x, zeros(1), ca.tan(p[0]))


def conical_side(x: ca.SX, p: ca.SX) -> Implicit:
    """sqrt(x^2 + y^2) + z taper - radius = 0, the nappe at the origin alone."""
    return _conical(x, p[0], p[1])


def _conical(x: ca.SX, radius: ca.SX, slope: ca.SX) -> Implicit:
    radial = ca.sqrt(x[0] * x[0] + x[1] * x[1])
    ex, ey = x[0] / radial, x[1] / radial
    azimuth = ca.vertcat(
        ca.horzcat(ey * ey / radial, -ex * ey / radial, zeros(1)),
        ca.horzcat(-ex * ey / radial, ex * ex / radial, zeros(1)),
        zeros(1, 3),
    )
    value = radial + x[2] * slope - radius
    return Implicit(value, ca.vertcat(ex, ey, slope), zeros(1), azimuth)


def ellipsoid(x: ca.SX, p: ca.SX) -> Implicit:
    """((x/a)^2 + (y/b)^2 + (z/c)^2 - 1)/2 = 0."""
    weights = 1 / (p * p)
    g = weights * x
    return Implicit((dot(g, x) - 1) / 2, g, zeros(1), ca.diag(weights))


def paraboloid(x: ca.SX, p: ca.SX) -> Implicit:
    """z - x^2/(2 rho_x) - y^2/(2 rho_y) = 0, exterior +z."""
    slope = x[0:2] / p
    value = x[2] - dot(slope, x[0:2]) / 2
    weights = ca.vertcat(-1 / p[0], -1 / p[1], zeros(1))
    return Implicit(value, ca.vertcat(-slope, 1), zeros(1), ca.diag(weights))


def torus(x: ca.SX, p: ca.SX) -> Implicit:
    """((sqrt(x^2 + y^2) - R)^2 + z^2 - r^2)/2 = 0; not on the axis, where no point of a torus lies."""
    radial = ca.sqrt(x[0] * x[0] + x[1] * x[1])
    ex, ey = x[0] / radial, x[1] / radial
    out = radial - p[0]
    ratio = p[0] / radial
    azimuth = ca.vertcat(
        ca.horzcat(-ratio * ey * ey, ratio * ex * ey, zeros(1)),
        ca.horzcat(ratio * ex * ey, -ratio * ex * ex, zeros(1)),
        zeros(1, 3),
    )
    value = (out * out + x[2] * x[2] - p[1] * p[1]) / 2
    return Implicit(value, ca.vertcat(out * ex, out * ey, x[2]), ca.SX(1), azimuth)


def superellipsoid(x: ca.SX, p: ca.SX) -> Implicit:
    """(|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q - 1 = 0 with p, q >= 2.

    With s = (|x/a|^p + |y/b|^p)^(1/p) and the ratios |x/a|/s, |y/b|/s in [0, 1] every power below has a
    base and an exponent that are not negative, so that nothing is undefined at zero coordinates.
    """
    P, Q = p[3], p[4]
    size = ca.fabs(x / p[0:3])
    s = (size[0] ** P + size[1] ** P) ** (1 / P)
    ratio = size[0:2] / ca.fmax(s, TINY)
    slope = ca.sign(x) / p[0:3]
    power = ratio ** (P - 1)
    gradient = ca.vertcat(Q * s ** (Q - 1) * power, Q * size[2] ** (Q - 1)) * slope
    hessian = superellipsoid_hessian(size, ca.sign(x), 1 / p[0:3], P, Q)
    return Implicit(s**Q + size[2] ** Q - 1, gradient, zeros(1), hessian)


def superellipsoid_hessian(size: ca.SX, sign: ca.SX, scale: ca.SX, P: ca.SX, Q: ca.SX) -> ca.SX:
    """Hessian (3,3) of (|X|^P + |Y|^P)^(Q/P) + |Z|^Q in x, with X = scale x and so on of size and sign."""
    s = (size[0] ** P + size[1] ** P) ** (1 / P)
    ratio = size[0:2] / ca.fmax(s, TINY)
    power = ratio ** (P - 1)
    bend, squares = Q * s ** (Q - 2), scale * scale
    axial = bend * ((P - 1) * ratio ** (P - 2) + (Q - P) * power * power) * squares[0:2]
    mixed = bend * (Q - P) * power[0] * power[1] * sign[0] * sign[1] * scale[0] * scale[1]
    vertical = Q * (Q - 1) * size[2] ** (Q - 2) * squares[2]
    return ca.vertcat(
        ca.horzcat(axial[0], mixed, zeros(1)),
        ca.horzcat(mixed, axial[1], zeros(1)),
        ca.horzcat(zeros(1, 2), vertical),
    )
