"""The debug core: assertions that name file, line and condition; runs that need nothing of scratch memory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from modelgen import read
from modelgen.codegen.compiler import DEBUG, FILLS
from modelgen.errors import LibraryError
from tests.running import FILES, folder, library_of
from tests.sensitivity.families import FAMILIES, member

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
FOUND = tuple(sorted((HERE / "scenes").glob("*.toml")))
QUICK = ("lim3", "limit_oob", "light_rim", "stool_on_floor", "hinge_pi", "end_of_line", "stepping")

WRONG_TABLE = """
from pathlib import Path
import sys
import numpy as np
from modelgen import build, derive, emit, read, require
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
library = build(emit(derive(require(read(Path(sys.argv[1]))))), folder=Path(sys.argv[2]), level="O1")
session = Session(library, Accuracy.balanced())
wrong = np.array([99] * 8, dtype=np.intc)
session.system.contact_pair = wrong.ctypes.data
session.begin()
"""


def process(fill: str, *words: str) -> subprocess.CompletedProcess[str]:
    """A Python process with the debug core of a pattern, or the release core."""
    environment = {name: value for name, value in os.environ.items() if name != DEBUG}
    if fill:
        environment[DEBUG] = fill
    return subprocess.run(
        [sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


def digests(fill: str, scenes: tuple[Path, ...], seconds: float, *words: str) -> list[str]:
    """The lines of `tests.memory.digests`, of a process of its own."""
    place = str(folder() / f"digests{''.join(words)}{fill}")
    done = process(fill, "-m", "tests.memory.digests", *words, place, str(seconds), *map(str, scenes))
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.splitlines()


def test_runs_keep_their_preconditions_and_are_those_of_the_release_core() -> None:
    scenes = tuple(HERE / "scenes" / f"{name}.toml" for name in QUICK)
    asserted = digests("1", scenes, 0.3)
    assert len(asserted) == len(QUICK)
    assert asserted == digests("", scenes, 0.3)


@pytest.mark.cases(1)
@pytest.mark.parametrize("family", FAMILIES)
def test_derivatives_keep_their_preconditions_too(family: str, tmp_path: Path) -> None:
    """Forward and backward, with rows that stick, slip, begin to slip, or are let bear on a kink."""
    scenes = tuple(tmp_path / f"{family}{seed}.toml" for seed in range(3))
    for seed, scene in enumerate(scenes):
        scene.write_text(member(family, seed).text, encoding="utf-8")
    asserted = digests("1", scenes, 0.3, "--derivatives")
    assert not any("refused" in line for line in asserted)
    assert asserted == digests("", scenes, 0.3, "--derivatives")


def test_an_assertion_names_file_line_and_condition(tmp_path: Path) -> None:
    done = process("1", "-c", WRONG_TABLE, str(HERE / "scenes" / "lim3.toml"), str(tmp_path))
    assert done.returncode < 0
    assert "model/preconditions.c:" in done.stderr
    assert "first <= entries[i] && entries[i] < end" in done.stderr


def test_an_unknown_pattern_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(DEBUG, "9")
    with pytest.raises(LibraryError, match="allowed: 1, 2, 3, 4, 5"):
        library_of(read(HERE / "scenes" / "lim1.toml"))


@pytest.mark.slow
@pytest.mark.parametrize("fill", FILLS)
def test_all_runs_do_so_under_every_pattern(fill: str) -> None:
    scenes = FILES + FOUND
    assert digests(fill, scenes, 1.0) == digests("", scenes, 1.0)
