"""Over which coordinates a smooth shape extends."""

from __future__ import annotations

from math import isfinite

from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import ShapeKind
from modelgen.scene.scene_types import Shape


def dimension_of(shape: ShapeKind | Shape) -> int:
    """2 of a surface, 1 of a curve, 0 of a point."""
    return 0 if is_point(shape) else 1 if is_curve(shape) else 2


def domain_of(shape: Shape) -> tuple[tuple[float, float], ...]:
    """The bounds of each coordinate of a smooth shape; a straight edge's are those of its length."""
    if is_point(shape):
        return ()
    if shape.kind == "edge":
        half = shape.parameters[0][1] / 2
        return ((-half, half),)
    return (curve_of(shape).domain,) if is_curve(shape) else surface_of(shape).domain


def domain_within(shape: Shape, reach: float) -> tuple[tuple[float, float], ...]:
    """The same bounds, those that are infinite replaced by `reach`, m, to either side."""
    return tuple(
        (lower if isfinite(lower) else -reach, upper if isfinite(upper) else reach)
        for lower, upper in domain_of(shape)
    )
