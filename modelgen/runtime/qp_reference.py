"""An independent answer to the contact QP: CasADi's `conic` with qpOASES. Slow; for tests and comparisons."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.runtime.compiled_lcp import LcpSolution, Outcome

_OPTIONS: dict[str, Any] = {"printLevel": "none", "error_on_fail": False}
_OFF = 1e-7  # of max w: a row with more acceleration than this carries no force


def reference_qp(A: ArrayLike, b: ArrayLike) -> LcpSolution:
    """What `solve_qp` answers, by two QPs: min z'Az/2 + b'z over z >= 0, then min |D z| over its solutions.

    The accelerations w = A z + b are the same for all solutions; so the second QP has A z = w - b, and
    z_i = 0 where w_i > 0. Shapes and units as in `solve_qp`; the rank is that of the active block.
    """
    matrix, vector = np.asarray(A, dtype=np.float64), np.asarray(b, dtype=np.float64)
    d = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))
    S, c = matrix / d[:, None] / d, vector / d
    scale = float(np.abs(c).max(initial=0.0)) or 1.0
    free = np.full(len(c), np.inf)
    y, solved = _conic(S, c / scale, np.zeros((0, len(c))), np.zeros(0), free)
    if not solved:
        return _solution(matrix, vector, np.zeros_like(c), Outcome.INFEASIBLE)
    w = S @ y + c / scale
    ceiling = np.where(w > _OFF * max(1.0, float(w.max(initial=0.0))), 0.0, free)
    least, found = _conic(np.eye(len(c)), np.zeros_like(c), S[ceiling > 0], (S @ y)[ceiling > 0], ceiling)
    return _solution(matrix, vector, (least if found else y) * scale / d, Outcome.SOLVED)


def _conic(
    H: NDArray[Any], g: NDArray[Any], equations: NDArray[Any], right: NDArray[Any], ceiling: NDArray[Any]
) -> tuple[NDArray[Any], bool]:
    """min y'Hy/2 + g'y with equations y = right, 0 <= y <= ceiling; a new solver each time, cold."""
    import casadi as ca

    dense = {"h": ca.Sparsity.dense(*H.shape), "a": ca.Sparsity.dense(*equations.shape)}
    solver = ca.conic("reference", "qpoases", dense, _OPTIONS)
    answer = solver(h=H, g=g, a=equations, lba=right, uba=right, lbx=0, ubx=ceiling)
    return np.array(answer["x"]).ravel(), bool(solver.stats()["success"])


def _solution(A: NDArray[Any], b: NDArray[Any], z: NDArray[Any], outcome: Outcome) -> LcpSolution:
    z = np.maximum(z, 0.0)
    w = A @ z + b
    d = np.sqrt(np.where(np.diag(A) > 0, np.diag(A), 1.0))
    scale = np.abs(b / d).max(initial=0.0) or 1.0
    residual = float(np.abs(np.minimum(z * d, w / d)).max(initial=0.0) / scale)
    block = (A / d[:, None] / d)[np.ix_(z > 0, z > 0)]
    rank = int(np.linalg.matrix_rank(block, hermitian=True)) if block.size else 0
    return LcpSolution(z, w, outcome, residual, rank, 0, z > 0)
