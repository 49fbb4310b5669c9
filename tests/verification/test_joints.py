"""What joints keep agrees with differences of the relative placement, and a wrong joint is reported."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import pytest

from modelgen import derive, require
from modelgen.derivation import Derivation
from modelgen.joint import joint_equations
from modelgen.report.kind_scenes import kind_scene
from modelgen.scene.joint_format import ARMATURE
from modelgen.verification.verify import verified
from tests.verification.test_status import corrupted

N = 6
KINDS = (
    *joint_equations.FORMS,
    *(f"{kind}:motion" for kind, form in joint_equations.FORMS.items() if form.given),
    *(f"{kind}:armature" for kind in ARMATURE),
)


def joint(kind: str) -> Derivation:
    return derive(require(kind_scene(kind)))


@pytest.mark.cases(2)
@pytest.mark.parametrize("kind", KINDS)
def test_every_joint_agrees_with_the_placement_of_its_frames(kind: str) -> None:
    derivation = joint(kind)
    of_joint = [
        f
        for f in derivation.formulas
        if f.role in ("rows", "coordinates", "rates", "place", "wrench", "deflection")
    ]
    assert of_joint
    for formula in of_joint:
        verdict = verified(formula, derivation, N, 3)
        assert verdict.status == "tested", (formula.name, verdict.as_dict())
        assert {finding.n for finding in verdict.findings} == {N}
        assert max(finding.worst for finding in verdict.findings) < 1e-12


@pytest.mark.cases(6)
@pytest.mark.parametrize(
    ("kind", "role", "output"),
    [
        *(("screw:motion", "rows", output) for output in ("value", "J", "gamma1", "bias")),
        ("planar:armature", "rows", "J"), ("spherical:armature", "rows", "gamma1"),
        ("universal", "coordinates", "coordinate"),
        *(("revolute", "rates", output) for output in ("d", "J_o", "gamma", "eta_dot", "normal")),
        *(("revolute", "place", output) for output in ("eta_next", "d", "residual", "normal", "point_f")),
        ("revolute", "wrench", "wrench_a"), ("prismatic", "wrench", "wrench_b"),
        ("revolute", "deflection", "deflection"), ("prismatic", "deflection", "J"),
    ],
)  # fmt: skip
def test_a_corrupted_formula_of_a_joint_is_reported(kind: str, role: str, output: str) -> None:
    derivation = joint(kind)
    formula = next(f for f in derivation.formulas if f.role == role)
    assert verified(corrupted(formula, output), derivation, N, 6).status == "failed"


@pytest.mark.cases(5)
@pytest.mark.parametrize("kind", [kind for kind in joint_equations.FORMS if kind != "rope"])
def test_a_row_that_keeps_something_else_is_reported(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One row of the table is moved by a millionth of the turn between the frames."""
    true = joint_equations.FORMS[kind]

    def wrong(m: Any, numbers: ca.SX) -> list[ca.SX]:
        first, *others = true.rows(m, numbers)
        return [first + 1e-6 * m.length * (1 + m.cosine("xa", "yb")), *others]

    monkeypatch.setattr(joint_equations, "FORMS", joint_equations.FORMS)
    monkeypatch.setitem(joint_equations.FORMS, kind, replace(true, rows=wrong))  # type: ignore[arg-type]
    derivation = joint(kind)
    (rows,) = (f for f in derivation.formulas if f.role == "rows")
    found = {f.quantity for f in verified(rows, derivation, N, 5).findings if f.status == "failed"}
    assert {"value", "J", "gamma1"} <= found
