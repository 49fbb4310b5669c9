"""How a command ends when the machine or the shell gives it less than it wants."""

from __future__ import annotations

import fcntl
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from subprocess import PIPE
from typing import Any

import pytest

from modelgen import file_writing
from modelgen.codegen.compiler import run_program
from modelgen.file_writing import FOLDER, SCRATCH, scratch_folder, write_file

ROOT = Path(__file__).parents[2]
MODELGEN = f"{shlex.quote(sys.executable)} -m modelgen"
BALL = ROOT / "scenes" / "bouncing_ball.toml"
LONG = "a" * 10_000
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


def shell(text: str, folder: Path, **more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["sh", "-c", text],
        cwd=folder,
        env=ENVIRONMENT | more,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{MODELGEN} manual > /dev/full", "standard output: No space left on device; write it to another"),
        (f"{MODELGEN} manual >&-", "standard output: Bad file descriptor; write it to another place"),
        (f"mkdir gone; cd gone; rmdir ../gone; {MODELGEN} check {BALL}", "the current folder: No such file"),
        (f"{MODELGEN} new top --out {LONG}.toml", "File name too long"),
        (f"{MODELGEN} check {LONG}.toml", "File name too long"),
        (
            f"ulimit -s 128; {MODELGEN} --version",
            "stack: its limit is 128 KiB; at least 256 KiB are needed; run",
        ),
    ],
)
def test_what_is_missing_is_told_in_one_short_message(text: str, message: str, tmp_path: Path) -> None:
    told = shell(text, tmp_path)
    assert told.returncode == 2
    assert message in told.stderr
    assert len(told.stderr) < 400
    assert told.stderr.count("\n") == 1


@pytest.mark.parametrize("called", [LONG, f"--{LONG}", f"check --{LONG}"])
def test_long_names_of_what_there_is_not_are_told_in_part(called: str, tmp_path: Path) -> None:
    told = shell(f"{MODELGEN} {called}", tmp_path)
    assert told.returncode == 2
    assert "No such" in told.stderr
    assert len(told.stderr) < 400


@pytest.mark.parametrize("closed", ["2>&-", "<&-", "2> /dev/full"])
def test_other_streams_are_not_needed(closed: str, tmp_path: Path) -> None:
    """A file that is opened does not become standard error, and a command goes on without it."""
    told = shell(f"{MODELGEN} new top {closed}", tmp_path)
    assert told.returncode == 0, told.stderr
    assert "written: top.toml" in told.stdout
    assert (tmp_path / "top.toml").read_text().startswith("#")


def test_names_that_are_no_utf_8_are_told_as_they_are(tmp_path: Path) -> None:
    named = "$(printf 's\\377').toml"
    told = subprocess.run(
        [
            "sh",
            "-c",
            f"{MODELGEN} new bouncing_ball --out {named} && {MODELGEN} check {named} --brief",
        ],
        cwd=tmp_path,
        env=ENVIRONMENT | {"PYTHONUTF8": "0", "LC_ALL": "C.UTF-8"},
        capture_output=True,
        check=False,
    )
    assert told.returncode == 0, told.stderr
    assert told.stdout.startswith(b"written: s\xff.toml\n")
    assert b"Traceback" not in told.stderr


def test_a_small_stack_is_enough(tmp_path: Path) -> None:
    told = shell(f"ulimit -s 256; {MODELGEN} simulate {BALL} --until 0.2 --json", tmp_path)
    assert told.returncode == 0, told.stderr
    assert json.loads(told.stdout)["trusted"]


@pytest.mark.parametrize(
    ("named", "message"),
    [
        (
            "'",
            'CC: "\'" is no command: No closing quotation; correct CC, or unset it to use cc, gcc or clang',
        ),
        ("/bin/true", "CC names no C compiler: correct or unset it; its output is in {cache}/runtime-"),
        (f"/bin/{'x' * 10_000}", "; correct CC, or unset it to use cc, gcc or clang"),
    ],
)
def test_what_is_no_compiler_is_told_with_a_remedy(
    named: str, message: str, modelgen: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", named)
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path))
    told = modelgen("build", BALL, "--out", tmp_path / "built")
    assert told.code == 2
    assert message.format(cache=tmp_path) in told.err.splitlines()[-1]
    assert len(told.err) < 1000


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_keeps_what_was_computed(number: signal.Signals, tmp_path: Path) -> None:
    """SIGTERM as Ctrl-C: the run that was computed so far is written."""
    scene = ROOT / "scenes" / "ellipsoid_on_plane.toml"
    command = [sys.executable, "-m", "modelgen", "simulate", str(scene), "--out", "run.npz", "--until"]
    place: dict[str, Any] = {"cwd": tmp_path, "env": ENVIRONMENT}
    subprocess.run([*command, "0.01"], check=True, capture_output=True, **place)
    with subprocess.Popen([*command, "1e5"], stdout=PIPE, stderr=PIPE, **place) as run:
        time.sleep(4)
        run.send_signal(number)
        _, told = run.communicate(timeout=60)
    assert run.returncode == 130, told
    assert b"Traceback" not in told
    assert (tmp_path / "run.npz").stat().st_size > 0
    assert not list(tmp_path.glob(".modelgen-*"))


INTERRUPTED_AT_IMPORT = """
import os, signal, sys, time
from modelgen.cli import command_group, main
class Collected:
    def __del__(self):
        press()
def press():
    os.kill(os.getpid(), signal.{number})
command_group.import_module = lambda name: {act}
sys.argv = ["modelgen", "build", "scene.toml"]
main()
"""


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize(
    "act",
    [
        "press()",
        "exec('press()', globals())",
        "swallowed()",
        "swallowed() + 1",
        "Collected() and time.sleep(9)",
    ],
)
def test_a_signal_in_an_import_ends_with_its_code(number: str, act: str) -> None:
    """In text that Python executes, after which it would end as killed; where a module catches everything;
    where Python ignores what is raised."""
    swallowed = "\ndef swallowed():\n    try:\n        press()\n    except:\n        pass\n"
    code = swallowed + INTERRUPTED_AT_IMPORT.format(number=number, act=act)
    told = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=ENVIRONMENT
    )
    assert (told.returncode, told.stdout, told.stderr) == (130, "", "interrupted\n")


def test_no_program_that_a_compiler_started_survives_an_interruption(tmp_path: Path) -> None:
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    script = "sleep 60 & echo $! > child; mktemp; wait"
    with pytest.raises(KeyboardInterrupt):
        run_program(["sh", "-c", script], tmp_path)
    child = Path("/proc", (tmp_path / "child").read_text().strip(), "stat")
    for _ in range(50):
        if not child.exists() or child.read_text().rpartition(")")[2].split()[0] == "Z":
            break
        time.sleep(0.02)
    else:
        pytest.fail("it survives")


def test_the_next_write_removes_what_dead_processes_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(file_writing, "_cleared", set())
    left = [tmp_path / f"{SCRATCH}{name}" for name in ("0123456789abcdef.npz", "17-3.csv", "17-3")]
    held, foreign = tmp_path / f"{SCRATCH}fedcba9876543210.npz", tmp_path / f"{SCRATCH}notes"
    for path in (*left, held, foreign):
        path.write_text("half")
    with held.open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        write_file(tmp_path / "new", "whole")
    assert {path.name for path in tmp_path.iterdir()} == {"new", held.name, foreign.name}


def test_the_next_temporary_folder_takes_the_place_of_those_of_dead_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / f"{FOLDER}dead").mkdir()
    (tmp_path / f"{FOLDER}dead" / "model.c").touch()
    with scratch_folder() as first, scratch_folder() as second:
        assert {path.name for path in tmp_path.iterdir()} == {first.name, second.name}
    assert not list(tmp_path.iterdir())


PARSED_AND_INTERRUPTED = """
import os, signal, sys
from modelgen import cli
from modelgen.cli import command_group
from modelgen.cli.command_group import Commands
def interrupted(*args, **keys):
    os.kill(os.getpid(), signal.{signal})
    return found(*args, **keys)
found = getattr({owner}, "{name}")
setattr({owner}, "{name}", interrupted)
sys.argv = ["modelgen", "schema"]
cli.main()
"""


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize(
    "place", ["Commands.parse_args", "Commands.resolve_command", "command_group.command_of"]
)
def test_a_signal_while_words_are_parsed_ends_the_command(place: str, number: str) -> None:
    owner, name = place.split(".")
    code = PARSED_AND_INTERRUPTED.format(signal=number, owner=owner, name=name)
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "interrupted\n")
