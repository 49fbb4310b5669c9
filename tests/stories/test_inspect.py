"""`inspect` as a reader of the equations uses it: a scene, a pair of shapes, one quantity, a LaTeX text."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from modelgen.contact import form_table
from modelgen.contact.form_table import FORMS
from modelgen.contact.kernels import ContactKernels
from modelgen.model import ContactKind
from modelgen.notation import NAMES

EGG = "scenes/ellipsoid_on_plane.toml"
PAIRS = {
    "explicit": "sphere-sphere",
    "support": "plane-ellipsoid",
    **dict.fromkeys(("implicit", "mixed", "block", "paper", "differentiated"), "ellipsoid-torus"),
    **{form: "ellipsoid-ellipse_curve" for form in FORMS if form.startswith("curve_")},
    **{form: "circle-helix" for form in FORMS if form.startswith("curves_")},
    "centre_surface": "sphere-ellipsoid",
    "centre_curve": "sphere-circle",
    "edge_edge": "line-segment",
}
COMMANDS = {
    *(
        "subsection*",
        "paragraph",
        "texttt",
        "begin",
        "end",
        "mbox",
        "linewidth",
        "allowdisplaybreaks",
        "mathrm",
    ),
    *(
        "frac",
        "sqrt",
        "left",
        "right",
        "cos",
        "sin",
        "operatorname",
        "min",
        "max",
        "dot",
        "cdot",
        "operatorname*",
    ),
    *("alpha", "Gamma", "eta", "lambda", "mu", "sigma", "nu", "omega", "psi", "rho", "tau"),
    *("textasciicircum", "textbackslash", "textasciitilde", "textless", "textgreater", "textbar"),
}
Modelgen = Callable[..., Any]


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS)
def test_a_pair_of_shapes_shows_its_contact_alone(form: str, modelgen: Modelgen) -> None:
    formulas = modelgen("inspect", f"{PAIRS[form]}:{form}", "--json").json["formulas"]
    roles = ["rates", "place", *(["angle"] if form.endswith("paper") else [])]
    assert [formula["role"] for formula in formulas if formula["role"] not in ("surface", "curve")] == roles
    rates = next(formula for formula in formulas if formula["role"] == "rates")
    assert form in rates["name"]
    assert rates["statement"]
    assert len(rates["steps"]) >= 2
    assert {step["name"] for step in rates["steps"]} <= set(NAMES)


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS)
def test_one_quantity_is_shorter_than_the_formula_and_ends_in_itself(form: str, modelgen: Modelgen) -> None:
    pair = f"{PAIRS[form]}:{form}"
    (whole,) = modelgen("inspect", pair, "--formula", "rates", "--json").json["formulas"]
    (alone,) = modelgen("inspect", pair, "--formula", "gamma", "--json").json["formulas"]
    assert len(alone["definition"]) < len(whole["definition"])
    assert [port["name"] for port in alone["outputs"]] == ["gamma"]
    assert alone["definition"][-1]["name"] == "gamma"
    assert all(line in whole["definition"] for line in alone["definition"])


def test_text_has_source_cost_units_frames_and_meaning(modelgen: Modelgen) -> None:
    text = modelgen("inspect", EGG, "--formula", "mg_plane_ellipsoid_support_rates").out
    for words in (
        "source: Lemma 3.1, Corollary 3.2", "cost: 89 instructions", "statement:", "inputs:", "outputs:",
        "steps on the way:", "definition:", "m/s^2", "world, then body axes", "normal from o to f; (3.1)",
    ):  # fmt: skip
        assert words in text
    assert re.search(r"^    gamma +=", text, re.MULTILINE)


def test_factors_in_latex_stand_apart(modelgen: Modelgen) -> None:
    text = modelgen("inspect", "sphere-helix", "--formula", "curve", "--format", "latex").out
    assert r"x_{3} &= \mathrm{pitch} \, s" in text


def test_the_contact_angle_stands_beside_the_form_of_the_paper(modelgen: Modelgen) -> None:
    (angle,) = modelgen("inspect", "torus-ellipsoid:paper", "--formula", "angle", "--json").json["formulas"]
    assert "(4.3)" in angle["citation"]
    assert {port["name"]: port["unit"] for port in angle["outputs"]} == {"psi": "rad", "psi_dot": "rad/s"}


@pytest.mark.cases(2)
@pytest.mark.parametrize("source", [EGG, "torus-ellipsoid:paper", "sphere-plane", "superellipsoid-ellipsoid"])
def test_latex_is_balanced_and_uses_known_commands(source: str, modelgen: Modelgen) -> None:
    text = modelgen("inspect", source, "--format", "latex").out
    text = re.sub(r"\\begin\{verbatim\}.*?\\end\{verbatim\}", "", text, flags=re.DOTALL)
    assert set(re.findall(r"\\([A-Za-z]+\*?)", text)) <= COMMANDS
    opened = re.findall(r"\\begin\{(\w+\*?)\}", text)
    assert opened == re.findall(r"\\end\{(\w+\*?)\}", text)
    assert set(opened) == {"tabular", "align*"}
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    for block in re.findall(r"\\begin\{align\*\}(.*?)\\end\{align\*\}", text, re.DOTALL):
        rows = block.strip().split("\\\\\n")
        assert all(row.count("&=") == 1 for row in rows)
        assert all(row.count("{") == row.count("}") for row in rows)
        assert not re.search(r"[A-Za-z]{3,}", re.sub(r"\\[A-Za-z]+\*?(\{[A-Za-z]+\})?", "", block))
    outside = re.sub(r"\$[^$]*\$|\\begin\{align\*\}.*?\\end\{align\*\}", "", text, flags=re.DOTALL)
    assert not re.search(r"(?<!\\)[_#%$^~]", outside)


def test_status_is_claimed_until_it_is_asked_for(modelgen: Modelgen) -> None:
    (rates,) = modelgen("inspect", "sphere-torus", "--formula", "rates", "--json").json["formulas"]
    assert rates["status"] == "tested, not recomputed"
    answer = modelgen("inspect", "sphere-torus", "--formula", "rates", "--verify", 9, "--json")
    (rates,) = answer.json["formulas"]
    assert rates["status"] == "tested"
    assert rates["configurations"] == 9
    assert {"J", "gamma", "eta_dot"} <= {found["quantity"] for found in rates["findings"]}
    assert rates["worst"] < 1e-10


def test_a_corrupted_form_fails_with_its_exit_code(
    modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    true = form_table.FORMS["block"].build

    def corrupted(kind: ContactKind) -> ContactKernels:
        kernels = true(kind)
        rates = kernels.stated()
        return replace(kernels, stated=lambda: replace(rates, gamma=-rates.gamma))

    wrong = {**form_table.FORMS, "block": replace(form_table.FORMS["block"], build=corrupted)}
    monkeypatch.setattr(form_table, "FORMS", wrong)
    form_table.contact_kernels.cache_clear()
    try:
        answer = modelgen("inspect", "torus-ellipsoid:block", "--formula", "rates", "--verify", 9)
    finally:
        form_table.contact_kernels.cache_clear()
    assert answer.code == 1
    assert "FAILED" in answer.out
    assert re.search(r"gamma +failed", answer.out)


def test_numbers_are_those_of_the_configuration(modelgen: Modelgen, shared_folder: Path) -> None:
    one, again, other = (
        modelgen("inspect", "sphere-sphere", "--formula", "d", "--at", seed, "--json").json["formulas"][0]
        for seed in (3, 3, 4)
    )
    assert one == again
    assert one["definition"][-1]["number"] != other["definition"][-1]["number"]
    poses = {f"pose_{s}": [x, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1] for s, x in (("o", 0.0), ("f", 7.0))}
    (shared_folder / "at.json").write_text(json.dumps({**poses, "parameters": [1.0, 2.0]}), encoding="utf-8")
    answer = modelgen("inspect", "sphere-sphere", "--formula", "d", "--at", "at.json", "--json")
    own = answer.json["formulas"][0]
    assert own["definition"][-1]["number"] == 4.0


@pytest.mark.parametrize(("lengths", "d"), [({}, 2.0), ({"parameters": [3.0, 1.0, 2.5, 0.5]}, 4.5)])
def test_the_contact_parameters_at_given_poses_are_those_of_the_closest_points(
    lengths: dict[str, Any], d: float, modelgen: Modelgen, shared_folder: Path
) -> None:
    """Two flat rings one above the other, whose centre circles cross as seen from above."""
    turn = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    poses = {"pose_o": [0, 0, 0, *turn], "pose_f": [0.5, 0.9, 6.0, *turn]}
    (shared_folder / "rings.json").write_text(json.dumps({**poses, **lengths}), encoding="utf-8")
    answer = modelgen("inspect", "torus-torus", "--formula", "place", "--at", "rings.json", "--json")
    (place,) = answer.json["formulas"]
    numbers = {line["name"]: line["number"] for line in place["definition"]}
    assert numbers["d"] == pytest.approx(d, abs=1e-12)
    assert max(abs(numbers["residual_1"]), abs(numbers["residual_2"])) < 1e-12


def test_the_contact_parameters_of_a_given_state_are_those_of_the_closest_points(
    modelgen: Modelgen, shared_folder: Path
) -> None:
    """An ellipsoid above another, with parallel axes: they are nearest at their poles."""
    state = {"q": [0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0]}
    (shared_folder / "state.json").write_text(json.dumps(state), encoding="utf-8")
    answer = modelgen(
        "inspect", "scenes/ellipsoid_on_ellipsoid.toml", "--formula", "rhs", "--at", "state.json", "--json"
    )
    (rhs,) = answer.json["formulas"]
    assert rhs["at"]["eta"] == pytest.approx([0, 0, -0.03, 0, 0, 0.2], abs=1e-12)


def test_poses_without_closest_points_are_refused(modelgen: Modelgen, shared_folder: Path) -> None:
    turn = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    poses = {"pose_o": [0, 0, 0, *turn], "pose_f": [0, 0, 1, *turn], "parameters": [1, 1]}
    (shared_folder / "same.json").write_text(json.dumps(poses), encoding="utf-8")
    answer = modelgen("inspect", "circle-circle", "--formula", "place", "--at", "same.json")
    assert answer.code == 2
    assert "no closest points" in answer.err


@pytest.mark.parametrize("text", ["[1, 2]", "{", '{"parameters": [1, "x"]}', '{"parameters": [1]}'])
def test_numbers_that_are_none_are_refused(text: str, modelgen: Modelgen, shared_folder: Path) -> None:
    (shared_folder / "bad.json").write_text(text, encoding="utf-8")
    answer = modelgen("inspect", "sphere-sphere", "--formula", "d", "--at", "bad.json")
    assert answer.code == 2
    assert "--at" in answer.err


def test_the_tree_leads_from_what_is_exported_to_definitions(modelgen: Modelgen) -> None:
    text = modelgen("inspect", "torus-ellipsoid:block", "--formula", "gamma").out
    tree = text.split("tree, from what is exported to what defines it:")[1].strip().splitlines()
    assert tree[0].strip() == "gamma"
    assert all(line.startswith("      ") for line in tree[1:])


def test_a_scene_whose_faces_rub_is_shown(modelgen: Modelgen) -> None:
    answer = modelgen("inspect", "scenes/sliding_puck.toml", "--formula", "rates", "--verify", "3", "--json")
    assert answer.code == 0
    formulas = json.loads(answer.out)["formulas"]
    assert formulas
    assert {entry["status"] for entry in formulas} <= {"tested", "proved"}


def test_a_page_is_written_where_it_is_asked_for(modelgen: Modelgen, shared_folder: Path) -> None:
    target = shared_folder / "kind.html"
    answer = modelgen("inspect", "sphere-plane", "--format", "html", "-o", str(target))
    assert answer.code == 0
    assert answer.out.strip() == f"written: {target}"
    assert target.read_text(encoding="utf-8").startswith("<!")
    refused = modelgen("inspect", "sphere-plane", "-o", str(shared_folder / "none" / "kind.html"))
    assert refused.code == 2
