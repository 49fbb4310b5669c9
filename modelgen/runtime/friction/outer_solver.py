"""Solvers of this package in place of the core's, for a whole run (mg_outer_solver of the core).

The core asks them for the forces of contacts without friction and for the impulses of time-stepping.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

from modelgen.runtime.compiled_lcp import CoreLibrary
from modelgen.runtime.friction import Solver, solver
from modelgen.runtime.friction.compiled_solvers import problem_structure, report_structure
from modelgen.runtime.friction.problem import CONE, FrictionProblem, FrictionSolution, Motion, Outcome

SAME = {"lcp": "polyhedral"}  # the linear complementarity problem, which has no cones without friction
_NOT_FINITE = list(Outcome).index(Outcome.NOT_FINITE)


class OuterSolver:
    """A solver as the core calls it. After an exception in it, kept in `failure`, it solves nothing more."""

    def __init__(self, name: str, number: int, library: CoreLibrary) -> None:
        """`number`: tells it from others in saved states."""
        self.failure: BaseException | None = None
        self._solver: Solver = solver(SAME.get(name, name))  # type: ignore[arg-type]
        self._library, self._dtype = library, np.dtype(library.dtype)
        self._problem, self._report = problem_structure(self._dtype), report_structure(self._dtype)
        pointer = ctypes.c_void_p
        entry = ctypes.CFUNCTYPE(ctypes.c_int, *[pointer] * 5)(self._called)
        fields = [("solve", type(entry)), ("of", pointer), ("number", ctypes.c_int)]
        record = type("OuterSolver", (ctypes.Structure,), {"_fields_": fields})
        self.structure = record(entry, None, number)

    def _called(self, _of: int, problem: int, z: int, marks: int, report: int) -> int:
        told = self._report.from_address(report)
        told.outcome = _NOT_FINITE
        if self.failure is not None:
            return _NOT_FINITE
        try:
            given = self._problem.from_address(problem)
            asked = self._read(given)
            if not (np.isfinite(asked.A).all() and np.isfinite(asked.b).all()):
                return _NOT_FINITE
            answer = self._solver(asked, self._library)
            self._array(z, asked.n, self._dtype)[:] = answer.z
            self._array(marks, len(asked.first), np.dtype(np.intc))[:] = [int(m) for m in answer.motions]
            told.outcome = list(Outcome).index(answer.outcome)
            told.newton, told.residual = answer.iterations, answer.residual
            if given.wants_rank:
                told.active, told.rank = _rank(asked, answer)
        except BaseException as error:  # the core cannot pass it on
            self.failure, told.outcome = error, _NOT_FINITE
        return int(told.outcome)

    def _read(self, given: Any) -> FrictionProblem:
        n, count = given.n, given.n_contact
        real, integer = self._dtype, np.dtype(np.intc)
        return FrictionProblem(
            A=self._array(given.A, n * n, real).reshape(n, n).T.astype(np.float64),
            b=self._array(given.b, n, real).astype(np.float64),
            first=self._array(given.first, count, integer).copy(),
            rows=self._array(given.rows, count, integer).copy(),
            cone=self._array(given.cone, CONE * count, real).reshape(count, CONE).astype(np.float64),
        )

    @staticmethod
    def _array(at: int, size: int, dtype: np.dtype[Any]) -> NDArray[Any]:
        """The entries at an address, not copied."""
        return np.ndarray(
            size, dtype, buffer=memoryview((ctypes.c_char * (size * dtype.itemsize)).from_address(at))
        )


def _rank(problem: FrictionProblem, answer: FrictionSolution) -> tuple[int, int]:
    """How many contacts press, and the rank of their matrix, the bilateral rows held."""
    held = problem.bilateral
    pressing = [int(r) for r, m in zip(problem.first, answer.motions, strict=True) if m & Motion.PRESSES]
    rows = np.concatenate([np.array(pressing, dtype=np.intp), held])
    d = np.sqrt(np.where(np.diag(problem.A) > 0, np.diag(problem.A), 1.0))
    scaled = problem.A / d[:, None] / d

    def rank(of: NDArray[Any]) -> int:
        block = scaled[np.ix_(of, of)]
        return int(np.linalg.matrix_rank(block, hermitian=True)) if len(of) else 0

    return len(pressing), rank(rows) - rank(held)
