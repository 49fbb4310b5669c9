"""Files that came with a scene start no program, and commands keep what others wrote meanwhile."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from modelgen.benchmark.measurement_store import NAME, Store
from modelgen.cli import measure_and_tune, pipeline
from modelgen.codegen.built_files import cache_folder
from modelgen.errors import LibraryError, ModelgenError, SimulationError
from modelgen.identification.recording_files import read_recording
from tests.running import SCENES
from tests.stories.conftest import Answer

Modelgen = Callable[..., Answer]
BALL = str(SCENES / "bouncing_ball.toml")


@pytest.mark.parametrize("content", [b"animation.ffmpeg_path: ./planted\n", b"\xff\xfe"])
def test_settings_of_matplotlib_beside_a_scene_are_not_read(content: bytes, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    (tmp_path / "matplotlibrc").write_bytes(content)
    code = "from modelgen.report.run_plot import require_matplotlib as r; r(); import os, matplotlib; "
    code += "print(matplotlib.rcParams['animation.ffmpeg_path'], os.getcwd())"
    told = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert told.stdout == f"ffmpeg {tmp_path}\n"


def test_a_backend_that_there_is_not_is_told(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    code = "from modelgen.report.run_plot import require_matplotlib as r; r()"
    told = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | {"MPLBACKEND": "none of these"}, cwd=tmp_path,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "ModelgenError: plot: matplotlib does not start" in told.stderr


def test_without_a_home_the_key_is_not_sought_in_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("MODELGEN_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", "relative")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LibraryError, match=r"no home folder.*set HOME"):
        cache_folder()
    assert not list(tmp_path.iterdir())


def test_a_refused_command_leaves_what_another_wrote_meanwhile(tmp_path: Path) -> None:
    def refused(made: Path, *others: Path) -> None:
        for path in (made, *others):
            path.mkdir(parents=True)
        raise ModelgenError("a", "refused", "", "")

    for others, left in (([tmp_path / "generated" / "b"], ["b"]), ([], [])):
        folder = tmp_path / "generated" / "a"
        with pytest.raises(ModelgenError), pipeline.removed_if_refused(folder):
            refused(folder, *others)
        assert [path.name for path in tmp_path.glob("generated/*")] == left
        shutil.rmtree(tmp_path / "generated", ignore_errors=True)
    assert not list(tmp_path.iterdir())


def test_tuning_does_not_write_over_a_scene_that_was_changed_meanwhile(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = tmp_path / "ball.toml"
    scene.write_text(Path(BALL).read_text())
    resumable = measure_and_tune._resumable

    def changing() -> object:
        scene.write_text(scene.read_text().replace("0.7", "0.55"))
        return resumable()

    monkeypatch.setattr(measure_and_tune, "_resumable", changing)
    told = modelgen("tune", scene, "--error", "1e-4", "--knobs", "tolerance", "--until", "0.1", "--in-place")
    assert told.code == 2
    assert "it was changed while it was tuned" in told.err
    assert "0.55" in scene.read_text()


@pytest.mark.parametrize("forged", ['{"key": [], "value": 1}', "[" * 100_000, '{"key": "a", "value": 1e-30}'])
def test_measurements_that_came_with_a_scene_are_not_taken(forged: str, tmp_path: Path) -> None:
    Store(tmp_path).put("a", {"error": 1.0})
    path = tmp_path / NAME
    own = path.read_text()
    path.write_text(own + forged + "\n" + own.replace("1.0", "1e-30"))
    assert Store(tmp_path).known == {"a": {"error": 1.0}}
    assert json.loads(own)["value"] == {"error": 1.0}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("t,x\n0,1_0\n", "'1_0'"),
        ("t,x\n0,\u0663\n", "a number"),
        ("t,x\n0," + 200_000 * "1" + "\n", "field larger"),
        (",".join(f"c{k}" for k in range(45_000)) + ",c0\n0\n", "twice"),
    ],
)
def test_recordings_with_odd_cells_are_refused(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SimulationError, match=told):
        read_recording(path)


def test_a_recording_without_end_is_refused() -> None:
    with pytest.raises(SimulationError, match="no file"):
        read_recording(Path("/dev/zero"))


def test_a_pipe_in_place_of_a_built_file_is_not_waited_for(modelgen: Modelgen, tmp_path: Path) -> None:
    assert modelgen("simulate", BALL, "--until", "0.1", "--out", tmp_path / "run.npz").code == 0
    for name in ("scene.signature", "instance.json"):
        (found,) = Path().rglob(f"generated/bouncing_ball/{name}")
        found.unlink()
        os.mkfifo(found)
        assert modelgen("simulate", BALL, "--until", "0.1", "--out", tmp_path / "run.npz").code == 0
        assert found.is_file()
