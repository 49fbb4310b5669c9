"""Files that a command is to write where it cannot, or must not."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.stories.conftest import PENDULUM

Modelgen = Callable[..., Any]


@pytest.mark.parametrize(
    "words",
    [
        ("inspect", "{0}/scene.toml", "--out", "{0}/scene.toml"),
        ("inspect", "{0}/scene.toml", "--out", "{0}/link.toml"),
        ("import", "{0}/model.xml", "--out", "{0}/../{1}/model.xml"),
        ("tune", "{0}/link.toml", "--error", "1e-3", "--out", "{0}/scene.toml"),
        ("check", "{0}/scene.toml"),
    ],
)
def test_no_command_writes_over_what_it_reads(
    words: tuple[str, ...], modelgen: Modelgen, tmp_path: Path
) -> None:
    scene, model = tmp_path / "scene.toml", tmp_path / "model.xml"
    shutil.copy("scenes/bouncing_ball.toml", scene)
    model.write_text(PENDULUM)
    (tmp_path / "link.toml").symlink_to(scene)
    before = scene.read_bytes()
    told = modelgen(*(word.format(tmp_path, tmp_path.name) for word in words))
    assert told.code == (2 if "--out" in words else 0)
    assert "--out" not in words or ("itself; another file" in told.err and told.err.count("\n") == 1)
    assert scene.read_bytes() == before
    assert model.read_text() == PENDULUM


@pytest.mark.parametrize(
    "words",
    [
        ("simulate", "scenes/bouncing_ball.toml", "--out", "{}.npz"),
        ("simulate", "scenes/bouncing_ball.toml", "--plot", "{}.svg"),
        ("inspect", "sphere-plane", "--out", "{}.txt"),
        ("export", "scenes/bouncing_ball.toml", "--to", "mjcf", "--out", "{}"),
        ("build", "scenes/bouncing_ball.toml", "--out", "{}"),
        ("new", "top", "--out", "{}.toml"),
        ("new", "--scenes", "--out", "{}"),
    ],
)
def test_names_under_which_nothing_can_be_written(
    words: tuple[str, ...], modelgen: Modelgen, tmp_path: Path
) -> None:
    """A file where a folder should be, names and paths that are too long; nothing is computed before."""
    (tmp_path / "file").touch()
    for name in ("file/x", "a" * 300, "/".join(["a" * 200] * 30)):
        told = modelgen(*(word.format(tmp_path / name) for word in words))
        assert told.code == 2
        assert told.err.count("\n") == 1
        assert told.err.count(";") > 0, told.err
        assert len(told.err) < 700
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
