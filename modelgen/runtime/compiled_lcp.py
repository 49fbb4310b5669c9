"""Complementarity problems through the compiled core: 0 <= z, 0 <= w = A z + b, z.w = 0.

With A = J M^-1 J' and b = J M^-1 F + Gamma2 this is the contact step (2.6), (2.7): z the forces (N), w the
normal accelerations (m/s^2). Every answer carries the residual that certifies it; without a certificate none
is called solved. Definitions: R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, Protocol, assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.errors import SimulationError
from modelgen.runtime.c_arrays import C_REALS, frozen, pointer
from modelgen.runtime.tables.scratch_memory import solver_scratch

Method = Literal["auto", "qp", "lemke", "enumerate"]
ENUMERATE_MAX = 20  # rows, as in the core
LEMKE_PIVOTS = 20_000  # per path
QP_ITERATIONS = 1000  # active sets
_EIGENVALUE_SLACK = 1e-12  # per row: eigenvalues of the scaled matrix down to -n times this count as zero


class Outcome(Enum):
    """How a complementarity problem ended; the value says what to do.

    In the order of mg_lcp_outcome in core/solve/lcp/lcp.h.
    """

    SOLVED = "the answer satisfies the conditions to its residual"
    INFEASIBLE = "no solution exists: the contacts demand what no force can give; check b and the constraints"
    RAY = "the method ended without a conclusion; try method='enumerate' for up to 20 rows, or reformulate"
    ITERATIONS = "the iteration limit was met; allow more iterations or check the scaling of A"
    NOT_FINITE = "A or b hold NaN, infinity, or numbers out of the range of the real type; check the data"


@dataclass(frozen=True, slots=True)
class LcpSolution:
    """Answer of a complementarity problem of n rows; z and w mean something only if `outcome` is SOLVED."""

    z: NDArray[Any]  # (n,) N, nonnegative; otherwise the best candidate
    w: NDArray[Any]  # (n,) m/s^2, A z + b
    outcome: Outcome
    residual: float  # max |min(z d, w/d)| / max(|b|/d), d = sqrt(diag A) (1 where not positive)
    rank: int  # of A on the active set (QP); n for the general methods
    iterations: int  # active sets, pivots or bases tried
    active: NDArray[np.bool_]  # (n,) z > 0


class CoreLibrary(Protocol):
    """The part of a compiled library that the solvers need."""

    @property
    def cdll(self) -> ctypes.CDLL:
        """The loaded shared object."""

    @property
    def dtype(self) -> Any:
        """numpy's type of the library's reals."""


def solve_qp(
    A: ArrayLike,
    b: ArrayLike,
    library: CoreLibrary,
    *,
    active: ArrayLike | None = None,
    iterations: int = QP_ITERATIONS,
) -> LcpSolution:
    """min z'Az/2 + b'z over z >= 0, A symmetric positive semidefinite; of all solutions that of least |D z|.

    Args:
        A: (n, n) 1/kg, symmetric positive semidefinite (not checked: see `solve_lcp`).
        b: (n,) m/s^2.
        active: (n,) bool, where the search for the active set starts; empty by default.

    Raises:
        SimulationError: shapes that do not fit.

    Source: core/solve/lcp/qp.c, the QP of Gauss's principle for (2.6), (2.7).
    """
    return _call("mg_qp", _Problem.of(A, b, library), iterations, _start(active, np.size(b)))


def solve_lcp(A: ArrayLike, b: ArrayLike, library: CoreLibrary, method: Method = "auto") -> LcpSolution:
    """Solves with any A: as a QP if A is symmetric positive semidefinite, else by Lemke, else (n <= 20) by
    enumeration.

    INFEASIBLE comes from the QP or from the enumeration alone. Raises SimulationError if shapes do not fit.
    """
    problem = _Problem.of(A, b, library)
    match method:
        case "qp":
            return _call("mg_qp", problem, QP_ITERATIONS, _start(None, problem.n))
        case "lemke":
            return _call("mg_lemke", problem, LEMKE_PIVOTS)
        case "enumerate":
            return _call("mg_enumerate", problem)
        case "auto":
            return _solve_any(problem)
        case _:
            assert_never(method)


@dataclass(frozen=True, slots=True)
class _Problem:
    A: NDArray[Any]  # (n, n) column-major
    b: NDArray[Any]  # (n,)
    library: CoreLibrary

    @classmethod
    def of(cls, A: ArrayLike, b: ArrayLike, library: CoreLibrary) -> _Problem:
        matrix = np.asfortranarray(A, dtype=library.dtype)
        vector = np.ascontiguousarray(b, dtype=library.dtype)
        n = vector.size
        if vector.shape != (n,) or matrix.size != n * n or (n and matrix.shape != (n, n)):
            raise SimulationError(
                "complementarity problem",
                f"A of shape {matrix.shape} and b of shape {vector.shape}",
                "A is (n, n) and b is (n,)",
            )
        return cls(matrix, vector, library)

    @property
    def n(self) -> int:
        return int(self.b.size)


def _solve_any(problem: _Problem) -> LcpSolution:
    if _is_semidefinite(problem.A):
        return _call("mg_qp", problem, QP_ITERATIONS, _start(None, problem.n))
    answer = _call("mg_lemke", problem, LEMKE_PIVOTS)
    if answer.outcome in (Outcome.SOLVED, Outcome.NOT_FINITE) or problem.n > ENUMERATE_MAX:
        return answer
    return _call("mg_enumerate", problem)


def _is_semidefinite(A: NDArray[Any]) -> bool:
    """A = A' and D^-1 A D^-1 >= 0, both to rounding."""
    if not A.size or not np.isfinite(A).all():
        return True
    diagonal = np.diag(A)
    d = np.sqrt(np.where(diagonal > 0, diagonal, 1)).astype(np.float64)
    scaled = A.astype(np.float64) / d[:, None] / d
    slack = _EIGENVALUE_SLACK * len(d) * max(1.0, float(np.finfo(A.dtype).eps / np.finfo(np.float64).eps))
    return bool(np.abs(scaled - scaled.T).max() <= slack and np.linalg.eigvalsh(scaled)[0] >= -slack)


def _start(active: ArrayLike | None, n: int) -> NDArray[np.intc]:
    if active is None:
        return np.zeros(n, dtype=np.intc)
    start = np.array(active, dtype=bool).astype(np.intc)
    if start.shape != (n,):
        raise SimulationError("complementarity problem", f"active of shape {start.shape}", f"shape ({n},)")
    return start


def _call(
    name: str, problem: _Problem, iterations: int | None = None, active: NDArray[np.intc] | None = None
) -> LcpSolution:
    """Calls a solver of the core: (n, A, b [, iterations], z [, active], report, work, iwork)."""
    n, cdll = problem.n, problem.library.cdll
    report = _report(problem.b.dtype)
    z = np.zeros(n, dtype=problem.b.dtype)
    work, iwork = solver_scratch(cdll.mg_lcp_work_size, cdll.mg_lcp_iwork_size, problem.b.dtype, n)
    limit = [] if iterations is None else [ctypes.c_int(iterations)]
    start = [] if active is None else [pointer(active)]
    getattr(cdll, name)(
        ctypes.c_int(n), pointer(problem.A), pointer(problem.b), *limit, pointer(z), *start,
        ctypes.byref(report), pointer(work), pointer(iwork),
    )  # fmt: skip
    with np.errstate(invalid="ignore", over="ignore"):
        w = problem.A @ z + problem.b if n else z.copy()
    return LcpSolution(
        z=frozen(z),
        w=frozen(w),
        outcome=list(Outcome)[report.outcome],
        residual=float(report.residual),
        rank=int(report.rank),
        iterations=int(report.iterations),
        active=frozen(z > 0),
    )


def _report(dtype: np.dtype[Any]) -> Any:
    integers = [(name, ctypes.c_int) for name in ("outcome", "iterations", "rank")]
    fields = [*integers, ("residual", C_REALS[dtype.char])]
    return type("LcpReport", (ctypes.Structure,), {"_fields_": fields})()
