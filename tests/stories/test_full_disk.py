"""A file that cannot be written to its end: the older one stays, the message names it, nothing is left."""

from __future__ import annotations

import resource
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from modelgen.file_writing import replaced, write_file, write_files

Modelgen = Callable[..., Any]
ROOT = Path(__file__).parents[2]
BALL = ("scenes/bouncing_ball.toml", "--until", "0.2")
COMMANDS = {
    "run.npz": ("simulate", *BALL, "--out"),
    "run.csv": ("simulate", *BALL, "--out"),
    "run.png": ("simulate", *BALL, "--plot"),
    "run.svg": ("simulate", *BALL, "--plot"),
    "page.html": ("view", *BALL, "--out"),
    "inspection.html": ("inspect", "sphere-plane", "--format", "html", "--out"),
    "scene.toml": ("import", "pendulum.xml", "--out"),
    "c/model.c": ("export", "scenes/bouncing_ball.toml", "--to", "c", "--no-figures", "--out"),
}
PENDULUM = """<mujoco><worldbody><body><joint type="hinge" axis="0 1 0"/>
<geom type="sphere" size="0.1" pos="0 0 -1"/></body></worldbody></mujoco>"""


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """No file grows beyond a size, B: writing more fails, as on a disk that is full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_that_cannot_write_its_file_leaves_the_older_one(
    name: str, modelgen: Modelgen, tmp_path: Path
) -> None:
    Path("pendulum.xml").write_text(PENDULUM)
    named = tmp_path / (name if "/" not in name else Path(name).parent)
    command = (*COMMANDS[name], named)
    assert modelgen(*command).code == 0
    whole = contents(tmp_path)
    size = max(map(len, whole.values()))
    assert size > 100
    for part in (0.9, 0.99) if "/" in name else (0.0, 0.1, 0.5, 0.99):  # less is too little to build
        with files_of_at_most(int(part * size)):
            told = modelgen(*command)
        assert told.code == 2, told.err
        assert f"{named}" in told.err
        assert told.err.splitlines()[-1].endswith("cannot be written: File too large; name another file")
        assert contents(tmp_path) == whole
    shutil.rmtree(tmp_path)
    tmp_path.mkdir()
    with files_of_at_most(int(0.9 * size)):
        assert modelgen(*command).code == 2
    assert not contents(tmp_path)


def test_a_link_stays_and_rights_are_kept(tmp_path: Path) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    write_file(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"
    assert real.stat().st_mode & 0o777 == 0o640


def write_half(path: Path, cause: type[BaseException]) -> None:
    with replaced(path) as scratch:
        scratch.write_text("new")
        raise cause


def test_a_block_that_fails_or_is_interrupted_leaves_the_older_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    for cause in (ValueError, KeyboardInterrupt, SystemExit):
        with pytest.raises(cause):
            write_half(path, cause)
    assert contents(tmp_path) == {"file": b"old"}


def test_of_several_files_all_are_written_or_none(tmp_path: Path) -> None:
    files: dict[Path, str | bytes] = {tmp_path / "a" / str(k): str(k) * 100 * k for k in range(5)}
    with files_of_at_most(350), pytest.raises(Exception, match="4: cannot be written"):
        write_files(files)
    assert not contents(tmp_path)
    write_files(files)
    assert len(contents(tmp_path)) == 5
