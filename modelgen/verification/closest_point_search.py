"""Formulas of the search for closest points (first normal, separation function) beside independent routes."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from modelgen.verification.contacts import sample
from modelgen.verification.extremal_motion import columns, repeated
from modelgen.verification.findings import Finding, compared
from modelgen.verification.random_configurations import Partnership


def check_search(role: str, function: ca.Function, pair: Partnership, n: int, seed: int) -> list[Finding]:
    """The separation function by differentiation of itself; the start of the search on known pairs."""
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
