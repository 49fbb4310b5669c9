"""The formulas of shapes, of searches for contact points, and of loads against independent routes."""

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
from modelgen.verification.random_configurations import Partnership

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


def check_search(role: str, function: ca.Function, pair: Partnership, n: int, seed: int) -> list[Finding]:
    """The separation function by differentiation of itself; the start of the search on known pairs."""
    from modelgen.verification.contacts import sample

    drawn = sample(pair, n, seed)
    at, known, numbers = drawn.at, drawn.truth, repeated(pair.parameters, drawn.n)
    near = np.concatenate([known.x_o, known.x_f])
    if role == "aim":
        normal = columns(function, at.pose_o, at.pose_f, near, numbers)[0]
        return [
            compared("normal", "N of extremal pairs", normal / np.linalg.norm(normal, axis=0), known.normal)
        ]
    d, slope, bend, tangents, eta = columns(function, at.pose_o, at.pose_f, known.normal, numbers)
    second = columns(_second(function), at.pose_o, at.pose_f, known.normal, numbers, tangents)[0]
    return [
        compared("d", "the construction of the pair", d + pair.length, known.d[None] + pair.length),
        compared("slope", "zero on extremal pairs", slope / pair.length + 1, np.ones_like(slope)),
        compared("bend", "minus the second derivative of d on the sphere of normals", bend, second),
        compared("eta", "the contact points", eta, near),
    ]


@cache
def _second(function: ca.Function) -> ca.Function:
    """-d'' on the unit sphere in the tangents T, as 11, 12, 22: -(T^T d_nn T - (d_n.n) I)."""
    given = [ca.SX.sym(name, function.size1_in(k)) for k, name in enumerate(function.name_in())]
    tangents = ca.SX.sym("T", 6)
    free = ca.SX.sym("ab", 2)
    T = ca.reshape(tangents, 3, 2)
    n = given[2] + T @ free
    d = function.call([given[0], given[1], n / ca.norm_2(n), given[3]])[0]
    H = ca.substitute(ca.hessian(d, free)[0], free, ca.SX.zeros(2))
    return ca.Function("second", [*given, tangents], [-ca.vertcat(H[0, 0], H[0, 1], H[1, 1])])
