"""Polyhedral friction cones: a linear complementarity problem, by Lemke's method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from modelgen.runtime import compiled_lcp
from modelgen.runtime.compiled_lcp import CoreLibrary, solve_lcp
from modelgen.runtime.friction.compiled_solvers import motion, residual
from modelgen.runtime.friction.problem import FrictionProblem, FrictionSolution, Motion, Outcome

FACETS = 8
_OUTCOMES = {
    compiled_lcp.Outcome.SOLVED: Outcome.SOLVED,
    compiled_lcp.Outcome.NOT_FINITE: Outcome.NOT_FINITE,
}


@dataclass(frozen=True)
class _Lcp:
    """z = D x, x >= 0: normal forces, then forces along the facets; a multiplier of each disc after them."""

    D: NDArray[Any]  # (n, n_x)
    normal: NDArray[np.intp]  # (n_disc,) column of N of each disc
    disc: NDArray[np.intp]  # (n_x,) disc of a column, -1 for normal forces


def polyhedral(problem: FrictionProblem, library: CoreLibrary, facets: int = FACETS) -> FrictionSolution:
    """Solves with inscribed pyramids of `facets` sides in place of the cones, by Lemke's method.

    D. E. Stewart, J. C. Trinkle, Int. J. Numer. Methods Eng. 39 (1996), 2673-2691; M. Anitescu, F. A.
    Potra, Nonlinear Dyn. 14 (1997), 231-247: a solution exists and Lemke's method finds it in velocities
    and impulses. What it loses: friction is weaker by up to 1 - cos(pi/facets) between the corners and
    points along the facets' corners instead of against the slip (up to pi/facets off), so that turning t1,
    t2 changes the answer, and a slip along one direction drifts towards a corner. `coulomb_residual`
    measures the error; it falls with 1/facets. The problem has 2 + facets rows a contact.

    Args:
        facets: sides of each disc, >= 3; spinning has two whatever this is.
    """
    z_of, reduced = _without_bilateral(problem)
    lcp = _columns(problem, facets)
    matrix, vector = _assemble(lcp, *reduced)
    answer = solve_lcp(matrix, vector, library, method="lemke")
    z = z_of(lcp.D @ answer.z[: lcp.D.shape[1]])
    return FrictionSolution(
        z=z,
        w=motion(problem, z),
        outcome=_OUTCOMES.get(answer.outcome, Outcome.NOT_FOUND),
        residual=answer.residual,
        coulomb_residual=residual(problem, z, library),
        approximation=f"the cone has {facets} flat sides",
        iterations=answer.iterations,
        motions=_motions(problem, lcp, answer.z),
    )


def _without_bilateral(problem: FrictionProblem) -> tuple[Any, tuple[NDArray[Any], NDArray[Any]]]:
    """The problem without bilateral rows, and a function that adds their forces to z."""
    held = problem.bilateral
    rest = np.setdiff1d(np.arange(problem.n), held)
    inverse = np.linalg.pinv(problem.A[np.ix_(held, held)], hermitian=True)
    gain, offset = -inverse @ problem.A[np.ix_(held, rest)], -inverse @ problem.b[held]
    A, b = np.zeros_like(problem.A), np.zeros_like(problem.b)
    A[np.ix_(rest, rest)] = problem.A[np.ix_(rest, rest)] + problem.A[np.ix_(rest, held)] @ gain
    b[rest] = problem.b[rest] + problem.A[np.ix_(rest, held)] @ offset

    def complete(z: NDArray[Any]) -> NDArray[Any]:
        whole = z.copy()
        whole[held] = gain @ z[rest] + offset
        return whole

    return complete, (A, b)


def _columns(problem: FrictionProblem, facets: int) -> _Lcp:
    count = len(problem.first)
    columns = [np.eye(problem.n)[:, row] for row in problem.first]
    disc, normal = [-1] * count, list[int]()
    for contact in range(count):
        for _, rows, mu in problem.discs(contact):
            for direction in _corners(len(rows), facets):
                column = np.zeros(problem.n)
                column[rows] = mu * direction
                columns.append(column)
                disc.append(len(normal))
            normal.append(contact)
    D = np.array(columns).T if columns else np.zeros((problem.n, 0))
    return _Lcp(D, np.array(normal, dtype=np.intp), np.array(disc, dtype=np.intp))


def _corners(axes: int, facets: int) -> NDArray[Any]:
    if axes == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * np.arange(facets) / facets
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _assemble(lcp: _Lcp, A: NDArray[Any], b: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """[D'A D  E; N - E'  0]: no facet slides faster than its disc's multiplier, 0 within the cone."""
    size, discs = lcp.D.shape[1], len(lcp.normal)
    E = np.zeros((size, discs))
    N = np.zeros((discs, size))
    for column in np.flatnonzero(lcp.disc >= 0):
        E[column, lcp.disc[column]] = 1
    N[np.arange(discs), lcp.normal] = 1
    matrix = np.block([[lcp.D.T @ A @ lcp.D, E], [N - E.T, np.zeros((discs, discs))]])
    return matrix, np.concatenate([lcp.D.T @ b, np.zeros(discs)])


def _motions(problem: FrictionProblem, lcp: _Lcp, x: NDArray[Any]) -> tuple[Motion, ...]:
    multipliers = x[lcp.D.shape[1] :]
    motions = [Motion.PRESSES if x[contact] > 0 else Motion.OPEN for contact in range(len(problem.first))]
    marks = [mark for contact in range(len(motions)) for mark, _, _ in problem.discs(contact)]
    for mark, contact, speed in zip(marks, lcp.normal, multipliers, strict=True):
        if speed > 0 and motions[contact]:
            motions[contact] |= mark
    return tuple(motions)
