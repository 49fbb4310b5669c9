"""The margin to singularity of a contact (Sections 4.1.1, 4.2.2 and 4.3 of the paper, scale-free).

Its sign tells minima of the distance from other extrema by the second-order condition: for d >= 0,
|P_f - P_o|^2 is least where C = I + d K_o and A' C^-1 = K_f + K_o C^-1 are positive definite (of curves,
where their matrix is). Below contact, where the sign at d = 0 is continued, A' alone decides.
"""

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


def _signed(size: ca.SX, *positive: ca.SX) -> ca.SX:
    """`size`, with a minus unless all others are positive."""
    worst = positive[0]
    for other in positive[1:]:
        worst = ca.fmin(worst, other)
    return ca.if_else(worst > 0, size, -ca.fabs(size))


def _parallel(K_o: ca.SX, d: ca.SX) -> tuple[ca.SX, ...]:
    """Determinant and trace of C for d >= 0: positive short of the first focal point."""
    if is_zero(K_o):
        return ()
    C = ca.SX.eye(2) + ca.fmax(d, 0) * K_o
    return C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0], C[0, 0] + C[1, 1]


def curve_margin(K_o: ca.SX, matrix: ca.SX, e: ca.SX, beta: ca.SX, d: ca.SX) -> ca.SX:
    """(mu, S/(1 + |d| |K_o|)^2) of a curve on a surface (Section 4.3), S = det(matrix)/|e|^4 in 1/m.

    mu = S over the sum of what |S| could be, in [-1, 1]: |kappa_f| (1 + |d||K_o|)^2 + |K_o| (1 + |d||K_o|).
    """
    matrix = ca.densify(matrix)
    size = dot(e, e)
    S = (matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]) / (size * size)
    S = _signed(S, S, *_parallel(K_o, d))
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
    return ca.vertcat(_signed(mu, product - square, bent_o), NO_LENGTH)


def centre_margin(K: ca.SX, radius: ca.SX, d: ca.SX) -> ca.SX:
    """`margin` of a surface and a sphere of signed radius: A' = (I + (d + radius) K)/radius.

    Of a point, radius zero, mu = sigma_min(I + d K)/(1 + |d| |K|), and nothing is flat.
    """
    if not is_zero(radius):
        return margin(K, ca.SX.eye(2) / radius, d)
    C = ca.SX.eye(2) + d * K
    smallest = singular_values(C)[1]
    smallest = _signed(smallest, smallest, C[0, 0] + C[1, 1])
    return ca.vertcat(smallest / (1 + ca.fabs(d) * singular_values(K)[0]), NO_LENGTH)


def margin(K_o: ca.SX, K_f: ca.SX, d: ca.SX) -> ca.SX:
    """(mu, sigma_min(A')) with mu = sigma_min/(|K_f| + |K_o| + |d| |K_f| |K_o|) in [-1, 1]; shared frame.

    Negative where the extremum is no minimum of the distance: surfaces that touch so cross near the points.
    """
    A = relative_curvature(K_o, K_f, d)
    _, smallest = singular_values(A)
    smallest = _signed(smallest, smallest, A[0, 0] + A[1, 1], *_parallel(K_o, d))
    size_o, size_f = singular_values(K_o)[0], singular_values(K_f)[0]
    scale = size_f + size_o + ca.fabs(d) * size_f * size_o
    return ca.vertcat(smallest / ca.fmax(scale, FLOOR), smallest)
