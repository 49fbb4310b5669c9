"""`modelgen new` writes scenes that check, run and end as they should."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from modelgen.cli.new import TEMPLATES, kinds, shipped, template
from tests.running import FILES, NAMES

Modelgen = Callable[..., Any]


def test_kinds_and_shipped_scenes_are_listed_with_a_line_each(modelgen: Modelgen) -> None:
    listed = modelgen("new")
    assert listed.code == 0
    lines = [line.split(maxsplit=1) for line in listed.out.splitlines() if line.startswith("  ")]
    assert [name for name, _ in lines] == [*kinds(), *NAMES]
    facts = modelgen("new", "--json").json
    assert facts["kinds"] == kinds()
    assert facts["kinds"] | facts["scenes"] == dict(lines)
    assert all(line.endswith(".") for line in facts["scenes"].values())
    assert {path.stem for path in TEMPLATES.iterdir()} == set(kinds())


def test_no_kind_has_the_name_of_a_shipped_scene() -> None:
    assert tuple(shipped().values()) == FILES
    assert not set(kinds()) & set(shipped())


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", NAMES)
def test_a_shipped_scene_is_copied(
    modelgen: Modelgen, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert modelgen("new", name, "--json").json == {"name": name, "file": f"{name}.toml"}
    assert (tmp_path / f"{name}.toml").read_bytes() == shipped()[name].read_bytes()


def test_all_shipped_scenes_are_written_and_none_replaced(modelgen: Modelgen, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "coin.toml").write_text("# changed\n")
    done = modelgen("new", "--scenes", "--out", folder, "--json")
    assert done.json == {"folder": str(folder), "written": len(NAMES) - 1, "kept": 1}
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {
        path.name: b"# changed\n" if path.stem == "coin" else path.read_bytes() for path in FILES
    }
    again = modelgen("new", "--scenes", "--out", folder)
    assert again.out == f"{folder}: 0 scenes written, {len(NAMES)} were there\n"


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


@pytest.mark.parametrize("kind", kinds())
def test_a_scene_is_drawn_by_its_bodies(kind: str) -> None:
    """A linkage is drawn by its joints, any other scene by the shapes of its bodies."""
    tables = tomllib.loads(template(kind))
    assert kind == "linkage" or all("shape" in body for body in tables["body"])


@pytest.mark.parametrize("kind", kinds())
def test_a_scene_runs_as_written_and_is_trusted(
    modelgen: Modelgen, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert modelgen("new", kind).code == 0
    run = modelgen("simulate", f"{kind}.toml")
    assert (run.code, run.out.splitlines()[-1]) == (0, "trusted")
    assert "warning" not in run.err


def test_a_scene_is_written_once(modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = modelgen("new", "sliding", "--out", tmp_path / "mine.toml", "--json")
    assert done.json == {"name": "sliding", "file": str(tmp_path / "mine.toml")}
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
        (("--out", "mine.toml"), "no scene is named"),
        (("coin_in_bowll",), "did you mean 'coin_in_bowl'?"),
        (("coin", "--scenes"), "named beside it"),
        (("--scenes", "--out", "scenes/coin.toml"), "is a file"),
    ],
)
def test_what_cannot_be_written_is_refused(modelgen: Modelgen, arguments: Any, words: str) -> None:
    refused = modelgen("new", *arguments)
    assert (refused.code, refused.out) == (2, "")
    assert words in refused.err
