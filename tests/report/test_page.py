"""The page stands alone, is well formed, and holds every formula, closed form, map and erratum."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

from modelgen import derive, require
from modelgen.report import mathml
from modelgen.report.formula_inspection import inspected, written
from modelgen.report.heat_map_png import colour
from modelgen.verification.errata.errata_table import ERRATA
from tests.benchmarks.pages import browser, looked_at

CORE = {  # elements of MathML Core
    *("math", "mrow", "mi", "mn", "mo", "mspace", "mfrac", "msqrt", "msup", "msub", "mover"),
    *("mtable", "mtr", "mtd"),
}  # fmt: skip


@pytest.fixture(scope="module")
def facts() -> dict[str, Any]:
    return inspected("sphere-helix", None, None, "html", (0, {}, 8), lambda scene: derive(require(scene)))


def test_nothing_is_fetched_and_no_script_runs(facts: dict[str, Any]) -> None:
    text = written(facts, "html")
    assert "<script" not in text
    assert "http" not in text
    assert "<link" not in text


def test_every_part_is_there(facts: dict[str, Any]) -> None:
    text = written(facts, "html")
    assert text.count("<h3>") == len(facts["formulas"]) + len(facts["shapes"]) + len(facts["singularities"])
    assert text.count(">confirmed<") == len(ERRATA)
    assert text.count("data:image/png;base64,") == len(facts["singularities"]) == 1
    assert "failed" not in text.replace(".failed", "")


@pytest.fixture(scope="module")
def joint_facts() -> dict[str, Any]:
    return inspected("screw:motion", None, None, "html", (0, {}, 4), lambda scene: derive(require(scene)))


def test_a_joint_has_a_page_without_empty_parts(joint_facts: dict[str, Any]) -> None:
    text = written(joint_facts, "html")
    assert {formula["role"] for formula in joint_facts["formulas"]} == {"rows", "coordinates"}
    assert "Γ₁" in text
    assert 'id="shapes"' not in text
    assert 'id="singularities"' not in text
    assert "failed" not in text.replace(".failed", "")


@pytest.mark.cases(1)
@pytest.mark.skipif(browser() is None, reason="no Chromium")
@pytest.mark.parametrize("name", ["facts", "joint_facts"])
def test_a_browser_renders_every_formula(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    text = written(request.getfixturevalue(name), "html")
    page = tmp_path / "page.html"
    page.write_text(text, encoding="utf-8")
    program = browser()
    assert program is not None
    look = looked_at(program, page)
    assert look.formulas == text.count("<math")
    assert (look.unrendered, look.cut) == (0, 0)
    assert look.beyond <= 0


@pytest.mark.parametrize("name", ["facts", "joint_facts"])
def test_all_mathematics_is_mathml_core(name: str, request: pytest.FixtureRequest) -> None:
    text = written(request.getfixturevalue(name), "html")
    pieces = text.split("<math")[1:]
    assert len(pieces) > 50
    for piece in pieces:
        tree = ET.fromstring("<math" + piece.split("</math>")[0] + "</math>")
        assert {element.tag for element in tree.iter()} <= CORE


def test_names_have_their_marks() -> None:
    assert "ω" in mathml.symbol("omega_f_z")
    assert "<mo>˙</mo>" in mathml.symbol("eta_dot_1")
    assert "<msub>" in mathml.symbol("s12")


def test_small_numbers_and_conditions_are_written_as_mathematics() -> None:
    x, y = sp.symbols("x y", real=True)
    assert "<msup><mn>10</mn><mn>−30</mn></msup>" in mathml.expression(sp.Max(x, sp.Float(1e-30)))
    assert "<mo>&lt;</mo>" in mathml.expression(sp.Function("lt")(x, y))
    assert "<mo>¬</mo>" in mathml.expression(sp.Function("not")(x))


def test_long_sums_are_broken() -> None:
    terms = sp.symbols("a_1:60", real=True)
    assert mathml.equation("x", sum(terms)).count("<mtr>") > 3


def test_small_margins_are_black_and_negative_ones_red() -> None:
    assert colour(0.0) == (0, 0, 0)
    red, _, blue = colour(-0.2)
    assert red > blue
