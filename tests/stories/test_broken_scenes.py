"""Every broken scene through the command line: one message with place and remedy, exit 2, nothing written."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.scene.broken_meaning import MEANING
from tests.scene.broken_structure import CONTACT, EGG, SOUND, STRUCTURAL, Case, egg

Modelgen = Callable[..., Any]

TWO_BALLS = EGG + EGG.replace('"egg"', '"table"') + "position = [0.0, 0.0, 1.0]\n" + CONTACT
TWO_TORI = TWO_BALLS.replace('"sphere", radius = 0.1', '"torus", major = 0.2, minor = 0.1')
REFUSED_LATER: list[Case] = [
    ("interpenetrating start", SOUND, ["interpenetrate", "egg-table", "move"]),
    (
        "form that does not apply",
        TWO_BALLS + 'form = "support"',
        ["contact[0].form", "'support' does not apply", "allowed: auto"],
    ),
    (
        "form of another pair",
        TWO_TORI + 'form = "explicit"',
        ["contact[0].form", "'explicit' does not apply", "'implicit'?"],
    ),
    (
        "two planes",
        TWO_BALLS.replace('"sphere", radius = 0.1', '"plane"'),
        [
            "broken.toml: contact[0] (contact 'egg-table'): no form has isolated",
            "give one ends: a box for a plane",
        ],
    ),
    (
        "two points",
        TWO_BALLS.replace('"sphere", radius = 0.1', '"point", at = [0, 0, 0]').replace(
            "density = 1000.0", "mass = 1.0\ninertia = [1, 1, 1]"
        ),
        ["broken.toml: contact[0] (contact 'egg-table'): two points", "make it a sphere"],
    ),
    ("huge mass", egg("", mass="mass = 1e31\ninertia = [1.0, 1.0, 1.0]\n"), ["mass", "1e+31", "up to"]),
    ("NaN gravity", "gravity = [0, 0, nan]\n" + SOUND, ["gravity[2]", "nan", "number"]),
]
CASES = [*STRUCTURAL, *MEANING, *REFUSED_LATER]


def is_one_message(text: str) -> bool:
    return text.endswith("\n") and text.count("\n") == 1 and "Traceback" not in text


@pytest.mark.parametrize(("text", "fragments"), [pytest.param(*case[1:], id=case[0]) for case in CASES])
def test_a_broken_scene_is_refused(
    text: str, fragments: list[str], modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.toml").write_text(text)
    answer = modelgen("simulate", "broken.toml", "--out", "run.npz", "--json")
    assert (answer.code, answer.out) == (2, "")
    assert is_one_message(answer.err)
    assert not [fragment for fragment in fragments if fragment not in answer.err]
    assert [path.name for path in tmp_path.iterdir()] == ["broken.toml"]


@pytest.mark.parametrize(
    ("argument", "words"),
    [("none.toml", "no such file"), ("folder", "it is a folder"), ("junk.toml", "UTF-8")],
)
def test_what_is_no_scene_file_is_refused(
    argument: str, words: str, modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "junk.toml").write_bytes(b"\x7fELF\xff\xfe")
    answer = modelgen("simulate", argument)
    assert (answer.code, answer.out) == (2, "")
    assert argument in answer.err
    assert words in answer.err
    assert is_one_message(answer.err)
    assert {path.name for path in tmp_path.iterdir()} == {"folder", "junk.toml"}


def test_a_hostile_scene_executes_nothing_in_a_process_of_its_own(tmp_path: Path) -> None:
    hostile = f"__import__('os').mkdir('{tmp_path}/taken')"
    (tmp_path / "broken.toml").write_text(egg(f'position = [0, 0, "{hostile}"]'))
    answer = subprocess.run(
        [sys.executable, "-c", "from modelgen.cli import main; main()", "simulate", "broken.toml"],
        cwd=tmp_path, env={"PYTHONPATH": str(Path(__file__).parents[2])}, capture_output=True, text=True,
    )  # fmt: skip
    assert (answer.returncode, answer.stdout) == (2, "")
    assert answer.stderr.startswith("broken.toml: body[1].position[2] (body 'egg'): ")
    assert is_one_message(answer.stderr)
    assert [path.name for path in tmp_path.iterdir()] == ["broken.toml"]
