"""Settings in the [run] table of a scene file: what they change, and what they leave."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from modelgen.benchmark.run_table_rewriting import with_run_table
from modelgen.benchmark.scene_under_measurement import applied
from modelgen.errors import ModelgenError
from modelgen.scene.read import read_text

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.toml"))
SETTINGS = {"method": "dop853", "tolerance": 1e-08, "form": "auto", "project": 0, "use_gamma": True}
TEXT = """# a scene
gravity = [0.0, 0.0, -9.81]  # downwards

[run]  # how
until = 2.0  # s
tolerance = 1e-3  # coarse
step = 0.1
# a remark

[[body]]
name = "ball"
density = 1.0
shape = { kind = "sphere", radius = 0.1 }
"""


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_shipped_scene_takes_settings_and_keeps_every_line(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    changed = with_run_table(text, SETTINGS, path.name)
    before, after = (read_text(each, path.name) for each in (text, changed))
    assert after.run == applied(before.run, SETTINGS)
    assert set(text.splitlines()) - set(changed.splitlines()) <= {
        line for line in text.splitlines() if line.startswith("tolerance")
    }


def test_keys_are_rewritten_with_their_comments_and_what_no_longer_holds_goes() -> None:
    changed = with_run_table(TEXT, SETTINGS, "ball.toml")
    assert "tolerance = 1e-08  # coarse\n" in changed
    assert "until = 2.0  # s\n" in changed
    assert "# a remark\n" in changed
    assert "step" not in changed
    assert "form" not in changed  # as it is unasked


def test_a_second_change_leaves_no_trace_of_the_first() -> None:
    other = {"method": "rk4", "step": 0.001, "form": "implicit"}
    twice, once = (
        tomllib.loads(with_run_table(text, other, "")) for text in (with_run_table(TEXT, SETTINGS, ""), TEXT)
    )
    assert twice == once


def test_a_file_without_a_run_table_gets_one() -> None:
    text = TEXT.replace("[run]", "[other]").split("[other]")[0] + TEXT[TEXT.index("[[body]]") :]
    assert read_text(with_run_table(text, SETTINGS, ""), "ball.toml").run.tolerance == 1e-8


@pytest.mark.parametrize("run", ["run = { until = 2.0 }", "run.until = 2.0"])
def test_a_run_that_is_no_table_of_its_own_is_refused(run: str) -> None:
    text = f"{run}\n{TEXT[TEXT.index('[[body]]') :]}"
    with pytest.raises(ModelgenError, match="write a \\[run\\] table"):
        with_run_table(text, SETTINGS, "ball.toml")
