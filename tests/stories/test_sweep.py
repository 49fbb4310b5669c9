"""`modelgen sweep` from the command line: a table, a summary, a picture, and clear refusals."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from modelgen.parameter_study.sweep_output import swept_schema

pytest.importorskip("pyarrow")

Modelgen = Callable[..., Any]
BALL = "scenes/bouncing_ball.toml"
HEIGHT = "--vary=ball.position_z=0.001,0.5,1"  # at the first it penetrates


def test_a_sweep_prints_its_outcomes_and_goes_on(modelgen: Modelgen, tmp_path: Path) -> None:
    command = ("sweep", BALL, HEIGHT, "--until", "0.5", "--out", tmp_path / "a", "--threads", "1")
    told = modelgen(*command)
    assert told.code == 0, told.err
    assert "bouncing_ball: 3 runs (grid): 2 done, 1 refused" in told.out
    assert "run 0 (ball.position_z = 0.001): refused: bouncing_ball.toml: contact[0]" in told.out
    again = modelgen(*command, "--plot", tmp_path / "a.png", "--of", "events,t_end", "--json")
    assert again.code == 0, again.err
    Draft202012Validator(swept_schema()).validate(again.json)
    assert again.json["known"] == 3
    assert again.json["outcomes"] == {"done": 2, "refused": 1}
    assert again.json["failed"][0]["numbers"] == {"ball.position_z": 0.001}
    assert (tmp_path / "a.png").stat().st_size > 1000
    drawn = modelgen("plot", tmp_path / "a", "-o", tmp_path / "b.svg", "--of", "outcome", "--json")
    assert drawn.json == {
        "file": str(tmp_path / "b.svg"),
        "scene": "bouncing_ball",
        "outcome": {"done": 2, "refused": 1},
    }
    picture = tmp_path / "c.png"
    assert f", {picture}" in modelgen(*command, "--plot", picture).out
    other = modelgen(*command[:3], "--until", "0.4", "--out", tmp_path / "a")
    assert (other.code, other.out) == (2, "")
    assert "another settings (until: 0.5, now 0.4)" in other.err


def test_a_sweep_of_which_every_run_fails_ends_with_code_1(modelgen: Modelgen, tmp_path: Path) -> None:
    told = modelgen("sweep", BALL, "--vary", "ball.position_z=0.001,0.002", "--out", tmp_path / "a")
    assert told.code == 1
    assert "every run failed" in told.err
    assert (tmp_path / "a" / "runs.parquet").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "--out: no folder"),
        (("--out", "x"), "nothing varies"),
        (("--out", "x", "--vary", "ball.position_z"), "write --vary mass=0.5:2:4"),
        (("--out", "x", "--vary", "ball.positon_z=1,2"), "did you mean 'ball.position_z'?"),
        (("--out", "x", HEIGHT, "--vary", "ball.position_z=3,4"), "a second value"),
        (("--out", "x", HEIGHT, "--samples", "0"), "--samples"),
        (("--out", "x", HEIGHT, "--threads", "many"), "--threads"),
        (("--out", "x", HEIGHT, "--of", "events"), "--plot"),
        (("--out", "x", HEIGHT, "--plot", "x.gif"), ".png, .svg"),
        (("--out", "x", HEIGHT, "--plot", "x.png", "--of", "evens"), "did you mean 'events'?"),
        (("--out", "x", HEIGHT, "--scheduler", "nonsense://1"), "does not answer"),
        (("--out", "x", HEIGHT, "--scheduler", "localhost"), "missing port number"),
        (("--out", "x.csv", HEIGHT), "write 'x'"),
        (("--out", BALL, HEIGHT), "is the scene itself"),
    ],
)
def test_bad_options_are_refused(modelgen: Modelgen, arguments: Any, words: str) -> None:
    if "--scheduler" in arguments:
        pytest.importorskip("distributed")
    refused = modelgen("sweep", BALL, *arguments)
    assert (refused.code, refused.out) == (2, ""), refused.out
    assert words in refused.err
    assert not Path("x").exists()


@pytest.mark.parametrize("missing", ["pyarrow", "distributed"])
def test_a_missing_extra_is_named(modelgen: Modelgen, missing: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    refused = modelgen("sweep", BALL, HEIGHT, "--out", "x", "--scheduler", "tcp://127.0.0.1:1")
    assert (refused.code, refused.out) == (2, "")
    assert f"no package {missing!r}" in refused.err
    assert 'pip install "modelgen-contact[' in refused.err


def test_plots_of_runs_have_no_columns(modelgen: Modelgen, tmp_path: Path) -> None:
    refused = modelgen("plot", BALL, "-o", tmp_path / "a.png", "--of", "events")
    assert refused.code == 2
    assert "leave it out for a run" in refused.err
    empty = modelgen("plot", tmp_path, "-o", tmp_path / "a.png")
    assert empty.code == 2
    assert "no sweep is in it" in empty.err
