"""The verb `linearise`: for people, for programs, and where there is nothing to linearise."""

from __future__ import annotations

from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from rich.console import Console

from modelgen.report.linearisation_output import print_steady
from modelgen.report.stability_output import print_stability
from tests.linearisation.test_steady import WHEEL

Modelgen = Callable[..., Any]
RINGS = "scenes/linked_rings.toml"


def printed(show: Callable[[Any, Console], None], facts: dict[str, Any]) -> str:
    """What a command prints of its facts for people."""
    text = StringIO()
    show(facts, Console(file=text, width=500))
    return text.getvalue()


def test_it_answers_to_its_schema(modelgen: Modelgen) -> None:
    facts = modelgen("linearise", RINGS, "--json").json
    schema = modelgen("schema").json["$defs"]["linearised"]
    Draft202012Validator.check_schema(schema)
    Draft202012Validator(schema).validate(facts)
    assert facts["scene"] == "linked_rings"
    assert facts["bodies"]["ring"]["p"] == pytest.approx([0, 0, -0.35], abs=1e-12)
    across = [mode for mode in facts["modes"] if abs(mode["shape"]["ring"]["v"][1]) == 1]
    assert [mode["frequency"] for mode in across] == pytest.approx([np.sqrt(9.81 / 0.15)])
    assert all(mode["hertz"] == pytest.approx(mode["frequency"] / (2 * np.pi)) for mode in facts["modes"])


def test_people_read_the_same(modelgen: Modelgen) -> None:
    text, facts = modelgen("linearise", RINGS).out, modelgen("linearise", RINGS, "--json").json
    assert text.startswith("linked_rings: at rest")
    for mode in facts["modes"]:
        assert mode["kind"] in text
        if mode["frequency"]:
            assert f"{mode['frequency']:.9g} rad/s" in text
    assert "hook-ring" in text


def test_steady_motions_and_their_stability_answer_to_their_schemas(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wheel.toml").write_text(WHEEL)
    schemas = modelgen("schema").json["$defs"]
    facts = modelgen("linearise", "wheel.toml", "--steady", "--json").json
    Draft202012Validator(schemas["linearised_steady"]).validate(facts)
    assert facts["bodies"]["wheel"]["w"] == pytest.approx([0, 10, 0])
    assert [mode["kind"] for mode in facts["modes"]] == ["neutral", "neutral", "oscillation"]
    assert "steady motion, unchanged along 4 directions" in printed(print_steady, facts)
    over = ("--vary", "speed=0.5:0.6:2", "--plot", "speeds.svg")
    found = modelgen("linearise", "wheel.toml", *over, "--json").json
    Draft202012Validator(schemas["stability"]).validate(found)
    assert found["stable"] == [pytest.approx([0.571839138, 0.6])]
    assert Path("speeds.svg").read_text().startswith("<?xml")
    assert "speed from 0.571839" in printed(print_stability, found)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--vary", "speed=0:10"), "a grid needs values"),
        (("--vary", "speed=3:1:5"), "from 3 to 1"),
        (("--vary", "sped=1:3:5"), "speed"),
        (("--plot", "x.png"), "no --vary"),
    ],
)
def test_ranges_that_are_none_are_refused(modelgen: Modelgen, options: tuple[str, ...], message: str) -> None:
    answer = modelgen("linearise", "scenes/bicycle.toml", *options)
    assert (answer.code, answer.out) == (2, "")
    assert message in answer.err


def test_a_forced_form_has_the_same_frequencies(modelgen: Modelgen) -> None:
    egg = "scenes/ellipsoid_on_plane.toml"
    free, forced = (modelgen("linearise", egg, "--json", *more).json for more in ((), ("--form", "implicit")))
    frequencies = [[mode["frequency"] for mode in facts["modes"]] for facts in (free, forced)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-9)


def test_a_scene_without_rest_is_refused_and_leaves_nothing(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ball = Path("scenes/bouncing_ball.toml").read_text()
    monkeypatch.chdir(tmp_path)
    Path("ball.toml").write_text(ball)
    answer = modelgen("linearise", "ball.toml", "--json")
    assert (answer.code, answer.out) == (2, "")
    assert "no equilibrium near the start" in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["ball.toml"]


def test_values_of_parameters_are_those_of_a_scene_with_these_numbers(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rings = Path(RINGS).read_text()
    monkeypatch.chdir(tmp_path)
    assert "gravity" not in rings
    named = '\n[[parameter]]\nname = "pull"\nvalue = 9.81\nmaximum = 20\n'
    Path("rings.toml").write_text('gravity = [0, 0, "-pull"]\n' + rings + named)
    facts = modelgen("linearise", "rings.toml", "--set", "pull=2.5", "--json").json
    across = [mode for mode in facts["modes"] if abs(mode["shape"]["ring"]["v"][1]) == 1]
    assert [mode["frequency"] for mode in across] == pytest.approx([np.sqrt(2.5 / 0.15)])
    refused = modelgen("linearise", "rings.toml", "--set", "pull=30")
    assert refused.code == 2
    assert "parameters: pull: the number 30.0; at most 20 is allowed" in refused.err
