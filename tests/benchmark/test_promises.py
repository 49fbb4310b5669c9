"""`tune` keeps what it promises, and promises what the registry lists as reachable."""

from __future__ import annotations

import pytest

from tests.benchmark.promises import DECADES, promises
from tests.registry import REGISTRY
from tests.running import folder

pytestmark = pytest.mark.usefixtures("hasty")


def test_a_drop_and_its_rest_are_tuned_to_what_can_be_reached() -> None:
    found = promises("bouncing_ball", folder(), until=0.5, decades=(3, 10), budgets=())
    assert not found.broken
    assert set(found.kept) == {3, 10}
    refused = promises("bouncing_ball", folder(), until=0.5, decades=(18,), budgets=())
    assert "the reachable error is" in refused.refused[18]


@pytest.mark.slow
@pytest.mark.parametrize("name", REGISTRY)
def test_every_decade_that_is_listed_is_met_and_others_are_refused(name: str) -> None:
    found = promises(name, folder())
    listed = set(DECADES) & set(range(REGISTRY[name].reachable + 1))
    assert not found.broken
    assert listed <= set(found.kept)
    assert set(found.kept) | set(found.refused) == set(DECADES)
