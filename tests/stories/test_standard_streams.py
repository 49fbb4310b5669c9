"""Standard streams that are closed, full or read by nobody: each command ends with its exit code, at most one
line, and every file that it writes is whole."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from modelgen.cli.command_group import MODULES
from modelgen.file_writing import SCRATCH

ROOT = Path(__file__).parents[2]
BALL, WHEEL, RINGS = (
    str(ROOT / "scenes" / f"{name}.toml") for name in ("bouncing_ball", "balancing_wheel", "linked_rings")
)
SHORT = ("--until", "0.1")
KNOBS = ("--knobs", "tolerance", *SHORT)
TUNE = ("tune", BALL, "--error", "1e-4", *KNOBS, "--out", "tuned.toml")
BEFORE = (  # what others read
    ("simulate", BALL, *SHORT, "--out", "run.npz"),
    ("simulate", WHEEL, "--input", "torque=1.5", *SHORT, "--samples", "10", "--out", "wheel.csv"),
    ("export", BALL, "--to", "mjcf", "--out", "mjcf"),
)
COMPILED = (TUNE, ("build", WHEEL, "--derivatives"))  # which may say that they compile the core
QUICK = (
    ("--help",),
    ("--version",),
    ("--show-completion",),
    ("new",),
    ("check", BALL, "--brief"),
    ("build", BALL),
    ("simulate", BALL, *SHORT, "--out", "run.npz"),
    ("simulate", BALL, *SHORT, "--json"),
    ("manual", "c"),
    ("view", "run.npz", "--out", "run.html"),
    ("export", BALL, "--to", "mjcf", "--out", "mjcf"),
    ("import", "mjcf/bouncing_ball.xml", "--out", "imported.toml"),
    ("import", "mjcf/bouncing_ball.xml"),
    ("inspect", "sphere-plane"),
    ("schema",),
)
LONG = (
    ("sweep", WHEEL, "--vary", "torque=0:1:2", *SHORT, "--threads", "1", "--out", "swept"),
    TUNE,
    ("linearise", RINGS),
    ("fit", WHEEL, "wheel.csv", "--of", "axle,lean", "--by", "torque", "--plot", "left.svg"),
    ("measure", BALL, *KNOBS, "--plot", "front.svg"),
    ("sensitivity", WHEEL, "--by", "torque", "--at", "0.1"),
    ("report", "run.npz", "--out", "report.html"),
    ("plot", "run.npz", "--out", "run.svg"),
)
STREAMS = (  # output, error
    *(("full", "file"), ("closed", "file"), ("unread", "file"), ("file", "closed"), ("file", "full")),
    *(("closed", "closed"), ("full", "full"), ("unread", "unread")),
)
CODES = {"file": 0, "full": 2, "closed": 2, "unread": 141}
MESSAGES = {
    "full": "standard output: No space left on device; write it to another place\n",
    "closed": "standard output: Bad file descriptor; write it to another place\n",
}


def test_every_command_is_listed() -> None:
    assert set(MODULES) <= {words[0] for words in (*QUICK, *LONG)}


def answers(cases: list[tuple[tuple[str, ...], str, str]], folder: Path) -> list[tuple[int, str, str]]:
    """Exit code, output and error of each command of `forked_commands`."""
    told = subprocess.run(
        [sys.executable, "-m", "tests.stories.forked_commands", json.dumps(cases)],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "SHELL": "/bin/bash"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 0, told.stderr
    found: list[tuple[int, str, str]] = json.loads(told.stdout)
    return found


def check(cases: list[tuple[tuple[str, ...], str, str]], folder: Path, *before: tuple[str, ...]) -> None:
    """Run commands; beside those whose output is a file the same with both streams."""
    usual = [*before, *(words for words, out, _ in cases if out == "file")]
    found = answers([*((words, "file", "file") for words in usual), *cases], folder)
    shown_usually = {words: shown for words, (_, shown, _) in zip(usual, found, strict=False)}
    ends = found[len(usual) :]
    for (words, out, err), (code, shown, message) in zip(cases, ends, strict=True):
        case = (words, out, err, code, message)
        assert code == CODES[out], case
        assert out != "file" or len(shown) > 0.9 * len(shown_usually[words]) > 0, case
        assert err != "file" or message == MESSAGES.get(out, ""), case
    written = [path for path in folder.rglob("*") if path.is_file() and not path.name.startswith("standard_")]
    assert all(path.stat().st_size for path in written)
    assert not [path for path in written if path.name.startswith(SCRATCH)]


def test_commands_without_a_stream_end_in_one_line(tmp_path: Path) -> None:
    """Each quick command, with one of the kinds of streams."""
    check([(words, *STREAMS[k % len(STREAMS)]) for k, words in enumerate(QUICK)], tmp_path, *BEFORE)


@pytest.mark.slow
@pytest.mark.parametrize(("out", "err"), STREAMS)
def test_all_commands_without_a_stream_end_in_one_line(out: str, err: str, tmp_path: Path) -> None:
    check([(words, out, err) for words in (*QUICK, *LONG)], tmp_path, *BEFORE, *COMPILED)
