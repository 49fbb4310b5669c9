"""Where standard error is no terminal, long work prints lines, and short work none."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from modelgen.cli import progress

Modelgen = Callable[..., Any]
EGG = "scenes/ellipsoid_on_plane.toml"


def test_a_run_prints_its_share_from_time_to_time(
    modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    answer = modelgen("simulate", EGG, "--until", 5, "--tolerance", 1e-14, "--json")
    shares = [int(share) for share in re.findall(r"^simulating: (\d+) %$", answer.err, re.MULTILINE)]
    assert shares
    assert shares == sorted(shares)
    assert 0 <= shares[0] <= shares[-1] <= 100
    assert answer.json["outcome"] == "done"


@pytest.mark.usefixtures("hasty")
def test_a_measurement_prints_what_it_does(modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "INTERVAL", 0.0)
    answer = modelgen("measure", EGG, "--knobs", "tolerance", "--until", 0.05, "--limit", 1)
    assert answer.code == 0
    assert len(answer.err.splitlines()) > 1


def test_short_work_prints_nothing(modelgen: Modelgen) -> None:
    assert "simulating" not in modelgen("simulate", EGG, "--until", 0.1).err
