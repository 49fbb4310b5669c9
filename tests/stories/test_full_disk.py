"""A file that cannot be written to its end: the older one stays, the message names it, nothing is left."""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from modelgen.file_writing import SCRATCH, replaced, write_file, write_files
from tests.stories.conftest import PENDULUM
from tests.stories.failing_operations import (
    FILES,
    KILLED,
    OVERCOME,
    REFUSED,
    UNTOUCHED,
    WRITERS,
    texts,
    written_by,
)

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


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=pytest.mark.slow) if each == "run.png" else each for each in COMMANDS]
)
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
        if "the compiler ended with" not in told.err:  # a library of Zig is larger than what is exported
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


def test_text_that_is_none_is_written_in_escapes(tmp_path: Path) -> None:
    """As the name of a file in another encoding, on a page about it."""
    write_file(tmp_path / "page", "of s\udcff.toml, µ")
    assert (tmp_path / "page").read_text(encoding="utf-8") == "of s\\udcff.toml, µ"


@pytest.mark.parametrize("name", ["a" * 255, "a" * 251 + ".npz", "a." + "b" * 253])
def test_the_longest_names_are_written(name: str, tmp_path: Path) -> None:
    write_file(tmp_path / name, "new")
    assert contents(tmp_path) == {name: b"new"}


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


def told(mode: str, folder: Path, given: Any) -> Any:
    command = [sys.executable, "-m", "tests.stories.failing_operations", mode, folder, json.dumps(given)]
    return json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)


def test_processes_that_write_at_once_leave_whole_files_and_nothing_else(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    for failed, left in told("races", folder, 20):
        assert failed == 0
        assert left.keys() == {f"{folder.name}/{name}" for name in FILES}
        for name in FILES:
            assert left[f"{folder.name}/{name}"] in [written_by(k, name) for k in range(WRITERS)]


def attempts(mode: str, folder: Path, before: dict[str, str]) -> list[tuple[int, dict[str, str]]]:
    """How writing FILES ended and what it left, for each operation that fails, or is not reached alive."""
    *found, last = told(mode, folder, before)
    assert last == [UNTOUCHED, before | FILES]
    assert len(found) > 3 * len(FILES)
    assert set(texts(folder.parent)) == {f"{folder.name}/{name}" for name in before | FILES}
    return [(code, left) for code, left in found]


def test_files_of_a_new_folder_appear_at_once(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    for code, left in attempts("fails", folder, {}):
        assert (code, left) in ((REFUSED, {}), (OVERCOME, FILES))
    for code, left in attempts("killed", folder, {}):
        assert code == KILLED
        assert left in ({}, FILES)


def test_files_in_a_folder_that_is_there_are_all_new_or_all_old(tmp_path: Path) -> None:
    """Unless the process is killed between two of the moves: then some are new and some old, each whole."""
    folder, before = tmp_path / "set", {"a.c": "old", "b.h": "old", "notes": "own"}
    for code, left in attempts("fails", folder, before):
        assert (code, left) in ((REFUSED, before), (OVERCOME, before | FILES))
    mixed = 0
    for code, left in attempts("killed", folder, before):
        assert code == KILLED
        named = {name: text for name, text in left.items() if not Path(name).name.startswith(SCRATCH)}
        assert all(text in (before.get(name), FILES.get(name)) for name, text in named.items())
        assert before.keys() <= named.keys()
        mixed += named not in (before, before | FILES)
    assert mixed < len(FILES)
    write_files({folder / name: text for name, text in FILES.items()})
    assert texts(folder) == before | FILES
