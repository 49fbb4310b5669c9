"""Support maps of convex shapes and plane convex curves: the point where the exterior normal is n.

A support is a core point plus `offset` times n. The offset moves the surface along its normal and changes
neither levers x cross n nor, against a plane, any rate, so kernels leave it out of the core point.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from modelgen.geometry.frames import dot, zeros
from modelgen.geometry.implicit_surfaces import TINY, superellipsoid_hessian


@dataclass(frozen=True)
class Support:
    """The support map at a unit normal n in the shape frame."""

    core: ca.SX  # (3,) m
    offset: ca.SX  # (1,) m
    height: ca.SX  # (1,) m, n . core
    form: Callable[[ca.SX], ca.SX]  # m (3,), tangential -> m . (d core/dn) m, m
    slope: Callable[[ca.SX], ca.SX]  # m (3,), tangential -> (d core/dn) m, m


def sphere(n: ca.SX, p: ca.SX) -> Support:
    return Support(zeros(3), p[0], zeros(1), lambda m: zeros(1), lambda m: zeros(3))


def point(n: ca.SX, p: ca.SX) -> Support:
    return Support(p, zeros(1), dot(n, p), lambda m: zeros(1), lambda m: zeros(3))


def ellipsoid(n: ca.SX, p: ca.SX) -> Support:
    """x = D n / h with D = diag(a^2, b^2, c^2) and h = sqrt(n.D n)."""
    squares = p * p
    scaled = squares * n
    height = ca.sqrt(dot(n, scaled))
    inverse = 1 / height
    x = scaled * inverse
    return Support(
        x, zeros(1), height,
        lambda m: (dot(m, squares * m) - dot(x, m) ** 2) * inverse,
        lambda m: (squares * m - x * dot(x, m)) * inverse,
    )  # fmt: skip


def torus(n: ca.SX, p: ca.SX) -> Support:
    """The outer part: the support of the circle of tube centres, offset by the tube's radius."""
    nx = n[0] + TINY
    across = ca.sqrt(nx * nx + n[1] * n[1])
    ex, ey = nx / across, n[1] / across
    core = ca.vertcat(p[0] * ex, p[0] * ey, zeros(1))
    return Support(
        core, p[1], p[0] * across,
        lambda m: p[0] / across * (m[1] * ex - m[0] * ey) ** 2,
        lambda m: p[0] / across * (m[1] * ex - m[0] * ey) * ca.vertcat(-ey, ex, zeros(1)),
    )  # fmt: skip


def circle(n: ca.SX, p: ca.SX) -> Support:
    """The circle of `torus` by itself."""
    tube = torus(n, ca.vertcat(p[0], zeros(1)))
    return Support(tube.core, zeros(1), tube.height, tube.form, tube.slope)


def ellipse(n: ca.SX, p: ca.SX) -> Support:
    """x = (a^2 n_x, b^2 n_y, 0)/h, h = sqrt(a^2 n_x^2 + b^2 n_y^2); form (a b (m_x n_y - m_y n_x))^2/h^3."""
    nx = n[0] + TINY
    h = ca.sqrt((p[0] * nx) ** 2 + (p[1] * n[1]) ** 2)
    core = ca.vertcat(p[0] ** 2 * nx / h, p[1] ** 2 * n[1] / h, zeros(1))
    return Support(
        core, zeros(1), h,
        lambda m: (p[0] * p[1] * (m[0] * n[1] - m[1] * nx)) ** 2 / h**3,
        lambda m: (p[0] * p[1]) ** 2 * (m[0] * n[1] - m[1] * nx) / h**3 * ca.vertcat(n[1], -nx, zeros(1)),
    )  # fmt: skip


def superellipsoid(n: ca.SX, p: ca.SX) -> Support:
    """The gradient of the dual gauge h = ((|a n_x|^P + |b n_y|^P)^(Q/P) + |c n_z|^Q)^(1/Q).

    P = p/(p-1) and Q = q/(q-1). h^Q - 1 is the equation of a superellipsoid too; with its Hessian H,
    h'' = H/(Q h^(Q-1)) - (Q-1) x x^T/h. h'' has no bound where a curvature of the shape vanishes: sizes
    |a n_x| count as `TINY` at least, so that it is finite, and that product is zero for an m_x of zero.
    """
    P, Q = p[3] / (p[3] - 1), p[4] / (p[4] - 1)
    size, sign = ca.fabs(p[0:3] * n), ca.sign(n)
    s = (size[0] ** P + size[1] ** P) ** (1 / P)
    height = (s**Q + size[2] ** Q) ** (1 / Q)
    across = (s / height) ** (Q - 1) * (size[0:2] / ca.fmax(s, TINY)) ** (P - 1)
    x = ca.vertcat(across, (size[2] / height) ** (Q - 1)) * p[0:3] * sign
    hessian = superellipsoid_hessian(ca.fmax(size, TINY), sign, p[0:3], P, Q) / (Q * height ** (Q - 1))

    def slope(m: ca.SX) -> ca.SX:
        return ca.mtimes(hessian, m) - (Q - 1) / height * dot(x, m) * x

    return Support(x, zeros(1), height, lambda m: dot(m, slope(m)), slope)
