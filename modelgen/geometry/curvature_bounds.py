"""Bounds of the curvatures of shapes, and what follows for how often two of them can touch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf

from modelgen.geometry.shape_features import is_convex
from modelgen.scene.scene_types import Shape

STRAIGHT = ("point", "line", "segment", "edge")  # convex, though they bound no material

Bounds = tuple[float, float]  # least and largest normal curvature, 1/m, positive towards the centre of a ball


def _ellipsoid(p: Sequence[float]) -> Bounds:
    return min(p) / max(p) ** 2, max(p) / min(p) ** 2


_BOUNDS: Mapping[str, Callable[[Sequence[float]], Bounds]] = {
    "plane": lambda p: (0.0, 0.0),
    "sphere": lambda p: (1 / p[0], 1 / p[0]),
    "ellipsoid": _ellipsoid,
    "cylinder": lambda p: (0.0, 1 / p[0]),
    "paraboloid": lambda p: (0.0, 1 / min(abs(value) for value in p)),
}


def curvature_bounds(shape: Shape) -> Bounds:
    """Least and largest |normal curvature| of a shape that curves one way only; (0, inf) if not known."""
    if shape.kind == "cylinder" and len(shape.parameters) > 1:
        return 0.0, inf
    found = _BOUNDS.get(shape.kind)
    return found([value for _, value in shape.parameters]) if found else (0.0, inf)


def is_hollow(shape: Shape) -> bool:
    """Whether the shape is the inside of a convex body, known by its curvature bounds."""
    if shape.kind == "paraboloid":
        bowl = all(value > 0 for _, value in shape.parameters)
        return bowl != shape.cavity and (bowl or all(value < 0 for _, value in shape.parameters))
    return shape.cavity and shape.kind in ("sphere", "ellipsoid", "cylinder")


def touches_once(a: Shape, b: Shape) -> bool:
    """Whether two shapes touch in one point at a time.

    Convex bodies do, and one that is everywhere more curved than the hollow in which it lies (Blaschke's
    rolling theorem). In a hollow the distance may have several minima.
    """
    if all(is_convex(shape) or shape.kind in STRAIGHT for shape in (a, b)):
        return True
    return any(
        is_hollow(outer) and is_convex(inner) and curvature_bounds(outer)[1] <= curvature_bounds(inner)[0]
        for outer, inner in ((a, b), (b, a))
    )
