"""Unit quaternions (w, x, y, z) as plain numbers: products and what they do to vectors."""

from __future__ import annotations

from modelgen.scene.scene_types import Matrix, Vector

Quaternion = tuple[float, float, float, float]


def conjugate(q: Quaternion) -> Quaternion:
    """The inverse turn."""
    return q[0], -q[1], -q[2], -q[3]


def product(p: Quaternion, q: Quaternion) -> Quaternion:
    """First q, then p."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def rows_of(q: Quaternion) -> Matrix:
    """The rotation matrix, row by row."""
    w, x, y, z = q
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def turned(q: Quaternion, v: Vector) -> Vector:
    """The vector turned by q."""
    x, y, z = (sum(a * b for a, b in zip(row, v, strict=True)) for row in rows_of(q))
    return x, y, z
