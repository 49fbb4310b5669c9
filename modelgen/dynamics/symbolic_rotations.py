"""Rotations as SX: the exponential map, and the quaternion of a rotation matrix."""

from __future__ import annotations

import casadi as ca

from modelgen.geometry.frames import is_zero, zeros

SERIES_BELOW = 1e-2  # rad^2; there the ninth term is below the rounding of every real type
SERIES_TERMS = 8


def exponential(vector: ca.SX) -> ca.SX:
    """The rotation matrix (3,3) of a rotation vector (3,) in rad, smooth at zero (Rodrigues' formula).

    About one axis of the frame alone it needs no square root.
    """
    turning = [i for i in range(3) if not is_zero(vector[i])]
    if not turning:
        return ca.SX.eye(3)
    if len(turning) == 1:
        return _about_axis(turning[0], vector[turning[0]])
    square = ca.dot(vector, vector)
    small = square < SERIES_BELOW
    angle = ca.sqrt(ca.if_else(small, 1.0, square))
    sine = ca.if_else(small, _series(square, 1), ca.sin(angle) / angle)
    versine = ca.if_else(small, _series(square, 2), (1 - ca.cos(angle)) / (angle * angle))
    skew = ca.skew(vector)
    return ca.SX.eye(3) + sine * skew + versine * ca.mtimes(skew, skew)


def _about_axis(axis: int, angle: ca.SX) -> ca.SX:
    j, k = (axis + 1) % 3, (axis + 2) % 3
    R = zeros(3, 3)
    R[axis, axis] = 1
    R[j, j] = R[k, k] = ca.cos(angle)
    R[k, j] = ca.sin(angle)
    R[j, k] = -R[k, j]
    return R


def _series(square: ca.SX, first: int) -> ca.SX:
    """sum over n of (-square)^n / (2n + first)!: sin(a)/a for first 1, (1 - cos a)/a^2 for first 2."""
    total = ca.SX(1)
    for n in range(SERIES_TERMS - 1, 0, -1):
        total = 1 - square / ((2 * n + first) * (2 * n + first - 1)) * total
    return total / first


def quaternion(R: ca.SX) -> ca.SX:
    """The unit quaternion (w, x, y, z), w >= 0, of a rotation matrix, by its largest component
    (Shepperd, J. Guidance and Control 1, 1978).
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    squares = ca.vertcat(1 + trace, *(1 + 2 * R[i, i] - trace for i in range(3)))  # 4 w^2, 4 x^2, ...
    w = (R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    xy, xz, yz = R[0, 1] + R[1, 0], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1]
    rows = (
        ca.vertcat(squares[0], w[0], w[1], w[2]),
        ca.vertcat(w[0], squares[1], xy, xz),
        ca.vertcat(w[1], xy, squares[2], yz),
        ca.vertcat(w[2], xz, yz, squares[3]),
    )
    best = rows[3]
    for i in (2, 1, 0):
        best = ca.if_else(squares[i] >= ca.mmax(squares), rows[i], best)
    sign = ca.if_else(best[0] < 0, -1.0, 1.0)
    return sign * best / ca.sqrt(ca.dot(best, best))
