"""Formulas are what they claim to be, and a corrupted one is reported."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import pytest

from modelgen import derive, read, require
from modelgen.contact.kinds import FORMS
from modelgen.derive import Derivation, Formula
from modelgen.evidence.proofs import MUST_BE_PROVED, must_be_proved
from modelgen.evidence.verify import verified
from modelgen.report.kind_scenes import kind_scene

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


def corrupted(formula: Formula, output: str) -> Formula:
    """The same formula with one output a millionth too large."""
    function = formula.function
    given = [ca.SX.sym(name, function.size1_in(k)) for k, name in enumerate(function.name_in())]
    values = function.call(given)
    k = function.name_out().index(output)
    values[k] = values[k] * (1 + 1e-6)
    wrong = ca.Function(function.name(), given, values, function.name_in(), function.name_out())
    return replace(formula, function=wrong)


@pytest.mark.parametrize("form", FORMS)
def test_every_form_agrees_with_the_motion(form: str) -> None:
    derivation = pair(f"{PAIRS[form]}:{form}")
    for formula in derivation.formulas:
        verdict = verified(formula, derivation, N, 3)
        assert verdict.findings
        assert verdict.status == verdict.claim, (formula.name, verdict.as_dict())


@pytest.mark.parametrize("name", SCENES)
def test_every_formula_of_a_scene_has_its_status(name: str) -> None:
    derivation = derive(require(read(f"scenes/{name}.toml")))
    for formula in derivation.formulas:
        assert verified(formula, derivation, N, 4).status in ("proved", "tested"), formula.name


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
