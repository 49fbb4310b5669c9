"""A point by itself, the vertex of a solid: no tangent, no normal, its coordinates its only parameters."""

from __future__ import annotations

from functools import cache

import casadi as ca

from modelgen.geometry.frames import zeros
from modelgen.geometry.surface_kernel import shape_parameters
from modelgen.model import ShapeKind
from modelgen.scene.scene_types import Shape


def is_point(shape: ShapeKind | Shape) -> bool:
    """Whether the shape is a point instead of a surface or a curve."""
    return shape.kind == "point"


@cache
def point_kernel(kind: ShapeKind) -> ca.Function:
    """`mg_<kind>_point`: (s(0), parameters) -> (x(3) m, n(3) = 0), shape frame, as of a surface."""
    argument, parameters = shape_parameters(kind)
    outputs = [ca.densify(parameters), ca.densify(zeros(3))]
    inputs = [ca.SX(0, 1), argument]
    return ca.Function(f"mg_{kind.name}_point", inputs, outputs, ["s", "parameters"], ["x", "n"])
