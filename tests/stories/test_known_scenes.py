"""A scene that was run before is run again without being derived, unless anything has changed since."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from modelgen.cli import built_library_lookup
from modelgen.cli.basic_commands import app
from modelgen.cli.built_library_lookup import NAME, recall, scene_key

Modelgen = Callable[..., Any]
ROOT = Path(__file__).parents[2]
EGG = Path("scenes/ellipsoid_on_plane.toml")
FOLDER = Path("generated/ellipsoid_on_plane")
HEAVY = (
    *("casadi", "scipy", "sympy", "mpmath", "matplotlib"),
    *("modelgen.scene.scene_types", "modelgen.scene.scene_from_tables"),
)


def key() -> str:
    found = scene_key(EGG, "")
    assert found is not None
    return found


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The folder of a first run, and its facts."""
    folder = tmp_path_factory.mktemp("known")
    (folder / "scenes").mkdir()
    shutil.copy(ROOT / EGG, folder / EGG)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        told = CliRunner().invoke(app, ["simulate", str(EGG), "--json"])
    return folder, json.loads(told.stdout)


@pytest.fixture
def ran(
    first: tuple[Path, dict[str, Any]], modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> dict[str, Any]:
    """The facts of a first run; the working folder is a copy of its folder."""
    shutil.copytree(first[0], tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return without_time(first[1])


def without_time(facts: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in facts.items() if name != "wall_s"}


def refuse_to_derive(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise AssertionError("the scene was derived again")

    monkeypatch.setattr("modelgen.cli.pipeline.derive_scene", refused)


def test_a_second_run_derives_nothing_and_gives_the_same(
    ran: dict[str, Any], modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    refuse_to_derive(monkeypatch)
    assert without_time(modelgen("simulate", EGG, "--json").json) == ran


def test_a_second_run_loads_no_library_of_symbols_and_no_reader_of_scenes(ran: dict[str, Any]) -> None:
    code = (
        "import sys\nfrom modelgen.cli import main\n"
        f"sys.argv = ['modelgen', 'simulate', {str(EGG)!r}, '--json']\n"
        "try: main()\nexcept SystemExit: pass\n"
        f"print([name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    )
    told = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert told.stderr == "[]\n"
    assert without_time(json.loads(told.stdout)) == ran


def change_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    EGG.write_text(EGG.read_text() + "\n# a word more\n")


def rename_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "EGG", EGG.rename(EGG.with_name("egg.toml")))


def change_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    other = Path("package")
    other.mkdir()
    (other / "one.py").touch()
    monkeypatch.setattr(built_library_lookup, "PACKAGE", other)


def change_the_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", f"{shutil.which('cc') or 'cc'} -fno-tree-vectorize")


def change_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(built_library_lookup, "cpu_target", lambda: "another")


def change_the_instance(monkeypatch: pytest.MonkeyPatch) -> None:
    path = FOLDER / "instance.json"
    path.write_text(path.read_text().replace("9.81", "1.62"))


def remove_the_record(monkeypatch: pytest.MonkeyPatch) -> None:
    (FOLDER / "library.json").unlink()


def remove_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    next(FOLDER.glob("*.so")).unlink()


def spoil_what_is_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    (FOLDER / NAME).write_text("[1, 2")


CHANGES = (
    change_the_scene,
    rename_the_scene,
    change_the_package,
    change_the_compiler,
    change_the_processor,
    change_the_instance,
    remove_the_record,
    remove_the_library,
    spoil_what_is_remembered,
)


@pytest.mark.parametrize("change", CHANGES)
def test_after_a_change_the_scene_is_derived_again(
    change: Callable[[pytest.MonkeyPatch], None], ran: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert recall(FOLDER, key()) is not None
    change(monkeypatch)
    assert recall(FOLDER, key()) is None


@pytest.mark.parametrize("change", [change_the_instance, remove_the_library, spoil_what_is_remembered])
def test_files_that_were_changed_are_made_anew(
    change: Callable[[pytest.MonkeyPatch], None],
    ran: dict[str, Any],
    modelgen: Modelgen,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    change(monkeypatch)
    assert without_time(modelgen("simulate", EGG, "--json").json) == ran
    assert recall(FOLDER, key()) is not None


def test_a_forced_form_is_remembered_by_itself(ran: dict[str, Any], modelgen: Modelgen) -> None:
    modelgen("simulate", EGG, "--form", "implicit", "--json")
    assert recall(FOLDER, key()) is not None
    assert recall(FOLDER.with_name("ellipsoid_on_plane.implicit"), key()) is None
