"""No derivative that is called differentiable is wrong, over random scenes."""

from __future__ import annotations

import pytest

from tests.benchmarks.derivative_families import pairs_of
from tests.sensitivity.families import FAMILIES


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("family", FAMILIES)
def test_no_derivative_of_a_family_is_wrong(family: str, seed: int) -> None:
    found = pairs_of(family, seed)
    assert len(found) >= 10
    assert not [pair for pair in found if pair.outcome == "wrong"]
