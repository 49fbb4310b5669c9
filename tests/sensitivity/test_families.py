"""No derivative that is called differentiable is wrong over random scenes, nor one that is said to hold for
one side on that side."""

from __future__ import annotations

import pytest

from tests.benchmarks.derivative_families import pairs_of
from tests.sensitivity.families import FAMILIES
from tests.sensitivity.judge import Judged
from tests.sensitivity.scenes_on_kinks import ON_KINKS


def _wrong(found: list[Judged]) -> list[Judged]:
    return [pair for pair in found if pair.outcome == "wrong"]


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("family", FAMILIES)
def test_no_derivative_of_a_family_is_wrong(family: str, seed: int) -> None:
    found = pairs_of(family, seed)
    assert len(found) >= 10
    assert not _wrong(found)


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("family", ON_KINKS)
def test_derivatives_on_kinks_say_their_side(family: str, seed: int) -> None:
    """What the kink does not concern stays differentiable."""
    found = pairs_of(family, seed)
    assert not _wrong(found)
    assert any(pair.side in ("larger", "smaller") for pair in found)
    assert all(pair.verdict for pair in found if pair.by == "apart")
