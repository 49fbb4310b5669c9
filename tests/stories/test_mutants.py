"""Damaged files and texts end in one short message, and none is read as another: a few of each kind."""

from __future__ import annotations

import pytest

from tests.benchmarks.mutants import study

COUNTS = {"checkpoints": 40, "runs": 30, "imports": 72, "scenes": 60}


@pytest.mark.parametrize("kind", COUNTS)
def test_no_damaged_file_is_trusted_and_none_ends_in_a_traceback(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(".")  # back to where it was
    assert study(kind, range(COUNTS[kind])) == []
