"""What the README shows works as printed."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from modelgen import __version__, require
from modelgen.cli.commands import app
from modelgen.scene.read import read_text

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(ROOT / "scenes", tmp_path / "scenes")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("code", blocks("python"))
def test_python_block_runs(code: str, workplace: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert result.returncode == 0, result.stderr


def test_commands_run_in_order(workplace: Path) -> None:
    lines = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("modelgen ")]
    assert len(lines) >= 4
    for line in lines:
        result = CliRunner().invoke(app, shlex.split(line)[1:])
        assert result.exit_code == 0, f"{line}\n{result.output}"


def test_whole_scene_block_is_a_scene() -> None:
    scenes = [block for block in blocks("toml") if "[[contact]]" in block]
    assert len(scenes) == 1
    scene = read_text(scenes[0], "readme.toml")
    assert [body.name for body in scene.bodies] == ["lift", "egg"]


def test_surface_block_is_the_shape_of_a_body() -> None:
    bodies = [block for block in blocks("toml") if 'kind = "chart"' in block]
    assert len(bodies) == 1
    scene = read_text(bodies[0] + BALL, "readme.toml")
    assert scene.bodies[0].shapes[0].kind == "chart"


def test_observing_and_folding_leave_states_and_parameters_out() -> None:
    (keys,) = (block for block in blocks("toml") if "observe =" in block)
    whole = (ROOT / "scenes/ball_in_bowl.toml").read_text(encoding="utf-8").replace(
        'name = "ball"', 'name = "ball"\nangular_velocity = [0.0, 0.0, 1.0]'
    )  # fmt: skip
    full, less = (require(read_text(text, "readme.toml")) for text in (whole, keys + whole))
    assert (full.n_q, less.n_q) == (7, 3)
    assert [link.parameters for link in full.links] == [(0.1, 0.12)]
    assert [link.parameters for link in less.links] == [()]
    assert "ball: orientation and spin left out" in less.left_out[0]


BALL = """
[[body]]
name = "ball"
density = 1.0
position = [0.0, 0.0, 1.0]
shape = { kind = "sphere", radius = 0.1 }

[[contact]]
between = ["ball", "sheet"]
"""


def test_the_test_command_is_stated_once_for_ci() -> None:
    assert len(re.findall(r"^python3 -m venv .*-m pytest$", README, re.MULTILINE)) == 1


def test_changelog_names_the_version() -> None:
    assert f"### {__version__}" in README
    assert f'version = "{__version__}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
