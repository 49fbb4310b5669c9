"""One contact alone: its law has a closed form but for one number, and the sweep solves it at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from modelgen.runtime.friction import FrictionProblem, Motion, Outcome, coulomb
from tests.core.frictional import with_bilateral

EPS = float(np.finfo(float).eps)
SEEDS = range(80)
NEWTON = 6  # sweeps that are made before Newton steps are


def one(seed: int) -> FrictionProblem:
    """A contact that presses; its normal and tangential rows coupled as strongly as its friction."""
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(3, 4))
    b = J @ rng.normal(size=4)
    b[0] = -abs(b[0])
    mu = rng.uniform(0.05, 0.8)
    return FrictionProblem.of(J @ J.T, b, [mu])


def slide(problem: FrictionProblem, a: float) -> np.ndarray:
    """N and f where w_n = 0 and w_t = -a f."""
    return np.asarray(np.linalg.solve(problem.A + np.diag([0, a, a]), -problem.b))


def alone(problem: FrictionProblem) -> list[np.ndarray]:
    """All answers that press: sticking, and every root a > 0 of |f| = mu N on a fine grid of decades."""
    mu = float(problem.cone[0, 0])

    def excess(a: float) -> float:
        z = slide(problem, a)
        return float(np.hypot(*z[1:]) - mu * z[0])

    stuck, found = slide(problem, 0.0), []
    if stuck[0] > 0 and np.hypot(*stuck[1:]) <= mu * stuck[0]:
        found.append(stuck)
    grid = np.geomspace(1e-8, 1e8, 3000) * np.trace(problem.A)
    values = [excess(a) for a in grid]
    for low, high, u, v in zip(grid, grid[1:], values, values[1:], strict=False):
        if u * v < 0:
            z = slide(problem, brentq(excess, low, high, xtol=1e-300, rtol=4 * EPS))
            if z[0] > 0 and abs(np.hypot(*z[1:]) - mu * z[0]) < 1e-6 * z[0]:  # not a pole
                found.append(z)
    return found


def test_one_contact_does_as_another_route_says(lcp: Any) -> None:
    slid = 0
    for problem in map(one, SEEDS[:40]):
        answer, answers = coulomb(problem, lcp), alone(problem)
        assert answer.outcome is Outcome.SOLVED
        size = np.abs(answer.z).max()
        assert min(np.abs(answer.z - z).max() for z in answers) < 1e-9 * size
        slid += Motion.SLIPS in answer.motions[0]
    assert 25 < slid < 40


@pytest.mark.parametrize("joints", [0, 2])
def test_sweeps_alone_solve_one_contact(lcp: Any, joints: int) -> None:
    """The sweep solves its contact exactly, coupling of N and f included: nothing is left to Newton steps."""
    for seed in SEEDS:
        problem = one(seed)
        if joints:
            problem = with_bilateral(problem, np.random.default_rng(seed), joints)
        answer = coulomb(problem, lcp)
        assert answer.outcome is Outcome.SOLVED
        assert answer.iterations < NEWTON, seed
