"""Programs with complementarity constraints by a homotopy: 0 <= G, 0 <= H, G H <= tau with tau falling.

S. Scholtes, SIAM J. Optim. 11 (2001), 918-936. Each relaxation starts from the solution of the one before. It
ends at a C-stationary point, which need not be the least of all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import casadi as ca
import numpy as np

Array = np.ndarray[Any, Any]
Symbol = TypeVar("Symbol", ca.SX, ca.MX)
RELAXATIONS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
ENOUGH = 1e-6  # a relaxation up to which the homotopy has to come
OPTIONS: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-8,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.mu_strategy": "monotone",
    "ipopt.mu_init": 1e-3,  # this and the next four keep the start, which is a motion, as it is
    "ipopt.bound_push": 1e-6,
    "ipopt.bound_frac": 1e-6,
    "ipopt.slack_bound_push": 1e-6,
    "ipopt.slack_bound_frac": 1e-6,
    "ipopt.max_iter": 300,
    "ipopt.bound_relax_factor": 0.0,
}


@dataclass(frozen=True)
class ComplementarityProgram(Generic[Symbol]):
    """min f(x, p) with lbx <= x <= ubx, lbg <= g <= ubg, and the pairs first, second."""

    x: Symbol
    f: Symbol
    g: Symbol
    lbx: Array
    ubx: Array
    lbg: Array
    ubg: Array
    first: Symbol  # (pairs,) G
    second: Symbol  # (pairs,) H
    p: Symbol | None = None


@dataclass(frozen=True)
class RelaxedSolution:
    """What the last relaxation that converged gave.

    Attributes:
        relaxation: that one; infinite where none converged.
        success: it is small enough, 1e-6.
        complementarity: max |min(G, H)|.
        violation: largest violation of g.
    """

    x: Array
    value: float
    complementarity: float
    violation: float
    iterations: int
    relaxation: float

    @property
    def success(self) -> bool:
        return self.relaxation <= ENOUGH


class RelaxedSolver(Generic[Symbol]):
    """The solver of one program, for any number of starts and numbers p."""

    def __init__(
        self,
        program: ComplementarityProgram[Symbol],
        relaxations: Sequence[float] = RELAXATIONS,
        options: dict[str, Any] | None = None,
    ) -> None:
        self._program: ComplementarityProgram[Symbol] = program
        self._relaxations = tuple(relaxations)
        symbol = type(program.x)
        tau = symbol.sym("tau")
        given = program.p if program.p is not None else symbol(0, 1)
        pairs = int(program.first.numel())
        products = tau - program.first * program.second
        constraints = ca.vertcat(program.g, program.first, program.second, products)
        problem = {"x": program.x, "p": ca.vertcat(given, tau), "f": program.f, "g": constraints}
        self._lower = np.concatenate([program.lbg, np.zeros(3 * pairs)])
        self._upper = np.concatenate([program.ubg, np.full(3 * pairs, np.inf)])
        self._solver = ca.nlpsol("relaxed", "ipopt", problem, OPTIONS | (options or {}))
        names = [program.f, program.g, ca.fmin(program.first, program.second)]
        self._measure = ca.Function("measure", [program.x, given], names)

    def solve(self, start: Array, p: Array | Sequence[float] = ()) -> RelaxedSolution:
        """The solution from a start, relaxation by relaxation."""
        at = best = np.asarray(start, dtype=float)
        iterations, reached = 0, np.inf
        program = self._program
        for tau in self._relaxations if program.first.numel() else self._relaxations[-1:]:
            answer = self._solver(
                x0=at, p=[*p, tau], lbx=program.lbx, ubx=program.ubx, lbg=self._lower, ubg=self._upper
            )
            stats = self._solver.stats()
            iterations += int(stats["iter_count"])
            found = np.array(answer["x"]).ravel()
            if np.isfinite(found).all():
                at = found
            if stats["success"]:
                best, reached = found, tau
        value, g, smaller = (np.array(each).ravel() for each in self._measure(best, list(p)))
        worst = np.maximum(program.lbg - g, g - program.ubg).max(initial=0.0)
        apart = float(np.abs(smaller).max(initial=0.0))
        return RelaxedSolution(best, float(value[0]), apart, float(worst), iterations, float(reached))
