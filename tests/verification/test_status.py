"""Formulas are what they claim to be, and a corrupted one is reported."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import pytest

from modelgen import derive, read, require
from modelgen.contact.form_table import FORMS
from modelgen.derivation import Derivation, Formula
from modelgen.model import Rows
from modelgen.report.formula_list import View, formula_facts
from modelgen.report.kind_scenes import kind_scene
from modelgen.verification.proofs import MUST_BE_PROVED, must_be_proved
from modelgen.verification.verify import verified

N = 12
PAIRS = {
    "explicit": "sphere-sphere", "support": "plane-ellipsoid", "centre_surface": "sphere-torus",
    "centre_curve": "point-helix", "edge_edge": "edge-segment",
    **dict.fromkeys(("implicit", "mixed", "block", "paper", "differentiated"), "ellipsoid-torus"),
    **{form: "ellipsoid-ellipse_curve" for form in FORMS if form.startswith("curve_")},
    **{form: "circle-helix" for form in FORMS if form.startswith("curves_")},
}  # fmt: skip
SCENES = ("ball_in_bowl", "bean_with_poles", "egg_on_spline", "ellipsoid_on_ellipsoid", "linked_rings")
TO_PROVE = {  # formulas of the pairs below, without those of contact
    "sphere-sphere": {
        "mg_point_motion", "mg_point_energy", "mg_sphere_surface", "mg_sphere_sphere_explicit_rates",
    },
    "torus-helix": {
        "mg_free_diagonal_pose", "mg_free_diagonal_motion", "mg_free_diagonal_energy", "mg_torus_surface",
        "mg_helix_curve",
    },
}  # fmt: skip


def pair(kind: str) -> Derivation:
    return derive(require(kind_scene(kind)))


def corrupted(formula: Formula, output: str, part: int | None = None) -> Formula:
    """The same formula with one output, or a sixth of it, a millionth too large."""
    function = formula.function
    given = [ca.SX.sym(name, function.size1_in(k)) for k, name in enumerate(function.name_in())]
    values = function.call(given)
    k = function.name_out().index(output)
    sixth = values[k].numel() // 6
    chosen = slice(None) if part is None else slice(part * sixth, (part + 1) * sixth)
    values[k][chosen] = values[k][chosen] * (1 + 1e-6)
    wrong = ca.Function(function.name(), given, values, function.name_in(), function.name_out())
    return replace(formula, function=wrong)


def with_rows(kind: str, rows: Rows) -> Derivation:
    """The derivation of a pair whose contacts have tangential rows."""
    model = require(kind_scene(kind))
    return derive(replace(model, contact_kinds=tuple(replace(k, rows=rows) for k in model.contact_kinds)))


@pytest.mark.cases(6)
@pytest.mark.parametrize("rows", [3, 6])
@pytest.mark.parametrize("form", FORMS)
def test_tangential_rows_agree_with_material_points(form: str, rows: Rows) -> None:
    derivation = with_rows(f"{PAIRS[form]}:{form}", rows)
    formula = next(f for f in derivation.formulas if f.role == "rates")
    verdict = verified(formula, derivation, N, 7)
    assert verdict.status == "tested", verdict.as_dict()
    assert [finding.quantity for finding in verdict.findings].count("gamma") == 2
    assert "tangents" in {finding.quantity for finding in verdict.findings}


@pytest.mark.cases(4)
@pytest.mark.parametrize("output", ["J_o", "J_f", "gamma", "tangents"])
@pytest.mark.parametrize("kind", ["ellipsoid-torus", "plane-ellipsoid", "circle-helix"])
def test_a_corrupted_tangential_row_is_reported(kind: str, output: str) -> None:
    derivation = with_rows(kind, 6)
    formula = next(f for f in derivation.formulas if f.role == "rates")
    for row in range(6):
        assert verified(corrupted(formula, output, row), derivation, N, 6).status == "failed"


def test_tangential_rows_are_written_out_with_their_source() -> None:
    (facts,) = formula_facts(with_rows("plane-ellipsoid", 6), "rates", "text", view=View(n=N))
    assert "Montana" in facts["citation"]
    assert "sigma t2" in facts["statement"]
    assert {"slip", "rolling"} <= {step["name"] for step in facts["steps"]}
    assert {port["name"]: port["unit"] for port in facts["outputs"]}["gamma"] == "m/s^2, rad/s^2"
    assert facts["status"] == "tested"
    assert facts["unchecked"] == []


@pytest.mark.cases(4)
@pytest.mark.parametrize("form", FORMS)
def test_every_form_agrees_with_the_motion(form: str) -> None:
    derivation = pair(f"{PAIRS[form]}:{form}")
    for formula in derivation.formulas:
        verdict = verified(formula, derivation, N, 3)
        assert verdict.findings
        assert verdict.status == verdict.claim, (formula.name, verdict.as_dict())


@pytest.mark.cases(3)
@pytest.mark.parametrize("name", SCENES)
def test_every_formula_of_a_scene_has_its_status(name: str) -> None:
    derivation = derive(require(read(f"scenes/{name}.toml")))
    for formula in derivation.formulas:
        assert verified(formula, derivation, N, 4).status in ("proved", "tested"), formula.name


@pytest.mark.cases(1)
@pytest.mark.parametrize("kind", TO_PROVE)
def test_what_must_be_proved_is_proved(kind: str) -> None:
    derivation = pair(kind)
    due = {f.name for f in derivation.formulas if must_be_proved(f, derivation.model)}
    assert due == TO_PROVE[kind]
    for formula in derivation.formulas:
        if formula.name in due:
            assert any(finding.status == "proved" for finding in verified(formula, derivation, N, 5).findings)


def test_the_table_of_proofs_names_roles_that_exist() -> None:
    assert set(MUST_BE_PROVED) == {"pose", "motion", "energy", "surface", "curve", "rates"}


@pytest.mark.cases(4)
@pytest.mark.parametrize(
    ("kind", "role", "output"),
    [
        ("ellipsoid-torus", "rates", "gamma"), ("ellipsoid-torus", "rates", "eta_dot"),
        ("ellipsoid-torus:block", "rates", "J_f"), ("ellipsoid-torus", "place", "eta_next"),
        ("sphere-sphere", "rates", "gamma"), ("torus-helix", "pose", "pose"),
        ("torus-helix", "motion", "udot"), ("torus-helix", "energy", "spin"),
        ("torus-helix", "surface", "n"), ("torus-helix", "curve", "tangent"),
        ("ellipsoid-torus:paper", "angle", "psi_dot"), ("ellipsoid-ellipsoid", "seek", "bend"),
        ("sphere-sphere", "rhs", "udot"),
    ],
)  # fmt: skip
def test_a_corrupted_formula_is_reported(kind: str, role: str, output: str) -> None:
    derivation = pair(kind)
    formula = next(f for f in derivation.formulas if f.role == role)
    verdict = verified(corrupted(formula, output), derivation, N, 6)
    assert verdict.status == "failed"
