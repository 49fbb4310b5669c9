"""The material of shapes as terms: functions of a point that are all negative within it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import cos, hypot, sin
from typing import NamedTuple

import numpy as np

from modelgen.geometry.composites.extrusions import outline_points
from modelgen.geometry.convex_cells import cells_of
from modelgen.geometry.shape_features import features_of
from modelgen.scene.scene_types import Shape

OUTLINE = 256  # corners of the polygon in place of a smooth outline


class Term(NamedTuple):
    """A function of points in the axes of a shape: kind and numbers as of MG_TERM_ in modelgen.h."""

    kind: str
    numbers: tuple[float, ...]


def is_thin(shape: Shape) -> bool:
    """Whether a shape has no material: curves, points and discs."""
    return shape.kind == "disc" or max(each.dimension for each in features_of(shape).features) < 2


def terms_of(shape: Shape) -> tuple[Term, ...] | None:
    """The terms of the material within a shape's surface, whether it is a cavity or not; None where no terms
    describe it."""
    if shape.chart is not None or shape.profile is not None or is_thin(shape):
        return None
    numbers = [float(value) for _, value in shape.parameters]
    if shape.kind in ("box", "polyhedron", "plane"):
        (cell,) = cells_of(replace(shape, cavity=False))
        rows = zip(cell.normals.tolist(), cell.offsets.tolist(), strict=True)
        return tuple(Term("plane", (*normal, offset)) for normal, offset in rows)
    return FORMULAS[shape.kind](numbers) if shape.kind in FORMULAS else None


def about_terms_of(shape: Shape) -> tuple[Term, ...] | None:
    """The same; of a prism over a smooth outline, those of a prism over a polygon with OUTLINE corners."""
    if shape.profile is None:
        return terms_of(shape)
    (_, length), *own = shape.parameters
    t = np.linspace(*shape.profile.domain, OUTLINE, endpoint=False)
    return _extrusion([*outline_points(shape.profile, own, t).ravel().tolist(), float(length)])


def _ends(length: float) -> tuple[Term, Term]:
    return Term("turned", (0.0, 1.0, length / 2)), Term("turned", (0.0, -1.0, length / 2))


def _cylinder(p: Sequence[float]) -> tuple[Term, ...]:
    side = Term("turned", (1.0, 0.0, p[0]))
    return (side,) if len(p) == 1 else (side, *_ends(p[1]))


def _tube(p: Sequence[float]) -> tuple[Term, ...]:
    return (Term("turned", (1.0, 0.0, p[0])), Term("turned", (-1.0, 0.0, -p[1])), *_ends(p[2]))


def _frustum(p: Sequence[float]) -> tuple[Term, ...]:
    bottom, top, length = p
    slope = (top - bottom) / length
    across = 1 / hypot(1.0, slope)
    return (Term("turned", (across, -slope * across, across * (bottom + top) / 2)), *_ends(length))


def _dome(p: Sequence[float]) -> tuple[Term, ...]:
    radius, length = p
    return (Term("ring", (0.0, radius, length - radius)), Term("turned", (0.0, -1.0, 0.0)))


def _half_torus(p: Sequence[float]) -> tuple[Term, ...]:
    return (Term("ring", (p[0], p[1], 0.0)), Term("plane", (0.0, -1.0, 0.0, 0.0)))


def _extrusion(p: Sequence[float]) -> tuple[Term, ...]:
    return (Term("polygon", tuple(p[:-1])), *_ends(p[-1]))


FORMULAS: Mapping[str, Callable[[Sequence[float]], tuple[Term, ...]]] = {
    "sphere": lambda p: (Term("ring", (0.0, p[0], 0.0)),),
    "ellipsoid": lambda p: (Term("ellipsoid", tuple(p)),),
    "superellipsoid": lambda p: (Term("superellipsoid", tuple(p)),),
    "torus": lambda p: (Term("ring", (p[0], p[1], 0.0)),),
    "half_torus": _half_torus,
    "cylinder": _cylinder,
    "tube": _tube,
    "cone": lambda p: (Term("turned", (cos(p[0]), sin(p[0]), 0.0)),),
    "frustum": _frustum,
    "dome": _dome,
    "paraboloid": lambda p: (Term("paraboloid", tuple(p)),),
    "capsule": lambda p: (Term("capsule", (p[0], p[1] / 2)),),
    "extrusion": _extrusion,
}
