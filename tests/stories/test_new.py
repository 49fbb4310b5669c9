"""`modelgen new` writes scenes that check, run and end as they should."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from modelgen import derive, emit, read, require, simulate
from modelgen.cli.new import FOLDER, kinds, template
from modelgen.report.check import check_facts
from modelgen.runtime.trajectory import Outcome
from tests.running import compiled

Modelgen = Callable[..., Any]
IN_STEPS = ("heap",)  # whose error is of order 1 in the step


def test_kinds_are_listed_with_a_line_each(modelgen: Modelgen) -> None:
    listed = modelgen("new")
    assert listed.code == 0
    assert [line.split()[0] for line in listed.out.splitlines()[: len(kinds())]] == list(kinds())
    assert modelgen("new", "--json").json == {"kinds": kinds()}
    assert {path.stem for path in FOLDER.iterdir()} == set(kinds())
    assert all(kinds().values())


@pytest.mark.parametrize("kind", kinds())
def test_a_scene_is_commented_and_has_a_number_to_change(kind: str) -> None:
    text = template(kind)
    lines = text.splitlines()
    assert lines[0] == f"# {kind}: {kinds()[kind]}"
    assert sum("#" in line for line in lines) >= 4
    tables = tomllib.loads(text)
    assert tables["body"]
    assert tables["sensor"]
    assert tables.get("parameter") or tables.get("input")


@pytest.mark.cases(2)
@pytest.mark.parametrize("kind", kinds())
def test_a_scene_is_checked_and_runs_to_its_end(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"{kind}.toml"
    path.write_text(template(kind), encoding="utf-8")
    derivation = derive(require(read(path)))
    assert check_facts(derivation)["kinds"]
    run = simulate(compiled(emit(derivation)), estimate=kind not in IN_STEPS)
    assert run.outcome is Outcome.DONE
    assert run.is_trusted or kind in IN_STEPS
    assert not run.warnings or kind in IN_STEPS


def test_a_scene_is_written_once(modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = modelgen("new", "sliding", "--out", tmp_path / "mine.toml", "--json")
    assert done.json == {"kind": "sliding", "file": str(tmp_path / "mine.toml")}
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == template("sliding")
    monkeypatch.chdir(tmp_path)
    assert modelgen("check", tmp_path / "mine.toml", "--brief").code == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("sliding", "--out", "scenes/coin.toml"), "there already"),
        (("slidng",), "did you mean 'sliding'?"),
        (("sliding", "--out", "mine.txt"), "mine.toml"),
        (("sliding", "--out", "nowhere/mine.toml"), "make it first"),
        (("--out", "mine.toml"), "no kind of scene"),
    ],
)
def test_what_cannot_be_written_is_refused(modelgen: Modelgen, arguments: Any, words: str) -> None:
    refused = modelgen("new", *arguments)
    assert (refused.code, refused.out) == (2, "")
    assert words in refused.err
