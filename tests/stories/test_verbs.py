"""Each verb does what its help says, for people and for programs."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from modelgen import __version__
from modelgen.report.run_files import load
from modelgen.report.summary import contact_lines
from tests.running import FILES

EGG = "scenes/ellipsoid_on_plane.toml"
BALL = "scenes/bouncing_ball.toml"
Modelgen = Callable[..., Any]


def test_version(modelgen: Modelgen) -> None:
    assert modelgen("--version").out == f"modelgen {__version__}\n"


@pytest.mark.cases(8)
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_check_says_what_a_scene_requires_and_compiles_nothing(
    path: Path, modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    facts = modelgen("check", path, "--brief", "--json").json
    assert facts["scene"] == path.stem
    assert facts["kinds"]
    assert all(count > 0 for count in facts["instructions"].values())
    for contact in facts["contacts"]:
        assert contact["kind"] in facts["kinds"]
        assert facts["instructions"][f"mg_{contact['kind']}_rates"] == contact["forms"][contact["form"]]
        assert contact["forms"][contact["form"]] == min(contact["forms"].values())
    assert set(facts["scales"]) == {"length", "mass", "time"}
    assert list(tmp_path.iterdir()) == []


def test_check_prints_the_same_as_text(modelgen: Modelgen) -> None:
    text = modelgen("check", BALL).out
    facts = modelgen("check", BALL, "--json").json
    for word in (*facts["instructions"], facts["contacts"][0]["name"], "left out", "orientation"):
        assert word in text
    for each in facts["savings"]:
        assert f"{each['decision']} " in text
        assert str(each["saved"]["instructions"]) in text


def test_check_tells_which_faces_rest_on_each_other_at_the_start(modelgen: Modelgen) -> None:
    facts = modelgen("check", "scenes/glass_on_table.toml", "--json").json
    assert facts["patches"] == ["glass-table:bottom", "glass-table:top"]
    assert facts["patches_at_start"] == ["glass-table:bottom"]
    assert "bottom (at the start), top" in modelgen("check", "scenes/glass_on_table.toml").out


def test_check_cuts_no_name(modelgen: Modelgen) -> None:
    lines = modelgen("check", "scenes/linked_rings.toml").out.splitlines()
    (contact,) = modelgen("check", "scenes/linked_rings.toml", "--json").json["contacts"]
    (row,) = [line for line in lines if line.startswith(contact["kind"])]
    assert all(f"{form} {count}" in row for form, count in contact["forms"].items())


def test_a_form_can_be_forced(modelgen: Modelgen) -> None:
    free, forced = (modelgen("check", EGG, "--json", *more).json for more in ((), ("--form", "implicit")))
    assert {contact["form"] for contact in free["contacts"]} == {"support"}
    assert {contact["form"] for contact in forced["contacts"]} == {"implicit"}


def test_a_second_build_compiles_nothing(modelgen: Modelgen) -> None:
    first = modelgen("build", EGG, "--json").json
    library = Path(first["library"])
    made = library.stat().st_mtime_ns
    assert modelgen("build", EGG, "--json").json == first
    assert library.stat().st_mtime_ns == made
    assert (library.parent / "manifest.json").is_file()


def test_build_in_another_real_type_and_folder(modelgen: Modelgen, tmp_path: Path) -> None:
    facts = modelgen("build", EGG, "--real", "float", "--out", tmp_path / "f", "--json").json
    assert facts["real"] == "float"
    assert Path(facts["library"]).parent == tmp_path / "f"


def test_simulate_answers_to_its_schema_and_writes_its_files(modelgen: Modelgen, tmp_path: Path) -> None:
    npz, picture = tmp_path / "run.npz", tmp_path / "run.svg"
    options = ("--until", 0.2, "--samples", 10, "--accuracy", "tight", "--out", npz, "--plot", picture)
    summary = modelgen("simulate", EGG, *options, "--json").json
    schema = modelgen("schema").json["$defs"]["result"]
    Draft202012Validator(schema).validate(summary)
    assert (summary["outcome"], summary["t_end"], summary["accuracy"]) == ("done", 0.2, "tight")
    record = load(npz)
    assert record.summary | {"out": str(npz), "plot": str(picture)} == summary
    assert record.columns["t"].tolist() == pytest.approx([0.02 * k for k in range(11)])
    assert record.columns["p"][-1, record.body_names.index("egg")].tolist() == summary["final"]["egg"]["p"]
    assert picture.read_text().lstrip().startswith("<?xml")


@pytest.mark.slow
def test_simulate_says_what_it_wrote(modelgen: Modelgen, tmp_path: Path) -> None:
    npz, picture = tmp_path / "run.npz", tmp_path / "run.png"
    text = modelgen("simulate", BALL, "--until", 0.1, "--out", npz, "--plot", picture).out
    assert f"written: {npz}\nwritten: {picture}\n" in text
    assert "written" not in modelgen("simulate", BALL, "--until", 0.1).out
    nothing = modelgen("simulate", BALL, "--until", 0.1, "--json").json
    assert (nothing["out"], nothing["plot"]) == (None, None)


def test_the_last_line_says_whether_the_run_is_trusted(modelgen: Modelgen) -> None:
    """A certified run is; one that is unbalanced or steps in time is not, and says why. The drift of
    the energy of a coarse run is explained by its error, where that is estimated."""
    last = modelgen("simulate", EGG, "--until", 0.2).out.splitlines()[-1]
    assert last == "trusted"
    alone = modelgen("simulate", EGG, "--until", 0.2, "--no-estimate").out.splitlines()[-1]
    assert alone == "trusted; its error was not estimated"
    coarse = ("simulate", EGG, "--until", 0.2, "--method", "rk4", "--step", 0.02, "--json")
    unbalanced, estimated = modelgen(*coarse, "--no-estimate").json, modelgen(*coarse).json
    assert not unbalanced["trusted"]
    assert any("energy drift" in doubt for doubt in unbalanced["doubts"])
    assert estimated["trusted"]
    assert estimated["estimate"]["velocity"] > 1e-5
    stepped = modelgen("simulate", EGG, "--until", 0.2, "--method", "time-stepping", "--step", 0.01).out
    assert re.match(r"not trusted: .*uncertified: ", stepped.splitlines()[-1])
    assert "time-stepping tells events to a step only" in stepped.splitlines()[-1]


@pytest.mark.parametrize("more", [(), ("--no-estimate",)])
def test_a_run_that_ends_early_says_so_in_its_last_line(
    more: tuple[str, ...], modelgen: Modelgen, tmp_path: Path
) -> None:
    wild = tmp_path / "wild.toml"
    load = '[[force]]\nbody = "egg"\nforce = ["1/(t - 0.1)", "0", "0"]\n'
    wild.write_text(Path(EGG).read_text() + load)
    answer = modelgen("simulate", wild, *more)
    assert answer.code == 1
    assert answer.out.splitlines()[-1].startswith("not trusted: it ended early: ")


def test_numbers_of_options_are_those_of_scenes(modelgen: Modelgen) -> None:
    assert modelgen("simulate", BALL, "--until", "1/8", "--json").json["t_end"] == 0.125


def test_bodies_without_a_contact_are_hinted_at(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_contact = Path(BALL).read_text()
    monkeypatch.chdir(tmp_path)
    Path("loose.toml").write_text(re.sub(r"\[\[contact\]\]\n(\w.*\n)+", "", with_contact))
    Path("bound.toml").write_text(with_contact)
    hint = 'between = ["ball", "table"]'
    assert "hint: no contact is listed, so all bodies pass" in modelgen("check", "loose.toml").out
    assert hint in modelgen("check", "loose.toml", "--json").json["hints"][0]
    run = modelgen("simulate", "loose.toml", "--until", 0.1, "--json")
    assert run.code == 0
    assert hint in run.json["warnings"][0]
    assert modelgen("check", "bound.toml", "--json").json["hints"] == []
    assert modelgen("simulate", "bound.toml", "--until", 0.1, "--json").json["warnings"] == []


def test_the_file_of_a_run_gives_its_picture(modelgen: Modelgen, tmp_path: Path) -> None:
    modelgen("simulate", BALL, "--until", 0.1, "--out", tmp_path / "run.npz")
    answer = modelgen("plot", tmp_path / "run.npz", "-o", tmp_path / "run.png", "--json")
    assert answer.json == {"file": str(tmp_path / "run.png"), "scene": "bouncing_ball", "outcome": "done"}
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_the_contact_curves_lie_on_the_drawn_surfaces(modelgen: Modelgen, tmp_path: Path) -> None:
    modelgen("simulate", EGG, "--until", 0.2, "--out", tmp_path / "run.npz")
    record = load(tmp_path / "run.npz")
    semi_axes = (0.12, 0.09, 0.07)
    side = "f" if record.body_names[record.pairs[0, 1]] == "egg" else "o"
    for points in (record.contact_curve(0, side), record.meshes[f"0_{side}"]):
        assert ((points / semi_axes) ** 2).sum(axis=-1) == pytest.approx(1.0, abs=1e-9)


def test_text_of_a_run_names_outcome_events_and_bodies(modelgen: Modelgen) -> None:
    text = modelgen("simulate", BALL, "--until", 0.5).out
    assert text.startswith("bouncing_ball: done at t = 0.5 s")
    assert "impact of ball-table" in text
    assert "ball-table: force" not in text


def test_text_of_a_run_ends_with_the_forces_of_contacts_that_press(modelgen: Modelgen) -> None:
    ball = "scenes/sphere_slide_to_roll.toml"
    slipping = modelgen("simulate", ball, "--until", 0.1, "--json").json["contacts"]["ball-table"]
    assert "\nball-table: force 9.81\n" in modelgen("simulate", ball).out
    assert "\nball-table: force 9.81, friction 1.962\n" in modelgen("simulate", ball, "--until", 0.1).out
    assert slipping == {"force": pytest.approx(9.81), "friction": pytest.approx([-1.962, 0, 0])}


def test_forces_of_many_contacts_are_counted() -> None:
    lines = list(contact_lines({f"c{k}": {"force": 1.0, "friction": [0.0] * 3} for k in range(23)}))
    assert (len(lines), lines[-1]) == (21, "... 3 more contacts press; --json and --out hold all")


def test_inspect_writes_each_formula_with_source_and_units(modelgen: Modelgen) -> None:
    facts = modelgen("inspect", EGG, "--json").json
    counts = modelgen("check", EGG, "--json").json["instructions"]
    assert {f["name"]: f["instructions"] for f in facts["formulas"]} == counts
    for formula in facts["formulas"]:
        assert formula["citation"]
        assert formula["definition"]
        for port in (*formula["inputs"], *formula["outputs"], *formula["steps"]):
            assert port["unit"]
            assert port["meaning"]


def test_schema_is_valid_and_admits_the_shipped_scenes(modelgen: Modelgen) -> None:
    schema = modelgen("schema").json
    Draft202012Validator.check_schema(schema)
    for path in FILES:
        Draft202012Validator(schema).validate(tomllib.loads(path.read_text()))


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", EGG),
        ("build", EGG),
        ("simulate", EGG, "--until", 0.01),
        ("inspect", EGG),
        ("inspect", EGG, "--format", "latex"),
        ("schema",),
    ],
    ids=lambda arguments: arguments[0],
)
def test_json_is_one_object_and_nothing_else(arguments: tuple[object, ...], modelgen: Modelgen) -> None:
    answer = modelgen(*arguments, "--json")
    assert answer.code == 0
    assert answer.json
    assert answer.out.count("\n") == 1
