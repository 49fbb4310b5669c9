"""A command whose output nobody reads any more ends quietly, whatever prints it."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from subprocess import PIPE, Popen

import pytest

SCENE = Path(__file__).parents[2] / "scenes" / "bouncing_ball.toml"


@pytest.mark.parametrize(
    ("words", "closed"),
    [(("manual",), "stdout"), (("check", str(SCENE)), "both"), (("new", "--help"), "stdout")],
)
def test_a_closed_pipe_ends_the_command_without_a_message(words: tuple[str, ...], closed: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "modelgen", *words]
    with Popen(command, stdout=writing, stderr=writing if closed == "both" else PIPE) as run:
        os.close(writing)
        told = run.stderr.read() if run.stderr else b""
    assert (run.returncode, told) == (141, b"")
