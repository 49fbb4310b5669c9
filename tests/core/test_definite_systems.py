"""Forces on a known active set: small definite systems have a factorisation of their own."""

from __future__ import annotations

from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest

from tests.core.compiling import CoreBuild, active_solve

SIZES = range(1, 15)  # 12 is the largest that has its own
LEAST_PIVOTS = (1.0, 0.1, 0.011, 0.009, 1e-3)  # with pivots below 0.01 the general one is taken


def system(rng: np.random.Generator, n: int, least: float) -> tuple[np.ndarray, np.ndarray]:
    """A = D S D with unit diagonal of S, whose pivots lie between `least` and 1, and D over six decades."""
    L = np.zeros((n, n))
    for row, pivot in enumerate(least ** rng.uniform(0, 1, n)):
        along = rng.normal(size=row)
        share = 1 - pivot if row else 0.0
        L[row, :row] = along * np.sqrt(share / (along @ along)) if row else along
        L[row, row] = np.sqrt(1 - share)
    D = 10 ** rng.uniform(-3, 3, n)
    A = D[:, None] * (L @ L.T) * D
    return (A + A.T) / 2, D * rng.normal(size=n)


def solved(core: CoreBuild, A: np.ndarray, b: np.ndarray, active: np.ndarray) -> np.ndarray:
    z, rank = active_solve(core, A, b, active)
    assert rank == active.sum()
    return z


def beside_a_bystander(core: CoreBuild, A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The solution as part of a system with one more row that is not active: by the general factorisation."""
    n = len(b)
    larger = np.eye(n + 1)
    larger[:n, :n] = A
    z = solved(core, larger, np.append(b, 1.0), np.append(np.ones(n), 0))
    assert z[n] == 0
    return z[:n]


def in_50_digits(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    with mpmath.workdps(50):
        exact = mpmath.lu_solve(mpmath.matrix(A.tolist()), mpmath.matrix((-b).tolist()))
        return np.array([float(x) for x in exact])


def error(A: np.ndarray, z: np.ndarray, exact: np.ndarray) -> float:
    """Relative error over the condition of A in the scale of its diagonal."""
    d = np.sqrt(np.diag(A))
    condition = np.linalg.cond(A / d[:, None] / d)
    return float(np.linalg.norm(d * (z - exact)) / np.linalg.norm(d * exact) / condition)


@pytest.mark.cases(3)
@pytest.mark.parametrize("least", LEAST_PIVOTS)
def test_a_definite_system_is_solved_to_rounding_at_every_size(least: float, lcp: CoreBuild) -> None:
    """|D (z - z*)| <= 4 n^2 eps cond(S) |D z*|: a factorisation commits at most n (n + 1) roundings of S
    (Higham, Accuracy and Stability of Numerical Algorithms, theorem 10.4), doubled for data of rounded A."""
    rng = np.random.default_rng(3)
    for n, _ in product(SIZES, range(12)):
        A, b = system(rng, n, least)
        exact = in_50_digits(A, b)
        for z in (solved(lcp, A, b, np.ones(n)), beside_a_bystander(lcp, A, b)):
            assert error(A, z, exact) <= 4 * n**2 * np.finfo(float).eps


@pytest.mark.cases(1)
@pytest.mark.parametrize("real", ["float", "double", "long double"])
def test_the_small_factorisation_agrees_with_the_general_one_in_every_real_type(
    real: str, lcp_in: Any
) -> None:
    core = lcp_in(real)
    rng = np.random.default_rng(5)
    for n, least in product(SIZES, (1.0, 0.5)):
        A, b = system(rng, n, least)
        alone, general = solved(core, A, b, np.ones(n)), beside_a_bystander(core, A, b)
        assert error(A, alone, general) <= 8 * n**2 * np.finfo(core.dtype).eps


@pytest.mark.parametrize("n", [2, 3, 5, 12])
def test_a_singular_system_is_left_to_least_norm(n: int, lcp: CoreBuild) -> None:
    """Two equal rows share their force equally, which the small factorisation would not do."""
    rng = np.random.default_rng(n)
    A, b = system(rng, n - 1, 0.5)
    rows = [*range(n - 1), n - 2]
    twice, of_twice = A[np.ix_(rows, rows)], b[rows]
    z, rank = active_solve(lcp, twice, of_twice, np.ones(n))
    assert rank == n - 1
    assert z[-1] == pytest.approx(z[-2], rel=1e-10)
    np.testing.assert_allclose(z[: n - 1] * [*np.ones(n - 2), 2], in_50_digits(A, b), rtol=1e-8)
