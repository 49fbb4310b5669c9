"""Facts on a page of formulas: closed forms of the shapes, singularities, and the errata."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from modelgen.derivation import Derivation
from modelgen.report import mathml
from modelgen.verification.errata.errata_table import decided
from modelgen.verification.fundamental_forms import closed_forms
from modelgen.verification.fundamental_forms_check import check_forms
from modelgen.verification.singularity_map import margin_map
from modelgen.verification.verify import lengths_of, partnership_of

MEANINGS = {
    "c": "point of the shape", "z": "exterior unit normal", "I": "first fundamental form",
    "II": "second fundamental form, positive if convex", "W": (
        "W = |c_u × c_v|; below, E, F, G and L, M, N are the entries of I and II"
    ),
    "M": "root of the metric, [c_u c_v] = [x y] M, by Gram–Schmidt",
    "K": "curvature form in the frame [x y]", "T": "torsion form y·dx M⁻¹", "speed": "|c′|",
    "k": "curvature", "tau": "torsion",
}  # fmt: skip


def shape_facts(derivation: Derivation, n: int, seed: int) -> list[dict[str, Any]]:
    """The shapes of a model with their closed forms, each compared with CasADi's expression."""
    found = []
    for index, kind in enumerate(derivation.model.shape_kinds):
        forms = closed_forms(kind)
        numbers = lengths_of(derivation.model, index)
        checks = (
            {} if forms is None else {f.quantity: f.as_dict() for f in check_forms(forms, numbers, n, seed)}
        )
        quantities = [] if forms is None else [
            {
                "name": name, "meaning": MEANINGS[name], "value": sp.sstr(value.tolist()),
                "mathml": mathml.form(name, value),
                "check": checks.get(name),
            }
            for name, value in forms.quantities.items()
        ]  # fmt: skip
        found.append(
            {"name": kind.name, "kind": kind.kind, "parameters": list(numbers), "quantities": quantities}
        )
    return found


def singularity_facts(derivation: Derivation) -> list[dict[str, Any]]:
    """The singular set of each kind of contact, and its margin as a grid."""
    found = []
    for index, kind in enumerate(derivation.model.contact_kinds):
        at = margin_map(partnership_of(derivation.model, index))
        if at is None:
            continue
        mu = np.where(np.isfinite(at.mu), at.mu, 2.0)
        found.append({
            "kind": kind.name, "condition": at.condition, "axes": list(at.axes),
            "ranges": [list(ends) for ends in at.ranges], "held": at.held,
            "least": float(np.nanmin(at.mu)), "largest": float(np.nanmax(at.mu)),
            "mu": [[None if x > 1.5 else float(x) for x in line] for line in mu],
        })  # fmt: skip
    return found


def errata_facts(n: int, seed: int) -> list[dict[str, Any]]:
    """The rows of the erratum table, decided now."""
    return [decision.as_dict() for decision in decided(n, seed)]
