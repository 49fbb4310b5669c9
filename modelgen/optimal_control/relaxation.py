"""Programs with complementarity constraints by a homotopy, and the branch of the constraints where it ends.

The homotopy solves 0 <= G, 0 <= H, G H <= tau with tau falling, each from the solution of the one before (S.
Scholtes, SIAM J. Optim. 11 (2001), 918-936). Its end is off by about tau, and may be C-stationary only. So,
once tau is small, one entry of each pair is set to zero, that which is nearer, and the program without
products is solved from there; where that fails, tau falls further. Where both entries of a pair are zero in
its solution, the multiplier of the one that was set to zero says whether the other branch leads to a smaller
value; if so, it is solved too. An end at which no multiplier says so is strongly stationary (H. Scheel, S.
Scholtes, Math. Oper. Res. 25 (2000), 1-22).
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

RELAXATIONS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
BRANCH_FROM = 1e-5  # a relaxation from which on branches are tried
ENOUGH = 1e-6  # a relaxation up to which the homotopy has to come
ZERO = 1e-6  # an entry of a pair up to which it counts as zero
BRANCHES = 20  # that are solved at most
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
        strong: a branch was solved, and no multiplier says that another leads to a smaller value.
        complementarity: the largest of the smaller entries of each pair.
        violation: largest violation of bounds and constraints.
        success: the relaxation is small enough, 1e-6.
    """

    x: Array
    value: float
    complementarity: float
    violation: float
    iterations: int
    relaxation: float
    strong: bool

    @property
    def success(self) -> bool:
        return self.relaxation <= ENOUGH


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

    def solve(self, start: Array, p: Sequence[float] = ()) -> RelaxedSolution:
        """The solution from a start: relaxation by relaxation, until a branch is solved."""
        at = best = np.asarray(start, dtype=float)
        iterations, relaxation, strong = 0, np.inf, False
        paired = len(self._first) > 0
        for tau in self._relaxations if paired else self._relaxations[-1:]:
            answer = self._relaxed.relaxed(at, p, tau)
            iterations += answer.iterations
            if np.isfinite(answer.x).all():
                at = answer.x
            if answer.success:
                best, relaxation = answer.x, tau
            if self._branches and paired and (tau <= BRANCH_FROM or tau == self._relaxations[-1]):
                found, strong, more = self._best_branch(at, p)
                iterations += more
                if found is not None:
                    best, relaxation = found.x, 0.0
                    break
        x = best if np.isfinite(relaxation) else at
        value, violation, sides = self._relaxed.measured(x, p)
        return RelaxedSolution(x, value, self._apart(sides), violation, iterations, relaxation, strong)

    def _best_branch(self, at: Array, p: Sequence[float]) -> tuple[Answer | None, bool, int]:
        """The branch on which the homotopy ended, or one that is reached from it and better: its solution,
        whether it is strongly stationary, and iterations."""
        zero = self._zero(self._relaxed.measured(at, p)[2])
        best: Answer | None = None
        strong, iterations = False, 0
        for _ in range(BRANCHES):
            answer = self._relaxed.branch(at if best is None else best.x, p, zero)
            iterations += answer.iterations
            gain = np.inf if best is None else best.value - answer.value
            if not answer.success or gain < GAIN * max(1.0, abs(answer.value)):
                break
            best = answer
            other = self._other_branch(answer, p, zero)
            strong = other is None
            if other is None:
                break
            zero = other
        return best, strong, iterations

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

    def _other_branch(self, answer: Answer, p: Sequence[float], zero: Array) -> Array | None:
        """With the entries released whose multipliers say so, and their partners zero in place of them."""
        sides = self._relaxed.measured(answer.x, p)[2]
        small = answer.multipliers > ZERO * max(1.0, np.abs(answer.multipliers).max(initial=0.0))
        found = zero.copy()
        for one, other in ((self._first, self._second), (self._second, self._first)):
            for entry in np.unique(one[zero[one] & small[one]]):
                partners = other[one == entry]
                if (sides[partners] <= ZERO).all():
                    found[entry], found[partners] = False, True
        return None if (found == zero).all() else found

    def _apart(self, sides: Array) -> float:
        return float(np.abs(np.minimum(sides[self._first], sides[self._second])).max(initial=0.0))
