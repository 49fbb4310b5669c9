"""What a call of `simulate` does beside the core: the count of functions of Python that it calls."""

from __future__ import annotations

import sys
from types import FrameType

from modelgen import simulate
from modelgen.codegen.library import Library
from tests.running import scene_of

MOST = 300  # calls: 0.15 ms where a call with what it does takes 0.5 us


def calls_of(library: Library, samples: int) -> int:
    """Functions of Python that one call of `simulate` calls, without its estimate."""
    count = 0

    def counted(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(counted)
    try:
        simulate(library, until=1e-3, samples=samples, estimate=False)
    finally:
        sys.setprofile(None)
    return count


def test_a_call_of_simulate_calls_few_functions_at_any_number_of_samples() -> None:
    library = scene_of("rolling_disc")
    simulate(library, until=1e-3, samples=1, estimate=False)
    few, many = (calls_of(library, samples) for samples in (1, 50))
    assert few < MOST
    assert abs(many - few) < MOST / 10
