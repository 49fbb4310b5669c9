"""Small programs with complementarity constraints whose optimal values are published."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import linprog

from modelgen.errors import ModelgenError
from modelgen.optimal_control.complementarity_program import ComplementarityProgram
from modelgen.optimal_control.relaxation import RelaxedSolver
from modelgen.optimal_control.stationarity import StationarityTest

Term = Callable[[ca.SX], Any]
Pair = tuple[Term, Term]
FREE = (-np.inf,) * 3


def entry(k: int) -> Term:
    return lambda x: x[k]


X, Y, Z = entry(0), entry(1), entry(2)

# MacMPEC (S. Leyffer): objective, pairs, lower bounds, start, optimal value
PROBLEMS: dict[str, tuple[Term, Sequence[Pair], Sequence[float], Sequence[float], float]] = {
    "kth1": (lambda x: x[0] + x[1], [(X, Y)], FREE[:2], (0.5, 0.5), 0.0),
    "kth2": (lambda x: x[0] + (x[1] - 1) ** 2, [(X, Y)], FREE[:2], (1, 1), 0.0),
    "kth3": (lambda x: 0.5 * (x[0] - 1) ** 2 + (x[1] - 1) ** 2, [(X, Y)], FREE[:2], (1, 1), 0.5),
    "ralph2": (lambda x: x[0] ** 2 + x[1] ** 2 - 4 * x[0] * x[1], [(X, Y)], FREE[:2], (1, 1), 0.0),
    "scholtes1": (
        lambda x: (x[0] + 1) ** 2 + (x[1] - 2.5) ** 2 + (x[2] + 1) ** 2,
        [(lambda x: x[1] - ca.exp(x[0]) - ca.exp(x[2]), X)],
        (-np.inf, -np.inf, 0.0), (1, 1, 1), 2.0,
    ),
    "scholtes3": (lambda x: 0.5 * ((x[0] - 1) ** 2 + (x[1] - 1) ** 2), [(X, Y)], FREE[:2], (1e-4, 0), 0.5),
    "scholtes5": (
        lambda x: (x[0] - 1) ** 2 + (x[1] - 2) ** 2 + (x[2] + 1) ** 2,
        [(X, Z), (Y, Z)], FREE, (1, 1, 1), 1.0,
    ),
    "jr1": (lambda x: (x[0] - 1) ** 2 + x[1] ** 2, [(Y, lambda x: x[1] - x[0])], FREE[:2], (0, 0), 0.5),
    "jr2": (lambda x: (x[1] - 1) ** 2 + x[0] ** 2, [(Y, lambda x: x[1] - x[0])], FREE[:2], (0, 0), 0.5),
}  # fmt: skip


@pytest.mark.parametrize("name", PROBLEMS)
def test_small_programs_reach_their_published_values(name: str) -> None:
    objective, pairs, lower, start, value = PROBLEMS[name]
    x = ca.SX.sym("x", len(start))
    first, second = (ca.vertcat(*(pair[side](x) for pair in pairs)) for side in range(2))
    program = ComplementarityProgram(
        x=x, f=objective(x), g=ca.SX(0, 1), lbx=np.array(lower), ubx=np.full(len(start), np.inf),
        lbg=np.zeros(0), ubg=np.zeros(0), first=first, second=second,
    )  # fmt: skip
    found = RelaxedSolver(program).solve(np.array(start, dtype=float))
    assert found.success
    assert found.value == pytest.approx(value, abs=1e-6)
    assert found.complementarity < 1e-9
    relaxed = RelaxedSolver(program, branches=False).solve(np.array(start, dtype=float))
    assert relaxed.converged
    assert relaxed.value == pytest.approx(value, abs=1e-2)


def test_a_better_branch_is_found_where_the_homotopy_ends_at_a_worse_one() -> None:
    """dempe of MacMPEC from its start: the homotopy alone ends at 31.25; published is 28.25."""
    x = ca.SX.sym("x", 3)
    inf = np.full(3, np.inf)
    program = ComplementarityProgram(
        x=x, f=(x[0] - 3.5) ** 2 + (x[1] + 4) ** 2, g=x[1] - 3 + 2 * x[1] * x[2], lbx=-inf, ubx=inf,
        lbg=np.zeros(1), ubg=np.zeros(1), first=x[0] - x[1] ** 2, second=x[2],
    )  # fmt: skip
    start = np.array([0.183193, 0.428106, 3.00379])
    found = RelaxedSolver(program).solve(start)
    assert found.success
    assert found.value == pytest.approx(28.25, abs=1e-6)


def test_sizes_that_do_not_fit_are_refused() -> None:
    x = ca.SX.sym("x", 2)
    with pytest.raises(ModelgenError, match="entries in first"):
        small(x, x[0], x, x[0])
    with pytest.raises(ModelgenError, match="a pair beyond"):
        small(x, x[0], x, x[0], [(0, 0), (2, 0)])
    with pytest.raises(ModelgenError, match="entries in lbx"):
        ComplementarityProgram(
            x, x[0], ca.SX(0, 1), np.zeros(1), np.zeros(2), np.zeros(0), np.zeros(0), x[0], x[1]
        )


def small(x: ca.SX, f: ca.SX, first: ca.SX, second: ca.SX, pairs: Any = None) -> Any:
    none = np.zeros(0)
    free = np.full(2, np.inf)
    return ComplementarityProgram(x, f, ca.SX(0, 1), -free, free, none, none, first, second, pairs=pairs)


@pytest.mark.parametrize("seed", range(12))
def test_the_best_first_order_change_is_that_of_the_best_branch(seed: int) -> None:
    """At a random point of a random program: against the linear programs of all branches, one by one."""
    random, n = np.random.default_rng(seed), 4
    x = ca.SX.sym("x", 2 * n)
    at = np.where(random.random(2 * n) < 0.5, 0.0, random.uniform(0.2, 2.0, 2 * n))
    at[:n] = np.where(at[n:] > 0, 0.0, at[:n])  # of each pair one is zero; both of some
    slope, row = random.normal(size=2 * n), random.normal(size=2 * n)
    bend = random.normal(size=(2 * n, 2 * n))
    apart = x - at
    program = ComplementarityProgram(
        x=x, f=ca.dot(slope, apart) + ca.bilin(ca.DM(bend), apart, apart),
        g=ca.dot(row, apart) + ca.sumsqr(apart),
        lbx=np.full(2 * n, -np.inf), ubx=np.full(2 * n, np.inf), lbg=np.zeros(1), ubg=np.zeros(1),
        first=x[:n], second=ca.exp(x[n:]) - 1,
    )  # fmt: skip
    scale = np.maximum(1.0, at)
    held = np.concatenate([at[n:] > 0, at[:n] > 0])
    both = np.flatnonzero((at[:n] == 0) & (at[n:] == 0))
    best = 0.0
    for sides in product((0, 1), repeat=len(both)):
        zero = held.copy()
        zero[both + n * np.array(sides, dtype=int)] = True
        bounds = [
            (0.0, 0.0) if zero[k] else (0.0 if at[k] == 0 else -min(1.0, at[k] / scale[k] / 1e-3), 1.0)
            for k in range(2 * n)
        ]
        found = linprog(slope * scale, A_eq=[row * scale], b_eq=[0.0], bounds=bounds)
        best = max(best, -found.fun)
    assert StationarityTest(program).descent(at).rate == pytest.approx(best, rel=1e-6, abs=1e-7)
