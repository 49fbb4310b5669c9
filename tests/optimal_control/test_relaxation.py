"""Small programs with complementarity constraints whose optimal values are published."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen.optimal_control.complementarity_program import ComplementarityProgram
from modelgen.optimal_control.relaxation import RelaxedSolver

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
