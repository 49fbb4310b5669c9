"""The verb `sensitivity`: for people, for programs, beside differences of runs, and where it is refused."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from modelgen.runtime.sensitivity import REASONS

ROOT = Path(__file__).parents[2]
Modelgen = Callable[..., Any]
BALL = "scenes/bouncing_ball.toml"
CORNER = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "wall"
motion = "fixed"
rpy = [0.0, "pi/2", 0.0]
shape = { kind = "plane" }
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
density = 500.0
position = [0.6, 0.0, 0.6]
velocity = [-1.0, 0.0, -1.0]
[[contact]]
between = ["ball", "floor"]
restitution = 0.5
[[contact]]
between = ["ball", "wall"]
restitution = 0.5
"""
G, E, FALL = 9.81, 0.7, 1.0  # of the scene: m/s^2, restitution, height of fall in m
ARGUMENTS = ("sensitivity", BALL, "--by", "ball.position,ball.velocity", "--of", "ball.position", "--at")


def test_it_answers_to_its_schema_with_closed_forms_and_differences(modelgen: Modelgen) -> None:
    t, strikes = 0.6, sqrt(2 * FALL / G)
    facts = modelgen(*ARGUMENTS, f"0.2,{t}", "--accuracy", "tight", "--check", "--json").json
    schema = modelgen("schema").json["$defs"]["sensitivity"]
    Draft202012Validator.check_schema(schema)
    Draft202012Validator(schema).validate(facts)
    assert facts["of"] == ["ball.position_x", "ball.position_y", "ball.position_z"]
    assert facts["by"][2::3] == ["ball.position_z", "ball.velocity_z"]
    assert [each["kind"] for each in facts["verdicts"]] == ["differentiable"] * 2
    by_height, by_speed = facts["jacobian"][0][2][2], facts["jacobian"][0][2][5]
    assert (by_height, by_speed) == pytest.approx((1, 0.2), rel=1e-12)
    speed = sqrt(2 * G * FALL)  # z = e speed (t - strikes) - g (t - strikes)^2 / 2
    later = E * G / speed * (t - strikes) + (G * (t - strikes) - E * speed) / speed
    assert facts["jacobian"][1][2][2] == pytest.approx(later, rel=1e-10)
    assert facts["differences"][1][2][2] == pytest.approx(later, rel=1e-6)
    assert 0 <= facts["error"][1][2][2] < 1e-6
    (event,) = facts["events"]
    assert event["t"] == pytest.approx(strikes, rel=1e-12)
    assert event["by"][2] == pytest.approx(1 / speed, rel=1e-10)
    assert facts["outcome"] == "done"


def test_people_read_the_same_and_why_a_derivative_is_not_certain(modelgen: Modelgen, tmp_path: Path) -> None:
    """A ball strikes floor and wall at one time; a changed one strikes either first."""
    (tmp_path / "corner.toml").write_text(CORNER)
    scene = str(tmp_path / "corner.toml")
    arguments = ("sensitivity", scene, "--by", "ball.velocity", "--of", "ball.position", "--at", "0.2,1.0")
    text, facts = (modelgen(*arguments, *more) for more in ((), ("--json",)))
    assert text.code == facts.code == 0
    for k, t in enumerate((0.2, 1.0)):
        assert f"t = {t:g} s" in text.out
        assert f"{facts.json['jacobian'][k][2][2]:.8g}" in text.out
    doubt = facts.json["verdicts"][1]
    assert doubt["kind"] == "undecided"
    assert doubt["contact"] in ("ball-floor", "ball-wall")
    assert f"undecided: {doubt['reason']}, t = {doubt['t']:.6g} s at {doubt['contact']}" in text.out
    assert "\ndifferentiable\n" in text.out


def test_a_run_that_ends_early_keeps_what_it_has(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Path(BALL).read_text()
    monkeypatch.chdir(tmp_path)
    push = '\n[[force]]\nbody = "ball"\nforce = ["1/(0.3 - t)**2", 0.0, 0.0]\n'
    Path("ball.toml").write_text(scene + push)
    arguments = (
        "sensitivity",
        "ball.toml",
        "--by",
        "ball.position",
        "--of",
        "ball.position",
        "--at",
        "0.1,0.5",
    )
    answer = modelgen(*arguments, "--check", "--json")
    assert answer.code == 1
    assert answer.json["outcome"] == "not_finite"
    assert answer.err.startswith("not_finite: ")
    assert answer.json["jacobian"][0][2][2] == pytest.approx(1)
    assert answer.json["differences"][0][2][2] == pytest.approx(1, abs=1e-6)
    assert answer.json["jacobian"][1][2][2] is answer.json["differences"][1][2][2] is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--by", "ball.speed"), "by: 'ball.speed'"),
        (("--by", ","), "--by: ','; names, separated by commas"),
        (("--by", "ball.velocity", "--of", "ball.colour"), "of: 'ball.colour'"),
        (("--by", "ball.velocity"), "of: nothing"),
        (("--by", "ball.velocity", "--at", "soon"), "--at: 'soon'"),
        (("--by", "ball.velocity", "--of", "ball.position", "--at", "0.2,0.1"), "ascending times"),
        (("--by", "ball.velocity", "--of", "ball.position", "--at", "inf"), "finite"),
        (("--by", "ball.velocity", "--of", "ball.position", "--set", "mass=1"), "mass"),
    ],
)
def test_what_is_refused_is_named(arguments: tuple[str, ...], message: str, modelgen: Modelgen) -> None:
    answer = modelgen("sensitivity", BALL, *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err
    assert "Traceback" not in answer.err


@pytest.mark.parametrize(
    "arguments",
    [
        ("sensitivity", BALL, "--by", "ball.speed"),
        ("sensitivity", BALL, "--by", "ball.velocity", "--of", "ball.colour"),
        ("fit", BALL, "recorded.csv", "--by", "ball.speed"),
    ],
    ids=" ".join,
)
def test_names_are_refused_before_anything_is_compiled(
    arguments: tuple[str, ...], modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("modelgen.build", None)
    (tmp_path / "recorded.csv").write_text("t,ball.position_z\n0,1\n0.1,0.9\n")
    answer = modelgen(*[str(tmp_path / each) if each == "recorded.csv" else each for each in arguments])
    assert answer.code == 2
    assert "; known: " in answer.err


def test_every_cause_of_doubt_is_in_the_manual() -> None:
    page = (ROOT / "modelgen" / "manual" / "sensitivities.md").read_text(encoding="utf-8")
    assert not [reason for reason in REASONS if reason not in page]
