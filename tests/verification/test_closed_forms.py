"""SymPy's closed forms are those of the textbooks, and CasADi's expressions have their values."""

from __future__ import annotations

import pytest
import sympy as sp

from modelgen.model import ShapeKind
from modelgen.scene.shape_catalogue import SHAPES
from modelgen.verification.fundamental_forms import closed_forms
from modelgen.verification.fundamental_forms_check import check_forms

NUMBERS = {
    "plane": (), "sphere": (0.7,), "ellipsoid": (1.0, 0.8, 0.6), "torus": (1.0, 0.4), "cylinder": (0.5,),
    "cone": (0.4,), "paraboloid": (1.2, -0.8), "circle": (0.5,), "ellipse_curve": (0.9, 0.5),
    "helix": (0.5, 0.2), "line": (), "segment": (1.5,), "edge": (1.2,),
}  # fmt: skip
u, v = sp.symbols("u v", real=True)


def kind(name: str, cavity: bool = False) -> ShapeKind:
    return ShapeKind(name, name, SHAPES[name].parameters, cavity)


@pytest.mark.cases(4)
@pytest.mark.parametrize(
    ("name", "cavity"),
    [(name, cavity) for name in NUMBERS for cavity in ((False,) if SHAPES[name].curve else (False, True))],
)
def test_casadi_has_the_values_of_the_closed_forms(name: str, cavity: bool) -> None:
    forms = closed_forms(kind(name, cavity))
    assert forms is not None
    findings = check_forms(forms, NUMBERS[name], 10, 1)
    assert {"K", "T"} <= {f.quantity for f in findings} or "speed" in {f.quantity for f in findings}
    assert all(finding.status == "tested" and finding.worst < 1e-12 for finding in findings)


def test_torus_has_its_textbook_curvatures() -> None:
    forms = closed_forms(kind("torus"))
    assert forms is not None
    R, r = forms.parameters
    K = forms.quantities["K"]
    assert sp.Matrix([[sp.cos(v) / (R + r * sp.cos(v)), 0], [0, 1 / r]]) == K


def test_helix_has_its_textbook_curvature_and_torsion() -> None:
    forms = closed_forms(kind("helix"))
    assert forms is not None
    radius, pitch = forms.parameters
    assert forms.quantities["k"][0] == radius / (pitch**2 + radius**2)
    assert forms.quantities["tau"][0] == pitch / (pitch**2 + radius**2)


def test_what_is_too_long_to_be_read_is_left_out() -> None:
    assert closed_forms(kind("superellipsoid")) is None
