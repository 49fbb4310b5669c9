"""Shapes as features, faces, edges and vertices, with the conditions that lead from one to the next."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from math import isfinite

from modelgen.geometry.composites import revolutions as rounds
from modelgen.geometry.composites import splines
from modelgen.geometry.composites.charts_with_ends import atlas, ends_of, has_parts
from modelgen.geometry.composites.extrusions import extrusion
from modelgen.geometry.composites.feature_constructors import at_least, at_most
from modelgen.geometry.composites.outline_features import outline, outline_wall
from modelgen.geometry.composites.polyhedra import box, polyhedron
from modelgen.geometry.composites.rounded_polylines import polyline
from modelgen.geometry.coordinate_domains import dimension_of, domain_of
from modelgen.geometry.curves import curve_of
from modelgen.scene.scene_types import Composite, Condition, Feature, Pose, Shape

__all__ = ["Composite", "Condition", "Feature", "features_of", "is_composite", "is_convex"]


def own_solid(shape: Shape) -> Composite:
    """The features that the user wrote."""
    if shape.solid is None:
        raise ValueError("a solid without features")
    return shape.solid


CONVEX = ("plane", "sphere", "ellipsoid", "superellipsoid", "cylinder", "cone", "conical_side", "point")

BUILDERS: Mapping[str, Callable[[Shape], Composite]] = {
    "box": box,
    "cylinder": rounds.cylinder,
    "disc": rounds.disc,
    "capsule": rounds.capsule,
    "tube": rounds.tube,
    "frustum": rounds.frustum,
    "cone": rounds.cone,
    "dome": rounds.dome,
    "half_torus": rounds.half_torus,
    "polyhedron": polyhedron,
    "extrusion": extrusion,
    "solid": own_solid,
    "bspline": splines.bspline,
    "height_field": splines.height_field,
    "bspline_curve": splines.bspline_curve,
    "polyline": polyline,
    "chart": atlas,
    "outline": outline,
    "outline_wall": outline_wall,
}


def is_composite(shape: Shape) -> bool:
    """Whether the shape has several features; an infinite cylinder has one, and so has a chart without
    poles and rims."""
    if shape.kind == "cylinder":
        return len(shape.parameters) == 2
    if shape.kind == "chart":
        return has_parts(shape)
    return shape.kind in BUILDERS


@lru_cache(maxsize=512)
def features_of(shape: Shape) -> Composite:
    """The features of any shape, in its own frame; a smooth shape is one feature without a name, which ends
    where its domain does.

    In a cavity the edges of a convex solid are concave: they carry no contact and are left out. The rims at
    which a chart is open are those of its cavity too.
    """
    if not is_composite(shape):
        alone = Feature("", dimension_of(shape), replace(shape, pose=Pose()), _ends(shape))
        return Composite((alone,), is_convex(shape))
    composite = BUILDERS[shape.kind](shape)
    return _hollow(composite) if shape.cavity and shape.chart is None else composite


def _ends(shape: Shape) -> tuple[Condition, ...]:
    """Ends of a chart or a curve that is not joined to itself."""
    if shape.chart is not None:
        return tuple(ends_of(shape.chart, set()))
    if dimension_of(shape) != 1 or curve_of(shape).periodic:
        return ()
    ((lower, upper),) = domain_of(shape)
    return (at_least(0, lower, None), at_most(0, upper, None)) if isfinite(lower) else ()


def is_convex(shape: Shape) -> bool:
    """Whether the material that the shape bounds is convex."""
    if shape.cavity:
        return False
    if is_composite(shape):
        return features_of(shape).convex
    if shape.kind == "paraboloid":
        return all(radius < 0 for _, radius in shape.parameters)
    return shape.kind in CONVEX


def _hollow(composite: Composite) -> Composite:
    """The faces with their exterior turned round; where there was an edge, nothing follows."""
    faces = [feature for feature in composite.features if feature.dimension == 2]
    names = {each.name for each in faces}
    return Composite(
        tuple(
            Feature(
                each.name, 2, replace(each.shape, cavity=True),
                tuple(
                    condition if condition.next in names else replace(condition, next=None)
                    for condition in each.conditions
                ),
            )
            for each in faces
        ),
        convex=False,
    )  # fmt: skip
