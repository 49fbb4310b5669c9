"""A shape dropped on another touches it when dense points of both say so, for all pairs of kinds of shapes.

`python -m tests.benchmarks.first_touches` is the same with more members of each pair, and a table.
"""

from __future__ import annotations

import pytest

from tests.benchmarks.first_touches import judge, pairs

CLOSE_CALLS = [
    (
        "capsule",
        "segment",
        2,
    ),  # closest points come in over the end of the wire just before
    ("ellipsoid", "paraboloid", 0),  # a needle, thinner than what is near the start of a way through it
    ("revolution", "disc", 4),  # a way that leaves a sheet at its rim, almost along it
    ("torus", "star", 0),
    ("frustum", "paraboloid", 1),
    ("polyhedron", "segment", 0),  # faces that a wire touches with its ends alone
    ("plate", "segment", 1),
]


@pytest.mark.cases(5)
@pytest.mark.parametrize(("first", "second"), list(pairs([])))
def test_the_first_touch_of_two_kinds_is_not_missed(first: str, second: str) -> None:
    verdict = judge(first, second, 0)
    assert not verdict.fails, str(verdict)


@pytest.mark.cases(2)
@pytest.mark.parametrize(("first", "second", "seed"), CLOSE_CALLS)
def test_touches_that_were_missed_or_refused(first: str, second: str, seed: int) -> None:
    verdict = judge(first, second, seed)
    assert verdict.outcome == "right", str(verdict)
