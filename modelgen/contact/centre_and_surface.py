"""A centre over a surface: Theorem 4.1 for a partner whose curvature is the same in all directions.

The centre C lies on the normal of the surface's point x, C = x + h n with h = d + rho: rho is the radius,
negative for a cavity, 0 for a point, and n the exterior normal of the surface, N or -N as it stands for o or
f. With V the velocity of C seen from the surface, w^t = w x n, l = C from the centre of mass of its body,

    (I + h K) a = V,   nu = K a,   d_dot = n.V,
    gamma = nu.V + w^t.(2 V + w x l) + n.(w_c x (w_c x l_c))

It is singular at focal distances only; a sphere and a point have no other.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.contact.contact_symbols import Pair, Partner
from modelgen.contact.kernels import Foot, Placement, Rates
from modelgen.contact.singularity_margin import centre_margin
from modelgen.contact.sphere_centres import Centre, centre_of, has_centre
from modelgen.contact.surface_points import SurfacePoint
from modelgen.contact.tangent_plane_form import spin_along
from modelgen.geometry.frames import cross, dot, solve2


@dataclass(frozen=True)
class Facing:
    """The two sides as surface and centre; vectors in the axes of the surface's shape if nothing is said."""

    surface: Partner
    centre: Centre
    x: ca.SX  # (3,) m, the point of the surface
    side: int  # of N against the surface's exterior normal: 1 on o, -1 on f
    lever: ca.SX  # (3,) m, of the centre from the surface's centre of mass
    h: ca.SX  # (1,) m, height of the centre over the point
    U: ca.SX  # (2,2) I + h K
    K: ca.SX  # (2,2) 1/m
    offset: ca.SX  # (3,) m, from the point to the centre
    N: ca.SX  # (3,) world, the surface's exterior normal

    @property
    def d(self) -> ca.SX:
        return self.h - self.centre.radius


def facing(pair: Pair, point: SurfacePoint) -> Facing:
    """The centre seen from the point of the surface, which is on f if o has the centre."""
    swapped = not has_centre(pair.f.shape)
    surface, centre = (pair.f, centre_of(pair.o)) if swapped else (pair.o, centre_of(pair.f))
    assert point.x is not None
    lever = ca.mtimes(surface.rotation.T, centre.position - surface.centre)
    offset = lever - surface.arm - point.x
    h, K = dot(point.normal, offset), point.curvature(point.tangents)
    N = ca.mtimes(surface.rotation, point.normal)
    side, U = -1 if swapped else 1, ca.SX.eye(2) + h * K
    return Facing(surface, centre, point.x, side, lever, h, U, K, offset, N)


def centre_surface_rates(pair: Pair, point: SurfacePoint) -> Rates:
    """Lemma 3.1, corrected Corollary 3.2 and Theorem 4.1 with the centre in the place of f's point."""
    at = facing(pair, point)
    T, surface, side = point.tangents, at.surface, at.side
    turn, slip = spin_along(surface, T, at.lever)
    past = ca.mtimes(surface.rotation.T, at.centre.velocity - surface.velocity)
    V = ca.mtimes(T.T, past) - slip
    a = solve2(at.U, V)
    nu = ca.mtimes(at.K, a)
    row = surface.row(-at.N, -cross(at.lever, point.normal)), at.centre.row(at.N)
    N, turned, slide = side * at.N, ca.mtimes(T, nu), ca.mtimes(T, a)
    N_dot = side * ca.mtimes(surface.rotation, turned + cross(surface.spin, point.normal))
    feet = Foot(at.x + surface.arm, slide, side * point.normal), at.centre.foot(N, -side)
    steps = {"normal": N, "l": at.lever, "h": at.h, "K": at.K, "V": V, "slide": a, "nu": nu}
    return Rates(
        d=at.d,
        J_o=row[0 if side == 1 else 1],
        J_f=row[1 if side == 1 else 0],
        gamma=dot(nu, V) + dot(turn, 2 * V + slip) + at.centre.pull(at.N),
        eta_dot=point.eta_rate(slide),
        normal=N,
        normal_rate=N_dot,
        turning=turned if side == 1 else pair.o.seen(N, N_dot),
        foot_o=feet[0 if side == 1 else 1],
        foot_f=feet[1 if side == 1 else 0],
        steps=steps,
    )


def centre_surface_place(pair: Pair, point: SurfacePoint) -> Placement:
    """Newton step on e = T^T (C - x) and the height of the point over its surface."""
    at = facing(pair, point)
    T = point.tangents
    e = ca.mtimes(T.T, at.offset)
    a = solve2(at.U, e + at.h * point.height * ca.mtimes(T.T, point.bend))
    step = point.eta_rate(ca.mtimes(T, a) - point.height * point.normal)
    on_surface = at.surface.origin + ca.mtimes(at.surface.rotation, at.x)
    on_centre = at.centre.position - at.centre.radius * at.N
    points = (on_surface, on_centre)[:: at.side]
    return Placement(
        eta_next=pair.eta + step,
        d=at.d,
        residual=ca.vertcat(ca.sqrt(dot(e, e) + point.height * point.height), 0),
        margin=centre_margin(at.K, at.centre.radius, at.d),
        normal=at.side * at.N,
        point_o=points[0],
        point_f=points[1],
    )
