"""Accelerations of sliding contacts: cases in which Coulomb's law has no solution or several (Painleve)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.errors import SimulationError
from modelgen.runtime.friction.problem import FrictionProblem

CONTACTS_MAX = 12
_ROUNDING = 1e-10  # of the scaled problem: what counts as zero when signs are read


class Paradox(Enum):
    """The number of solutions; the value is the advice to the user."""

    NONE = "one answer"
    INCONSISTENT = "no forces satisfy the law (Painleve): a jump of velocities is needed; step in impulses"
    INDETERMINATE = "several accelerations satisfy the law (Painleve): the law does not say which"
    FORCES_ONLY = "one acceleration, but the forces that give it are not unique"


@dataclass(frozen=True)
class SlidingAnswer:
    """All solutions with a regular basis matrix, as normal forces."""

    paradox: Paradox
    normal_forces: tuple[NDArray[Any], ...]  # each (n_contact,), N
    accelerations: tuple[NDArray[Any], ...]  # each (n_contact,), w_n


def sliding(problem: FrictionProblem, slip: ArrayLike) -> SlidingAnswer:
    """Solutions for contacts of 3 rows that slide in given directions, where f = -N mu (mu s) / |mu s|.

    What remains is a complementarity problem of N with a matrix A_nn - A_nt mu (mu s) / |mu s| that is not
    symmetric, and no P-matrix where friction is strong: then it may have no or several solutions (P.
    Painleve, C. R. Acad. Sci. 121 (1895), 112-115; P. Lotstedt, Z. Angew. Math. Mech. 61 (1981), 605-615).
    All 2^n sets of pressing contacts are tried; a basis whose matrix is singular is left out.

    Args:
        problem: accelerations at this instant; bilateral rows are allowed.
        slip: (n_contact, 2) sliding velocity along t1, t2, m/s; zero: the contact carries no friction here.

    Raises:
        SimulationError: more than 12 contacts, contacts without 3 rows, or a slip of another shape.
    """
    velocity = np.asarray(slip, dtype=np.float64)
    count = len(problem.first)
    if count > CONTACTS_MAX or (problem.rows != 3).any() or velocity.shape != (count, 2):
        found = f"{count} contacts with rows {problem.rows.tolist()} and slip of shape {velocity.shape}"
        allowed = f"at most {CONTACTS_MAX} contacts of 3 rows, slip of shape (n_contact, 2)"
        raise SimulationError("sliding contacts", found, allowed)
    matrix, vector = _normal_problem(problem, velocity)
    answers = [
        z
        for pressing in product([False, True], repeat=count)
        if (z := _basis(matrix, vector, pressing)) is not None
    ]
    forces = _distinct(answers)
    accelerations = _distinct([matrix @ z + vector for z in answers])
    return SlidingAnswer(_verdict(len(forces), len(accelerations)), tuple(forces), tuple(accelerations))


def _verdict(forces: int, accelerations: int) -> Paradox:
    if forces == 0:
        return Paradox.INCONSISTENT
    if accelerations > 1:
        return Paradox.INDETERMINATE
    return Paradox.NONE if forces == 1 else Paradox.FORCES_ONLY


def _normal_problem(problem: FrictionProblem, slip: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """The problem in N alone, and G: forces of all rows per unit N; bilateral rows are eliminated."""
    G = np.zeros((problem.n, len(slip)))
    for contact, (row, mu, s) in enumerate(zip(problem.first, problem.cone[:, :2], slip, strict=True)):
        size = np.hypot(*(mu * s))
        G[row, contact] = 1
        G[row + 1 : row + 3, contact] = -mu * (mu * s) / size if size > 0 else 0
    held, A = problem.bilateral, problem.A
    inverse = np.linalg.pinv(A[np.ix_(held, held)], hermitian=True)
    to_held = A[np.ix_(problem.first, held)] @ inverse
    matrix = A[problem.first] @ G - to_held @ (A[held] @ G)
    return matrix, problem.b[problem.first] - to_held @ problem.b[held]


def _basis(matrix: NDArray[Any], vector: NDArray[Any], pressing: tuple[bool, ...]) -> NDArray[Any] | None:
    on = np.array(pressing)
    scale = np.sqrt(np.abs(np.diag(matrix)) + _ROUNDING * np.abs(matrix).max(initial=1.0))
    S = matrix / scale[:, None] / scale
    size = float(np.abs(vector / scale).max(initial=0.0)) or 1.0
    c, y = vector / scale / size, np.zeros(len(vector))
    block = S[np.ix_(on, on)]
    if on.any() and np.linalg.cond(block) > 1 / _ROUNDING:
        return None
    y[on] = np.linalg.solve(block, -c[on])
    slack = _ROUNDING * max(1.0, float(np.abs(y).max(initial=0.0)))
    if (y < -slack).any() or (S @ y + c < -slack).any():
        return None
    return np.asarray(np.maximum(y, 0) / scale * size)


def _distinct(answers: list[NDArray[Any]]) -> list[NDArray[Any]]:
    kept: list[NDArray[Any]] = []
    size = max((float(np.abs(answer).max(initial=0.0)) for answer in answers), default=0.0)
    for answer in answers:
        if all(np.abs(answer - other).max(initial=0.0) > np.sqrt(_ROUNDING) * size for other in kept):
            kept.append(answer)
    return kept
