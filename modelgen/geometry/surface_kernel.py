"""The kernel that evaluates a surface at (u, v), for the search of closest points and for pictures."""

from __future__ import annotations

from functools import cache

import casadi as ca

from modelgen.geometry.frames import cross, dot
from modelgen.geometry.surface_catalogue import exterior_sign, surface_of
from modelgen.model import ShapeKind


def shape_parameters(kind: ShapeKind) -> tuple[ca.SX, ca.SX]:
    """The kernel's argument and the parameter vector: the argument itself, or constants where folded."""
    if kind.folded is not None:
        return ca.SX(0, 1), ca.SX(ca.DM(list(kind.folded))) if kind.folded else ca.SX(0, 1)
    symbols = ca.SX.sym("parameters", len(kind.parameter_names))
    return symbols, symbols


@cache
def surface_kernel(kind: ShapeKind) -> ca.Function:
    """`mg_<kind>_surface`: (uv(2), parameters) -> (x(3) m, n(3) unit exterior normal), shape frame."""
    argument, parameters = shape_parameters(kind)
    uv = ca.SX.sym("uv", 2)
    jet = surface_of(kind).jet(uv, parameters)
    normal = cross(jet.first[:, 0], jet.first[:, 1])
    normal = exterior_sign(kind) * normal / ca.sqrt(dot(normal, normal))
    outputs = ca.cse([ca.densify(jet.x), ca.densify(normal)])
    return ca.Function(f"mg_{kind.name}_surface", [uv, argument], outputs, ["uv", "parameters"], ["x", "n"])
