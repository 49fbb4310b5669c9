"""Points of a surface in the shape frame, by parametrisation: implicit surface, chart, or plane without eta.

All three give the same quantities, so that one tangent-plane form serves them all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Partner
from modelgen.geometry.charts import Jet
from modelgen.geometry.frames import cross, dot, solve2, tangent_frame, zeros
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of


@dataclass(frozen=True)
class SurfacePoint:
    """A point of a surface in the shape frame, with its first and second order geometry."""

    x: ca.SX | None  # (3,) m; None where the partner's point decides (plane)
    normal: ca.SX  # (3,) exterior
    tangents: ca.SX  # (3,2), right-handed with the normal
    curvature: Callable[[ca.SX], ca.SX]  # orthonormal tangents T (3,2) -> K (2,2) in 1/m, positive if convex
    eta_rate: Callable[[ca.SX], ca.SX]  # tangential velocity (3,) m/s -> rate of eta
    height: ca.SX  # (1,) m, first-order distance of x from the surface along the normal
    bend: ca.SX  # (3,) 1/m, derivative of the normal along the normal


def implicit_point(partner: Partner, x: ca.SX) -> SurfacePoint:
    """eta = x in the shape frame, on phi(x) = 0: n = phi'/|phi'|, K = T^T phi'' T/|phi'|."""
    equation = surface_of(partner.shape).implicit
    assert equation is not None
    phi = equation(x, partner.parameters).times(exterior_sign(partner.shape))
    length = ca.sqrt(dot(phi.gradient, phi.gradient))
    inverse = 1 / length
    normal = phi.gradient * inverse

    def curvature(T: ca.SX) -> ca.SX:
        first, second = ca.mtimes(phi.matrix, T[:, 0]), ca.mtimes(phi.matrix, T[:, 1])
        mixed = dot(T[:, 0], second)
        bent = ca.vertcat(ca.horzcat(dot(T[:, 0], first), mixed), ca.horzcat(mixed, dot(T[:, 1], second)))
        return (phi.isotropic * ca.SX.eye(2) + bent) * inverse

    return SurfacePoint(
        x=x,
        normal=normal,
        tangents=tangent_frame(normal, partner.seam),
        curvature=curvature,
        eta_rate=lambda velocity: velocity,
        height=phi.value * inverse,
        bend=phi.hessian_times(normal) * inverse,
    )


def plane_point(partner: Partner) -> SurfacePoint:
    """No eta: the point of the plane is the foot of the partner's point."""
    sign = exterior_sign(partner.shape)
    return SurfacePoint(
        x=None,
        normal=ca.vertcat(zeros(2), sign),
        tangents=ca.vertcat(ca.horzcat(1, zeros(1)), ca.horzcat(zeros(1), sign), zeros(1, 2)),
        curvature=lambda T: zeros(2, 2),
        eta_rate=lambda velocity: ca.SX(0, 1),
        height=zeros(1),
        bend=zeros(3),
    )


@dataclass(frozen=True)
class MontanaFrame:
    """The frame [x y z] of a chart, z exterior, by Gram-Schmidt, for any regular parametrisation.

    The paper (App. E.1) has M = diag(|c_u|, |c_v|), which holds for orthogonal charts only; here M is upper
    triangular with [c_u c_v] = [x y] M, and Theorems 4.1 and 4.6 and Lemmas 4.2 and B.1 keep their form.
    A cavity turns z and with it y = z x x round.
    """

    point: ca.SX  # (3,) m
    axes: ca.SX  # (3,2) x, y
    normal: ca.SX  # (3,) z
    M: ca.SX  # (2,2) m
    K: ca.SX  # (2,2) 1/m, symmetric, positive if convex
    T: ca.SX  # (1,2) 1/m, torsion form y^T [dx] M^-1


def chart_jet(partner: Partner, uv: ca.SX) -> Jet:
    return surface_of(partner.shape).jet(uv, partner.parameters)


def chart_normal(partner: Partner, jet: Jet) -> ca.SX:
    """Exterior unit normal (3,) of a chart in the shape frame."""
    area = cross(jet.first[:, 0], jet.first[:, 1])
    return exterior_sign(partner.shape) * area / ca.sqrt(dot(area, area))


def second_form(normal: ca.SX, jet: Jet) -> ca.SX:
    """B_ab = -n . c_ab (2,2), positive if convex."""
    B = -ca.mtimes(normal.T, jet.second)
    return ca.vertcat(ca.horzcat(B[0], B[1]), ca.horzcat(B[1], B[2]))


def montana_frame(partner: Partner, uv: ca.SX) -> MontanaFrame:
    """M, K and T of a chart at uv, shape frame."""
    jet = chart_jet(partner, uv)
    z = chart_normal(partner, jet)
    length = ca.sqrt(dot(jet.first[:, 0], jet.first[:, 0]))
    x = jet.first[:, 0] / length
    y = cross(z, x)
    M = ca.vertcat(ca.horzcat(length, dot(x, jet.first[:, 1])), ca.horzcat(zeros(1), dot(y, jet.first[:, 1])))
    across = -M[0, 1] / (M[0, 0] * M[1, 1])
    inverse = ca.vertcat(ca.horzcat(1 / M[0, 0], across), ca.horzcat(zeros(1), 1 / M[1, 1]))
    K = ca.mtimes([inverse.T, second_form(z, jet), inverse])
    T = ca.mtimes([y.T, jet.second[:, 0:2], inverse]) / length
    return MontanaFrame(jet.x, ca.horzcat(x, y), z, M, K, T)


def chart_point(partner: Partner, uv: ca.SX) -> SurfacePoint:
    """eta = (u, v) of a chart; the curvature turns from the chart's frame into any other tangent frame."""
    frame = montana_frame(partner, uv)

    def curvature(T: ca.SX) -> ca.SX:
        if T is frame.axes:
            return frame.K
        turn = ca.mtimes(frame.axes.T, T)
        return ca.mtimes([turn.T, frame.K, turn])

    return SurfacePoint(
        x=frame.point,
        normal=frame.normal,
        tangents=frame.axes,
        curvature=curvature,
        eta_rate=lambda velocity: solve2(frame.M, ca.mtimes(frame.axes.T, velocity)),
        height=zeros(1),
        bend=zeros(3),
    )
