"""What a fresh clone of the repository does: builds leave it clean, and a missing compiler is named."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.running import FILES

Modelgen = Callable[..., Any]
ROOT = Path(__file__).parents[2]
EGG = "scenes/ellipsoid_on_plane.toml"


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The tracked parts of the tree that a build could touch, in a repository of their own."""
    shutil.copy(ROOT / ".gitignore", tmp_path)
    (tmp_path / "scenes").mkdir()
    for scene in FILES:
        shutil.copy(scene, tmp_path / "scenes")
        (tmp_path / "generated" / scene.stem).mkdir(parents=True)
        shutil.copy(ROOT / "generated" / scene.stem / "manifest.json", tmp_path / "generated" / scene.stem)
    monkeypatch.chdir(tmp_path)
    git("init", "--quiet")
    git("add", ".")
    git("add", "--force", "generated")
    return tmp_path


def git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], capture_output=True, text=True, check=True).stdout


@pytest.mark.skipif(shutil.which("git") is None, reason="needs git")
def test_builds_of_a_shipped_scene_leave_the_tree_clean(modelgen: Modelgen, clone: Path) -> None:
    assert git("ls-files").count("manifest.json") == len(FILES)
    shutil.copy(EGG, "scenes/my_egg_tuned.toml")
    for source, *more in (
        (EGG,),
        (EGG, "--real", "float"),
        (EGG, "--form", "implicit"),
        ("scenes/my_egg_tuned.toml",),
    ):
        answer = modelgen("build", source, *more, "--json")
        assert Path(answer.json["library"]).is_relative_to(clone / "generated")
    assert git("diff", "--name-only") == ""
    assert git("ls-files", "--others", "--exclude-standard") == ""


def test_without_any_compiler_one_message_brings_one(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "scenes", tmp_path / "scenes")
    code = "import sys; sys.modules['ziglang'] = None\nfrom modelgen.cli import main; main()"
    answer = subprocess.run(
        [sys.executable, "-c", code, "simulate", EGG],
        cwd=tmp_path, env={"PATH": str(tmp_path), "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert (answer.returncode, answer.stdout) == (2, "")
    assert (
        'no C compiler was found (CC, cc, gcc, clang); run: pip install "modelgen-contact[compiler]"'
        in answer.stderr
    )
    assert answer.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["scenes"]
