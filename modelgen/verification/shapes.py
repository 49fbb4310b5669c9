"""The formulas of shapes against their definitions and algorithmic derivatives."""

from __future__ import annotations

from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.model import ShapeKind
from modelgen.verification.contact_sides import feature_of
from modelgen.verification.extremal_motion import columns, repeated
from modelgen.verification.findings import Finding, compared

Array = np.ndarray[Any, Any]


def check_shape(
    function: ca.Function, shape: ShapeKind, numbers: tuple[float, ...], n: int, seed: int
) -> list[Finding]:
    """x and the normal, tangent or nothing of a shape with the given lengths."""
    feature = feature_of(shape, 1.0)
    random = np.random.default_rng(seed)
    alpha = np.array([random.uniform(*ends, n) for ends in feature.ranges]).reshape(-1, n)
    lengths = repeated(np.array(shape.folded if shape.folded is not None else numbers, dtype=float), n)
    if not feature.dimension:
        return [
            compared(
                "x",
                "the coordinates of the point",
                np.tile(np.array(function(ca.DM(0, 1), numbers[:3])[0]), n),
                lengths,
            )
        ]
    found = columns(function, alpha, lengths)
    points, axes = columns(_differentiated(shape), alpha, lengths)
    name, how = "tangent", "algorithmic derivative of c(t)"
    if feature.dimension == 2:
        implicit = surface_of(shape).implicit is not None
        name, how = "n", "gradient of the equation" if implicit else "cross product of the tangents"
    return [compared("x", "definition of the shape", found[0], points), compared(name, how, found[1], axes)]


@cache
def _differentiated(shape: ShapeKind) -> ca.Function:
    """(alpha, lengths) -> point, and exterior normal or derivative."""
    feature = feature_of(shape, 1.0)
    size = len(shape.folded) if shape.folded is not None else len(shape.parameter_names)
    alpha, p = ca.SX.sym("alpha", feature.dimension), ca.SX.sym("p", size)
    x = ca.densify(feature.point(alpha, p))
    axis = ca.jacobian(x, alpha)
    if feature.dimension == 2:
        equation = surface_of(shape).implicit
        axis = feature.normal(axis)
        if equation is not None:
            place = ca.SX.sym("x", 3)
            gradient = exterior_sign(shape) * ca.gradient(equation(place, p).value, place)
            axis = ca.substitute(gradient / ca.norm_2(gradient), place, x)
    return ca.Function("shape", [alpha, p], [x, ca.densify(axis)])
