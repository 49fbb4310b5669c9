"""The margin to singularity of a surface-surface contact (Section 4.1.1 of the paper, scale-free)."""

from __future__ import annotations

import casadi as ca

FLOOR = 1e-30  # 1/m; keeps flat on flat at margin 0 instead of 0/0, also in single precision


def singular_values(A: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The larger and the smaller singular value of a 2x2 matrix, the latter with the sign of det A, without
    cancellation.

    A splits into a rotation-like and a reflection-like part with lengths p and q; they are p + q and |p - q|,
    the latter computed as det A/(p + q).
    """
    A = ca.densify(A)
    p = ca.sqrt((A[0, 0] + A[1, 1]) ** 2 + (A[1, 0] - A[0, 1]) ** 2) / 2
    q = ca.sqrt((A[0, 0] - A[1, 1]) ** 2 + (A[1, 0] + A[0, 1]) ** 2) / 2
    larger = p + q
    determinant = A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0]
    return larger, determinant / ca.fmax(larger, FLOOR)


def relative_curvature(K_o: ca.SX, K_f: ca.SX, d: ca.SX) -> ca.SX:
    """A' = K_f + K_o + d K_o K_f (2,2) in 1/m, the matrix of (4.1); regular where the contact is."""
    return K_f + K_o + d * ca.mtimes(K_o, K_f)


def margin(K_o: ca.SX, K_f: ca.SX, d: ca.SX) -> ca.SX:
    """(mu, sigma_min(A')) with mu = sigma_min/(|K_f| + |K_o| + |d| |K_f| |K_o|) in [-1, 1]; shared frame.

    Negative where the extremum is a saddle of the distance: the surfaces cross near points that touch so.
    """
    _, smallest = singular_values(relative_curvature(K_o, K_f, d))
    size_o, size_f = singular_values(K_o)[0], singular_values(K_f)[0]
    scale = size_f + size_o + ca.fabs(d) * size_f * size_o
    return ca.vertcat(smallest / ca.fmax(scale, FLOOR), smallest)
