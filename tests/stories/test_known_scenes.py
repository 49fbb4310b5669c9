"""A scene that was run before is run again without being derived, unless anything has changed since."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from modelgen.cli import built_library_lookup
from modelgen.cli.built_library_lookup import NAME, recall, scene_key
from modelgen.cli.command_group import MODULES, app
from modelgen.codegen.built_files import seal
from tests.c_compiler import CC

Modelgen = Callable[..., Any]
ROOT = Path(__file__).parents[2]
EGG = Path("scenes/ellipsoid_on_plane.toml")
FOLDER = Path("generated/ellipsoid_on_plane")
PACKAGES = {
    "modelgen",
    "numpy",
    "click",
}  # that a run needs; each other one takes 10 ms to 200 ms at every start
SCENE_ROOM = {"modelgen.scene", "modelgen.scene.run_choices", "modelgen.scene.scene_name"}  # names, no reader
MODULES_AT_MOST = (
    68  # of modelgen, some 2 ms each, most of them for their dataclasses: 60 when this was written
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


@pytest.mark.parametrize("more", [["--json"], [], ["--until", "0.5", "--accuracy", "fast"]])
def test_a_second_run_loads_what_it_needs_and_no_more(ran: dict[str, Any], more: list[str]) -> None:
    """The time of the start is that of imports: those of a run, none of the scene format, none of symbols."""
    code = (
        "import sys\nbefore = set(sys.modules)\nfrom modelgen.cli import main\n"
        f"sys.argv = {['modelgen', 'simulate', str(EGG), *more]!r}\n"
        "try: main()\nexcept SystemExit: pass\n"
        "print(*sorted(set(sys.modules) - before), file=sys.stderr)"
    )
    told = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    loaded = set(told.stderr.split())
    own = {name for name in loaded if name.split(".")[0] == "modelgen"}
    assert {name.split(".")[0] for name in loaded} - sys.stdlib_module_names <= PACKAGES
    assert own & {f"modelgen.cli.{module}" for module in MODULES.values()} == {"modelgen.cli.simulate"}
    if "--until" not in more:
        assert {name for name in own if name.startswith("modelgen.scene")} <= SCENE_ROOM
        assert len(own) <= MODULES_AT_MOST
    if "--json" in more:
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
    monkeypatch.setenv("CC", f"{shlex.join(CC)} -fno-tree-vectorize")


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
    (FOLDER / NAME).write_bytes(b"0" * 64)


def damage_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    path = next(FOLDER.glob("*.so"))
    path.write_bytes(path.read_bytes()[:4096])


CHANGES = (
    change_the_scene,
    rename_the_scene,
    change_the_package,
    change_the_compiler,
    change_the_processor,
    change_the_instance,
    remove_the_record,
    remove_the_library,
    damage_the_library,
    spoil_what_is_remembered,
)


@pytest.mark.parametrize("change", CHANGES)
def test_after_a_change_the_scene_is_derived_again(
    change: Callable[[pytest.MonkeyPatch], None], ran: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert recall(FOLDER, key()) is not None
    change(monkeypatch)
    assert recall(FOLDER, key()) is None


@pytest.mark.parametrize(
    "change", [change_the_instance, remove_the_library, damage_the_library, spoil_what_is_remembered]
)
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


def test_a_library_beside_the_scene_of_another_user_is_not_loaded(
    ran: dict[str, Any], modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has the right name and hash, and the seal of the user who planted it; its constructor would leave a
    file."""
    path, mark = next(FOLDER.glob("*.so")).resolve(), tmp_path / "mark"
    source = tmp_path / "planted.c"
    source.write_text(
        "#include <stdio.h>\n__attribute__((constructor)) static void run(void)"
        f'{{ FILE *f = fopen("{mark}", "w"); if (f) fclose(f); }}\n'
    )
    subprocess.run([*CC, "-shared", "-fPIC", "-o", path, source], check=True)
    with monkeypatch.context() as other:
        other.setenv("MODELGEN_CACHE", str(tmp_path / "other user"))
        seal(path)
        (FOLDER / NAME).write_bytes(built_library_lookup._signature(FOLDER, "double", key()))
    assert without_time(modelgen("simulate", EGG, "--json").json) == ran
    assert not mark.exists()
