"""How a command ends when the machine or the shell gives it less than it wants."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from subprocess import PIPE
from typing import Any

import pytest

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
    ],
)
def test_what_is_missing_is_told_in_one_short_message(text: str, message: str, tmp_path: Path) -> None:
    told = shell(text, tmp_path)
    assert told.returncode == 2
    assert message in told.stderr
    assert len(told.stderr) < 400
    assert told.stderr.count("\n") == 1


@pytest.mark.parametrize("closed", ["2>&-", "<&-", "2> /dev/full"])
def test_other_streams_are_not_needed(closed: str, tmp_path: Path) -> None:
    """A file that is opened does not become standard error, and a command goes on without it."""
    told = shell(f"{MODELGEN} new top {closed}", tmp_path)
    assert told.returncode == 0, told.stderr
    assert "written: top.toml" in told.stdout
    assert (tmp_path / "top.toml").read_text().startswith("#")


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
