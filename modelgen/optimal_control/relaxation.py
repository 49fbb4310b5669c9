"""Programs with complementarity constraints by a homotopy, and the branch of the constraints where it ends.

The homotopy solves 0 <= G, 0 <= H, G H <= tau with tau falling, each from the solution of the one before (S.
Scholtes, SIAM J. Optim. 11 (2001), 918-936). Its end is off by about tau, and may be C-stationary only. So,
once tau is small, one entry of each pair is set to zero, that which is nearer, and the program without
products is solved from there; where that fails, tau falls further. Where both entries of a pair are zero in
its solution, another branch may lead to a smaller value: the best first-order change of the solution
(`stationarity`) says which, and it is solved too, until there is no first-order descent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic

import numpy as np

from modelgen.optimal_control.complementarity_program import (
    Answer,
    Array,
    ComplementarityProgram,
    RelaxedProgram,
    Symbol,
)
from modelgen.optimal_control.stationarity import StationarityTest

RELAXATIONS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
BRANCH_FROM = 1e-5  # a relaxation from which on branches are tried
ENOUGH = 1e-6  # a relaxation up to which the homotopy has to come
BRANCHES = 20  # that are solved at most
DESCENT = 1e-4  # of the value, or of 1 if that is larger: a rate of descent up to which a point is stationary
GAIN = 1e-9  # of the value, relative, that is worth another branch
OPTIONS: dict[str, Any] = {
    "print_time": False,
    "show_eval_warnings": False,  # a step to where the functions are not defined is cut
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
class RelaxedSolution:
    """What the last relaxation that converged gave, or a branch from there.

    Attributes:
        relaxation: that one; zero where a branch was solved, infinite where none converged.
        descent: the best first-order decrease of the value, for a change of each unknown by its own size, or
            by 1 if that is larger, along which the linearised constraints and complementarity hold: proved by
            a mixed-integer linear program. Infinite where nothing converged or the proof took too long.
        complementarity: the largest of the smaller entries of each pair.
        violation: largest violation of bounds and constraints.
        converged: a branch was solved, or a relaxation of at most 1e-6.
        success: converged, and there is no first-order descent: `descent` is at most 1e-4 times the value or
            1, whichever is larger (B-stationary). Other motions may still cost less.
    """

    x: Array
    value: float
    complementarity: float
    violation: float
    iterations: int
    relaxation: float
    descent: float

    @property
    def converged(self) -> bool:
        return self.relaxation <= ENOUGH

    @property
    def success(self) -> bool:
        return self.converged and is_stationary(self.descent, self.value)


def is_stationary(descent: float, value: float) -> bool:
    """Whether a rate of descent counts as none."""
    return bool(descent <= DESCENT * max(1.0, abs(value)))


class RelaxedSolver(Generic[Symbol]):
    """The solver of one program, for any number of starts and numbers p.

    Args:
        relaxations: values of tau, falling.
        options: of IPOPT, beside or in place of `OPTIONS`.
        branches: solve branches after the homotopy.
    """

    def __init__(
        self,
        program: ComplementarityProgram[Symbol],
        relaxations: Sequence[float] = RELAXATIONS,
        options: dict[str, Any] | None = None,
        branches: bool = True,
    ) -> None:
        self._relaxations, self._branches = tuple(relaxations), branches
        self._first = program.paired[:, 0]  # places of the pairs among G and H, one behind the other
        self._second = program.paired[:, 1] + int(program.first.numel())
        self._relaxed: RelaxedProgram[Symbol] = RelaxedProgram(program, OPTIONS | (options or {}))
        self._test: StationarityTest[Symbol] = StationarityTest(program)

    def solve(self, start: Array, p: Sequence[float] = ()) -> RelaxedSolution:
        """The solution from a start: relaxation by relaxation, until a branch is solved."""
        at = best = np.asarray(start, dtype=float)
        iterations, relaxation, descent = 0, np.inf, np.inf
        paired = len(self._first) > 0
        for tau in self._relaxations if paired else self._relaxations[-1:]:
            answer = self._relaxed.relaxed(at, p, tau)
            iterations += answer.iterations
            if np.isfinite(answer.x).all():
                at = answer.x
            if answer.success:
                best, relaxation = answer.x, tau
            if self._branches and paired and (tau <= BRANCH_FROM or tau == self._relaxations[-1]):
                found, descent, more = self._best_branch(at, p)
                iterations += more
                if found is not None:
                    best, relaxation = found.x, 0.0
                    break
        x = best if np.isfinite(relaxation) else at
        if relaxation > 0 and np.isfinite(relaxation):
            descent = self._test.descent(x, p).rate
        value, violation, sides = self._relaxed.measured(x, p)
        return RelaxedSolution(x, value, self._apart(sides), violation, iterations, relaxation, descent)

    def _best_branch(self, at: Array, p: Sequence[float]) -> tuple[Answer | None, float, int]:
        """The branch on which the homotopy ended, or one that is reached from it and better: its solution,
        the rate of its best first-order descent, and iterations."""
        zero = self._zero(self._relaxed.measured(at, p)[2])
        best: Answer | None = None
        rate, iterations = np.inf, 0
        for _ in range(BRANCHES):
            answer = self._relaxed.branch(at, p, zero)
            iterations += answer.iterations
            gain = np.inf if best is None else best.value - answer.value
            if not answer.success or gain < GAIN * max(1.0, abs(answer.value)):
                break
            best = answer
            descent = self._test.descent(answer.x, p)
            rate, at, zero = descent.rate, descent.x, descent.zero
            if is_stationary(rate, answer.value):
                break
        return best, rate, iterations

    def _zero(self, sides: Array) -> Array:
        """(n + m,) the entries that are set to zero, so that each pair has one: first those whose partner
        is not zero, then the smaller ones."""
        zero = np.zeros(len(sides), dtype=bool)
        first, second = self._first, self._second
        nearer = np.where(sides[first] <= sides[second], first, second)
        order = np.argsort(-np.maximum(sides[first], sides[second]))
        for k in order:
            if not zero[first[k]] and not zero[second[k]]:
                zero[nearer[k]] = True
        return zero

    def _apart(self, sides: Array) -> float:
        return float(np.abs(np.minimum(sides[self._first], sides[self._second])).max(initial=0.0))
