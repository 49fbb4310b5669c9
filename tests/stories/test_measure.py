"""What accuracy costs, through the command line, on a small scene with few settings."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from math import log10
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from modelgen.benchmark import setting_evaluation as program
from modelgen.benchmark.work_precision_front import Point
from modelgen.runtime.core_session import Session

EGG = "scenes/ellipsoid_on_plane.toml"
FEW = ("--knobs", "tolerance,form", "--until", "0.5")
Modelgen = Callable[..., Any]
pytestmark = pytest.mark.usefixtures("hasty")


def test_the_front_answers_to_its_schema_and_falls(modelgen: Modelgen, tmp_path: Path) -> None:
    facts = modelgen("measure", EGG, *FEW, "--plot", tmp_path / "front.svg", "--json").json
    Draft202012Validator(modelgen("schema").json["$defs"]["measured"]).validate(facts)
    placed = [(point["cost_ns_per_s"], point["error"]) for point in facts["front"]]
    assert placed == sorted(placed, reverse=False)
    assert [error for _, error in placed] == sorted((error for _, error in placed), reverse=True)
    assert facts["reference_error"] < 1e-14
    assert facts["horizon"] is None
    assert placed[-1][1] < 1e-12
    assert (tmp_path / "front.svg").is_file()


def test_extremes_answer_to_their_schema_and_hold(modelgen: Modelgen) -> None:
    answer = modelgen("measure", "--extremes", "--only", "gap,penetration", "--json")
    Draft202012Validator(modelgen("schema").json["$defs"]["surveyed"]).validate(answer.json)
    assert answer.json["holds"]
    assert [each["name"] for each in answer.json["extremes"]] == ["gap", "penetration"]
    assert "penetration" in modelgen("measure", "--extremes", "--only", "penetration").out


def test_an_interrupted_survey_prints_what_it_has_and_says_so(
    modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopping(self: Session, *arguments: Any) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(Session, "advance", stopping)
    answer = modelgen("measure", "--extremes", "--only", "gap,unit of mass")
    assert answer.code == 130
    assert "gap  " in answer.out
    assert answer.out.splitlines()[-1].startswith("interrupted: ")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((EGG, "--only", "gap"), "--only: with the scene"),
        (("--extremes", "--until", "1"), "--until: with --extremes; --only and --json go with it"),
        (("--extremes", "--plot", "front.svg"), "--plot: with --extremes"),
        (("--extremes", "--fresh"), "--fresh: with --extremes"),
        (("--extremes", "--limit", "9"), "--limit: with --extremes"),
        (("--extremes", "--against", "mujoco"), "--against: with --extremes"),
        (("--extremes", "--only", ""), "--only: ''; names with commas between them"),
        ((EGG, "--knobs", " , "), "--knobs: ' , '; names with commas between them"),
        ((EGG, "--against", ""), "--against: ''; names"),
        ((EGG, "--knobs", "foo"), "--knobs: no 'foo'; allowed: method, tolerance"),
        ((EGG, "--against", "foo"), "--against: no 'foo'; allowed: mujoco"),
        ((EGG, "--against", "foo"), "use one of these names"),
        (("--extremes", "--only", "foo"), "--only: no 'foo'; allowed: gap"),
        (("--extremes", "--only", "needel"), "did you mean 'needle'?"),
    ],
)
def test_no_option_is_passed_over(modelgen: Modelgen, options: tuple[str, ...], words: str) -> None:
    answer = modelgen("measure", *options)
    assert (answer.code, answer.out) == (2, "")
    assert words in answer.err


@pytest.mark.parametrize("wrong", [(), (EGG, "--extremes"), ("--extremes", "--only", "gaps")])
def test_measure_wants_a_scene_or_extremes_by_name(modelgen: Modelgen, wrong: tuple[str, ...]) -> None:
    answer = modelgen("measure", *wrong)
    assert answer.code == 2
    assert answer.err


def test_tighter_tolerances_never_raise_the_error_above_its_floor(modelgen: Modelgen) -> None:
    points = modelgen("measure", EGG, *FEW, "--json").json["points"]
    plain = {
        point["settings"]["tolerance"]: point["error"]
        for point in points
        if point["settings"]["form"] == "auto"
    }
    errors = [plain[tolerance] for tolerance in sorted(plain, reverse=True)]
    floor = 10 * min(errors)
    assert all(b <= 2 * a for a, b in itertools.pairwise(errors) if b > floor)


@pytest.mark.slow
def test_what_was_measured_is_remembered_and_a_fresh_error_is_the_same(modelgen: Modelgen) -> None:
    first = modelgen("measure", EGG, *FEW, "--json").json
    again = modelgen("measure", EGG, *FEW, "--json").json
    assert again["reused"] == len(again["points"])
    assert again["front"] == first["front"]
    fresh = modelgen("measure", EGG, *FEW, "--fresh", "--json").json
    assert fresh["reused"] == 0
    known = {json.dumps(point["settings"]): point["error"] for point in first["points"]}
    shared = [point for point in fresh["points"] if json.dumps(point["settings"]) in known]
    assert shared
    assert all(point["error"] == known[json.dumps(point["settings"])] for point in shared)


def test_an_interrupted_measurement_keeps_what_it_has_and_goes_on(
    modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[Point] = []
    measured = program._measured

    def stopping(bench: program.Bench, settings: Any) -> Point:
        if len(taken) == 3:
            raise KeyboardInterrupt
        taken.append(measured(bench, settings))
        return taken[-1]

    span = ("--knobs", "tolerance", "--until", "0.3")
    monkeypatch.setattr(program, "_measured", stopping)
    stopped = modelgen("measure", EGG, *span, "--json")
    assert stopped.code == 130
    assert len(stopped.json["points"]) == 3
    assert "goes on from there" in stopped.json["interrupted"]
    tuning = modelgen("tune", EGG, *span, "--error", 1e-3, "--json")
    assert (tuning.code, tuning.out) == (130, "")
    assert "interrupted: what was measured is kept, the same command goes on from there" in tuning.err
    monkeypatch.setattr(program, "_measured", measured)
    done = modelgen("measure", EGG, *span, "--json").json
    assert done["reused"] == 3
    assert len(done["points"]) > 3


@pytest.mark.parametrize(
    "exponent", [pytest.param(3, marks=pytest.mark.slow), 6, pytest.param(10, marks=pytest.mark.slow)]
)
def test_a_tuned_scene_keeps_its_promise(modelgen: Modelgen, tmp_path: Path, exponent: int) -> None:
    error = 10.0**-exponent
    target = tmp_path / "tuned.toml"
    facts = modelgen("tune", EGG, *FEW, "--error", error, "--out", target, "--json").json
    Draft202012Validator(modelgen("schema").json["$defs"]["tuned"]).validate(facts)
    assert facts["error"] <= error
    text = target.read_text(encoding="utf-8")
    assert "# m (b^2 + c^2) / 5 and so on" in text
    assert f"tolerance = {json.dumps(facts['settings']['tolerance'])}" in text
    run = modelgen("simulate", target, "--until", 0.5, "--json").json
    assert f"tolerance {facts['settings']['tolerance']:g}" in run["accuracy"]
    assert run["energy_drift"] == facts["errors"]["energy"]


def test_tune_names_the_file_that_it_wrote(modelgen: Modelgen, tmp_path: Path) -> None:
    answer = modelgen("tune", EGG, *FEW, "--error", 1e-3, "--out", tmp_path / "tuned.toml")
    assert answer.out.endswith(f"\nwritten: {tmp_path / 'tuned.toml'}\n")


@pytest.mark.slow
def test_a_budget_is_kept_within_its_band(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a machine whose runs take as long as their tolerance has digits."""
    monkeypatch.setattr(
        program, "core_time", lambda library, accuracy, end: -1e-5 * log10(accuracy.tolerance)
    )
    monkeypatch.setattr(program.Bench, "yard", lambda bench: 1e-3)
    few = (*FEW[:-1], "0.4")  # remembered apart
    front = modelgen("measure", EGG, *few, "--json").json["front"]
    middle = front[len(front) // 2]["cost_ns_per_s"]
    answer = modelgen("tune", EGG, *few, "--budget", f"{middle}ns", "--out", tmp_path / "t.toml", "--json")
    assert answer.json["cost_ns_per_s"] <= 1.2 * middle


def test_an_ample_budget_buys_the_finest_setting(modelgen: Modelgen, tmp_path: Path) -> None:
    front = modelgen("measure", EGG, *FEW, "--json").json["front"]
    ample = 10 * max(point["cost_ns_per_s"] for point in front)
    answer = modelgen("tune", EGG, *FEW, "--budget", f"{ample}ns", "--out", tmp_path / "t.toml", "--json")
    assert answer.json["cost_ns_per_s"] <= 1.2 * ample
    assert answer.json["error"] == min(point["error"] for point in front)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--error", "1e-18"), "--error: 1e-18 is not reached; the reachable error is"),
        (
            ("--budget", "1ns"),
            "--budget: 0.001 us per simulated second is not enough; the cheapest setting takes",
        ),
        (("--budget", "20"), "a time with its unit"),
        (("--budget", "-20us"), "--budget: '-20us'; a time such as 20us, positive"),
        (("--error", "small"), "a number such as 1e-6"),
        ((), "tune: neither an error nor a budget; one of them: --error 1e-6 or --budget 20us"),
        (("--error", "1e-3", "--budget", "1ms"), "tune: an error and a budget; one of them"),
        (("--error", "1e-3", "--knobs", "tolerence"), "did you mean 'tolerance'?"),
        (("--error", "1e-3", "--in-place", "--out", "x.toml"), "together with --in-place"),
        (("--error", "1e-3", "--out", EGG), "is the scene itself; another file; or give --in-place"),
        (("--error", "1e-3", "--out", ""), "--out: '.' is a folder; a file; name one"),
        (("--error", "1e-3", "--out", "t.txt"), "--out: 't.txt'; a scene file, .toml; write t.toml"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(
    modelgen: Modelgen, tmp_path: Path, options: tuple[str, ...], words: str
) -> None:
    target = () if "--out" in options else ("--out", tmp_path / "t.toml")
    answer = modelgen("tune", EGG, *FEW, *options, *target)
    assert answer.code == 2
    assert words in answer.err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_scene_with_another_form_and_real_type_runs_as_it_says(modelgen: Modelgen, tmp_path: Path) -> None:
    text = Path(EGG).read_text(encoding="utf-8")
    own = 'until = 0.2\nform = "implicit"\nreal = "float"\nlevel = "O3"\nnewton = 2\ntolerance = 1e-4\n'
    target = tmp_path / "own.toml"
    target.write_text(text.replace("until = 2.0\n", own), encoding="utf-8")
    assert {c["form"] for c in modelgen("check", target, "--json").json["contacts"]} == {"implicit"}
    assert modelgen("build", target, "--json").json["real"] == "float"
    assert modelgen("simulate", target, "--json").json["accuracy"] == "tolerance 0.0001, newton 2"
