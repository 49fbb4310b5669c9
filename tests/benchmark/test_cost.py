"""What a run costs does not depend on how fast the machine happens to be."""

from __future__ import annotations

from itertools import chain, repeat

import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.benchmark.cost import REPEATS, cost_of

RUN_S, YARD_S = 0.05, 0.02
SLOWED = st.lists(st.floats(1.0, 4.0), min_size=REPEATS, max_size=REPEATS)


def ratio(slowed: list[float], odd: dict[int, float]) -> float:
    """Cost over yardstick where the machine is slowed so in each pair, and at odd calls besides."""
    twice = chain.from_iterable(zip(slowed, slowed, strict=True))
    slowness = [each * odd.get(k, 1.0) for k, each in enumerate(twice)]
    clock = chain(slowness, repeat(1.0))
    cost = cost_of(lambda: RUN_S * next(clock), lambda: YARD_S * next(clock))
    return cost.seconds / cost.yard


@given(SLOWED)
def test_a_machine_that_is_slow_for_a_while_leaves_the_cost(slowed: list[float]) -> None:
    assert ratio(slowed, {}) == pytest.approx(RUN_S / YARD_S, rel=1e-12)


@given(SLOWED, st.integers(0, 3), st.floats(0.5, 4.0))
def test_so_does_one_call_that_is_odd(slowed: list[float], call: int, factor: float) -> None:
    assert ratio(slowed, {call: factor}) == pytest.approx(RUN_S / YARD_S, rel=1e-12)
