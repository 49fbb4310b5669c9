"""Rigid motions and frames as SX, with structural zeros where something vanishes identically."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

POSE_SIZE = 12
TWIST_SIZE = 6


@dataclass(frozen=True)
class Frame:
    """A frame in another one."""

    position: ca.SX  # (3,) m
    rotation: ca.SX  # (3,3), this frame -> the other

    @property
    def is_identity(self) -> bool:
        return bool(self.rotation.is_eye()) and self.position.nnz() == 0


def zeros(rows: int, columns: int = 1) -> ca.SX:
    """Structural zeros: products with them vanish from the expression."""
    return ca.SX(rows, columns)


def identity_frame() -> Frame:
    return Frame(zeros(3), ca.SX.eye(3))


def frame_of(pose: ca.SX) -> Frame:
    """The frame of a pose vector (12,): position, then rotation column by column."""
    return Frame(pose[0:3], ca.reshape(pose[3:12], 3, 3))


def cross(a: ca.SX, b: ca.SX) -> ca.SX:
    """Cross product of vectors (3,)."""
    return ca.cross(a, b)


def dot(a: ca.SX, b: ca.SX) -> ca.SX:
    return ca.mtimes(a.T, b)


SEAM = -0.38  # a latitude that no cylinder, equator or plane has its normals on


def tangent_frame(n: ca.SX, seam: float = 0.0) -> ca.SX:
    """Two unit vectors (3,2) that complete the unit vector n to a right-handed frame [t1 t2 n].

    Without branches and without a singular direction (Duff et al., Building an Orthonormal Basis,
    Revisited, JCGT 6(1), 2017); it jumps where n_z passes `seam`, so nothing may depend on which it is.
    """
    sign = 2 * (n[2] >= seam) - 1
    a = -1 / (sign + n[2])
    b = n[0] * n[1] * a
    t1 = ca.vertcat(1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0])
    t2 = ca.vertcat(b, sign + n[1] * n[1] * a, -n[1])
    return ca.horzcat(t1, t2)


def frame_spin(n: ca.SX, rate: ca.SX, seam: float = 0.0) -> ca.SX:
    """t1_dot.t2 of `tangent_frame` when n moves with the given rate (3,): how fast the frame turns about n.

    The frame is that of a pole +-z carried along the great circle to n, without turning on the way.
    """
    sign = 2 * (n[2] >= seam) - 1
    return -1 / (sign + n[2]) * (n[0] * rate[1] - n[1] * rate[0])


def solve2(A: ca.SX, b: ca.SX) -> ca.SX:
    """Solution of a 2x2 system by Cramer's rule; b may have several columns."""
    adjugate = ca.vertcat(ca.horzcat(A[1, 1], -A[0, 1]), ca.horzcat(-A[1, 0], A[0, 0]))
    determinant = A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
    return ca.mtimes(adjugate, b) / determinant


def is_zero(x: ca.SX) -> bool:
    """True where x vanishes structurally."""
    return int(ca.sparsify(x).nnz()) == 0
