"""SymPy's closed forms of a shape against what the formulas of the contacts take of it."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import sympy as sp

from modelgen.contact.contact_symbols import partner
from modelgen.contact.normal_row import jet_of_curve
from modelgen.contact.paper_curves import strand
from modelgen.contact.surface_points import chart_jet, montana_frame, second_form
from modelgen.model import ShapeKind, Side
from modelgen.verification.contact_sides import feature_of
from modelgen.verification.extremal_motion import columns
from modelgen.verification.findings import Finding, compared
from modelgen.verification.fundamental_forms import ClosedForms
from modelgen.verification.sympy_evaluation import value_of

Array = np.ndarray[Any, Any]
ROUTE = "CasADi's expression at random points"
STAGES = (("I", ("E", "F", "F", "G")), ("II", ("L", "M", "M", "N")))


def check_forms(forms: ClosedForms, numbers: tuple[float, ...], n: int, seed: int) -> list[Finding]:
    """Check each closed form at n random points of the scene's own shape."""
    feature = feature_of(forms.shape, 1.0)
    random = np.random.default_rng(seed)
    points = np.array([random.uniform(*ends, n) for ends in feature.ranges])
    function = _taken(forms.shape)
    given = np.tile(np.reshape(numbers, (-1, 1)), (1, n))
    wanted = dict(zip(function.name_out(), columns(function, points, given), strict=True))
    found: dict[str, list[list[float]]] = {}
    for point in points.T:
        symbols = (*forms.coordinates, *forms.parameters)
        known = dict(zip(symbols, (*point, *numbers), strict=True))
        for name, matrix in _ordered(forms):
            values = [value_of(entry, known) for entry in matrix]
            found.setdefault(name, []).append(values)
            for stage, entries in STAGES:
                if name == stage:
                    known |= {sp.Symbol(s, real=True): x for s, x in zip(entries, values, strict=True)}
            if name == "W":
                known[sp.Symbol("W", positive=True)] = values[0]
    return [
        compared(name, ROUTE, np.array(found[name]).T, _flat(wanted[name], n))
        for name in forms.quantities
        if name in wanted
    ]


def _ordered(forms: ClosedForms) -> list[tuple[str, sp.MatrixBase]]:
    """W first, which the others may be written with."""
    return sorted(forms.quantities.items(), key=lambda entry: entry[0] != "W")


def _flat(value: Array, n: int) -> Array:
    """(entries by rows, n) of matrices side by side."""
    return value.reshape(value.shape[0], n, -1).transpose(0, 2, 1).reshape(-1, n)


def _taken(shape: ShapeKind) -> ca.Function:
    """(alpha, parameters) -> the same quantities as the forms of contact compute them."""
    side = partner(Side(shape, "fixed", "identity"), "o")
    feature = feature_of(shape, 1.0)
    alpha = ca.SX.sym("alpha", feature.dimension)
    if feature.dimension == 2:
        frame, jet = montana_frame(side, alpha), chart_jet(side, alpha)
        forms = {
            "c": frame.point, "z": frame.normal, "I": jet.first.T @ jet.first,
            "II": second_form(frame.normal, jet), "M": frame.M, "K": frame.K, "T": frame.T,
        }  # fmt: skip
    else:
        curve = jet_of_curve(side, alpha)
        N = ca.cross(curve.first, curve.second)
        bent = strand(side, alpha, ca.SX([0, 0, 1]))
        third = ca.jacobian(curve.second, alpha)
        forms = {
            "c": curve.x, "speed": bent.speed, "k": ca.norm_2(N) / bent.speed**3,
            "tau": ca.dot(N, third) / ca.sumsqr(N),
        }  # fmt: skip
    outputs = [ca.densify(form) for form in forms.values()]
    return ca.Function("taken", [alpha, side.argument], outputs, ["alpha", "p"], list(forms))
