"""The margin to singularity of a contact (Sections 4.1.1, 4.2.2 and 4.3 of the paper, scale-free)."""

from __future__ import annotations

import casadi as ca

from modelgen.geometry.frames import dot, is_zero, zeros

NO_LENGTH = 1e30  # 1/m; a margin that no characteristic length brings below the scale-free one
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


def curve_margin(K_o: ca.SX, matrix: ca.SX, e: ca.SX, beta: ca.SX, d: ca.SX) -> ca.SX:
    """(mu, |S|/(1 + |d| |K_o|)^2) of a curve on a surface (Section 4.3), S = det(matrix)/|e|^4 in 1/m.

    mu = |S| over the sum of what S could be, in [0, 1]: |kappa_f| (1 + |d||K_o|)^2 + |K_o| (1 + |d||K_o|).
    """
    matrix = ca.densify(matrix)
    size = dot(e, e)
    S = ca.fabs(matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]) / (size * size)
    k = zeros(1) if is_zero(K_o) else singular_values(K_o)[0]
    stretch = 1 + ca.fabs(d) * k
    scale = ca.fabs(beta) / size * stretch * stretch + k * stretch
    return ca.vertcat(S / ca.fmax(scale, FLOOR), S / (stretch * stretch))


def crossing_margin(bent_o: ca.SX, bent_f: ca.SX, cosine: ca.SX) -> ca.SX:
    """(mu, none) of two curves: D = (1 + d kappa_o)(1 + d kappa_f) - cos(psi)^2 over what it could be.

    D has no unit and a curve no flatness, so that nothing is measured against a length.
    """
    product, square = bent_o * bent_f, cosine * cosine
    mu = ca.fabs(product - square) / (ca.fabs(product) + square)
    return ca.vertcat(mu, NO_LENGTH)


def margin(K_o: ca.SX, K_f: ca.SX, d: ca.SX) -> ca.SX:
    """(mu, sigma_min(A')) with mu = sigma_min/(|K_f| + |K_o| + |d| |K_f| |K_o|) in [-1, 1]; shared frame.

    Negative where the extremum is a saddle of the distance: the surfaces cross near points that touch so.
    """
    _, smallest = singular_values(relative_curvature(K_o, K_f, d))
    size_o, size_f = singular_values(K_o)[0], singular_values(K_f)[0]
    scale = size_f + size_o + ca.fabs(d) * size_f * size_o
    return ca.vertcat(smallest / ca.fmax(scale, FLOOR), smallest)
