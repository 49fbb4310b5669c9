"""The page stands alone, is well formed, and holds every formula, closed form, map and erratum."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import pytest
import sympy as sp

from modelgen import derive, require
from modelgen.evidence.errata.table import ERRATA
from modelgen.report import mathml
from modelgen.report.inspection import inspected, written
from modelgen.report.raster import colour

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


def test_all_mathematics_is_mathml_core(facts: dict[str, Any]) -> None:
    text = written(facts, "html")
    pieces = text.split("<math")[1:]
    assert len(pieces) > 50
    for piece in pieces:
        tree = ET.fromstring("<math" + piece.split("</math>")[0] + "</math>")
        assert {element.tag for element in tree.iter()} <= CORE


def test_names_have_their_marks() -> None:
    assert "ω" in mathml.symbol("omega_f_z")
    assert "<mo>˙</mo>" in mathml.symbol("eta_dot_1")
    assert "<msub>" in mathml.symbol("s12")


def test_long_sums_are_broken() -> None:
    terms = sp.symbols("a_1:60", real=True)
    assert mathml.equation("x", sum(terms)).count("<mtr>") > 3


def test_small_margins_are_black_and_negative_ones_red() -> None:
    assert colour(0.0) == (0, 0, 0)
    red, _, blue = colour(-0.2)
    assert red > blue
