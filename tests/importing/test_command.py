"""`modelgen import`: what it writes and prints, and how it refuses."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from modelgen import read
from modelgen.cli.command_group import app
from tests.importing.profiles import rail_head

BALL = '<mujoco><worldbody><body name="b"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'


@pytest.fixture
def rail(tmp_path: Path) -> Path:
    path = tmp_path / "rail.csv"
    np.savetxt(path, 1e3 * rail_head(300), delimiter=",", header="y,z", comments="")
    return path


def told(*words: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["import", *words])
    return result.exit_code, result.stdout, result.stderr


def test_a_scene_is_written_or_printed_with_what_is_approximated(rail: Path) -> None:
    out = rail.with_suffix(".toml")
    options = [str(rail), "--as", "profile_wall", "--unit", "mm", "--columns", "y,z", "--tolerance", "1e-5"]
    code, printed, _ = told(*options, "--out", str(out))
    assert code == 0
    assert printed.splitlines()[0] == f"written: {out}"
    assert printed.splitlines()[1].startswith("taken otherwise: 300 points are a spline through")
    assert read(out).bodies[0].name == "rail"
    assert told(*options)[1] == out.read_text()
    facts = json.loads(told(*options, "--json")[1])
    assert (facts["scene"], facts["file"], facts["text"]) == ("rail", None, out.read_text())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "--as: no shape; allowed: revolution"),
        (("--as", "wall"), "--as: 'wall'"),
        (("--as", "revolution", "--length", "2"), "--length: it with a revolution"),
        (("--as", "profile_wall", "--length", "-2"), "--length: the number -2;"),
        (("--as", "profile_wall", "--floating"), "--floating: it with a file of profile"),
        (("--as", "profile_wall", "--out", "nowhere/a.toml"), "no folder 'nowhere'"),
    ],
)
def test_mistakes_are_refused_with_exit_code_2(rail: Path, options: tuple[str, ...], message: str) -> None:
    code, printed, error = told(str(rail), *options)
    assert (code, printed) == (2, "")
    assert message in error


def test_the_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "ball.xml"
    path.write_text(BALL)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    code, _, error = told(str(path))
    assert code == 2
    assert "no package 'mujoco'" in error
    assert 'pip install "modelgen-contact[import]"' in error
