"""Thousands of random problems. Run with `pytest -m slow tests/core/test_friction_study.py`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen.runtime.friction import Outcome, coulomb
from tests.core.frictional import feasible, impossible, natural_map, stack

FEW, MANY, NONE = 250, 5000, 500
ENOUGH = 1e-9


def unsolved(core: Any, seeds: range) -> list[int]:
    """The seeds without a solution; none that is called solved may fail the certificate."""
    failed = []
    for seed in seeds:
        problem = feasible(seed)
        answer = coulomb(problem, core)
        if answer.outcome is not Outcome.SOLVED:
            failed.append(seed)
            assert answer.outcome is Outcome.NOT_FOUND, seed
        else:
            assert natural_map(problem, answer.z) <= ENOUGH, seed
    return failed


def test_problems_with_a_solution_are_solved(lcp: Any) -> None:
    assert unsolved(lcp, range(FEW)) == []


@pytest.mark.parametrize("boxes", [1, 2, 5])
@pytest.mark.parametrize("uneven", [1e-3, 1e-5, 1e-7])
def test_boxes_on_uneven_feet_rest_on_those_that_carry_them(boxes: int, uneven: float, lcp: Any) -> None:
    """Four feet of a rigid box press at once only where they are even. From the forces of even feet the first
    start leads to a solution, in which at least one foot of each box carries nothing."""
    even = stack(boxes, 0.3)
    start = coulomb(even, lcp).z
    for seed in range(4):
        b = even.b.copy()
        b[::3] += uneven * np.random.default_rng(seed).normal(size=4 * boxes)
        problem = replace(even, b=b)
        answer = coulomb(problem, lcp, start=start, starts=1)
        assert answer.outcome is Outcome.SOLVED
        assert natural_map(problem, answer.z) <= ENOUGH
        assert (answer.z[::3] > 0).sum() <= 3 * boxes


@pytest.mark.cases(20)
@pytest.mark.parametrize("seed", range(60))
def test_a_problem_without_a_solution_is_proved_to_have_none(seed: int, lcp: Any) -> None:
    assert coulomb(impossible(seed), lcp).outcome is Outcome.INFEASIBLE


@pytest.mark.slow
def test_of_thousands_999_in_1000_are_solved(lcp: Any) -> None:
    assert len(unsolved(lcp, range(MANY))) <= MANY / 1000


@pytest.mark.slow
def test_no_problem_without_a_solution_is_called_solved(lcp: Any) -> None:
    outcomes = [coulomb(impossible(seed), lcp).outcome for seed in range(NONE)]
    assert Outcome.SOLVED not in outcomes
    assert outcomes.count(Outcome.INFEASIBLE) >= 0.99 * NONE
