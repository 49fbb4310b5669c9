"""Laws that every complementarity problem obeys, on arbitrary ones."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from modelgen.runtime.compiled_lcp import Outcome, solve_lcp, solve_qp

laws = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@st.composite
def problems(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """A = J J' of any rank, b in its range: feasible."""
    n, rank = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    J = rng.normal(size=(n, rank))
    return J @ J.T, J @ rng.normal(size=rank)


def assert_same_forces(z: np.ndarray, expected: np.ndarray, A: np.ndarray) -> None:
    d = np.sqrt(np.diag(A))
    assert np.linalg.norm(d * (z - expected)) <= 1e-6 * np.linalg.norm(d * expected)


@laws
@given(problems(), st.randoms(use_true_random=False))
def test_the_order_of_contacts_does_not_matter(lcp: Any, problem: Any, random: Any) -> None:
    A, b = problem
    order = random.sample(range(len(b)), len(b))
    shuffled = solve_qp(A[np.ix_(order, order)], b[order], lcp)
    assert_same_forces(shuffled.z, solve_qp(A, b, lcp).z[order], A[np.ix_(order, order)])


@laws
@given(problems(), st.floats(-150, 150))
def test_a_common_factor_changes_nothing(lcp: Any, problem: Any, exponent: float) -> None:
    A, b = problem
    s = 10.0**exponent
    scaled = solve_qp(s * A, s * b, lcp)
    assert scaled.outcome is Outcome.SOLVED
    assert_same_forces(scaled.z, solve_qp(A, b, lcp).z, A)


@laws
@given(problems(), st.integers(0, 2**32 - 1))
def test_units_of_the_contacts_carry_through(lcp: Any, problem: Any, seed: int) -> None:
    """A -> E A E, b -> E b gives E^-1 z, E positive diagonal over eight decades: the norm scales along."""
    A, b = problem
    e = 10 ** np.random.default_rng(seed).uniform(-4, 4, len(b))
    scaled = solve_qp(A * e[:, None] * e, b * e, lcp)
    assert scaled.outcome is Outcome.SOLVED
    assert_same_forces(scaled.z * e, solve_qp(A, b, lcp).z, A)


@laws
@given(problems(), st.integers(0, 2**9 - 1))
def test_where_the_search_starts_does_not_matter(lcp: Any, problem: Any, start: int) -> None:
    A, b = problem
    cold = solve_qp(A, b, lcp)
    warm = solve_qp(A, b, lcp, active=[start >> i & 1 for i in range(len(b))])
    assert warm.outcome is cold.outcome is Outcome.SOLVED
    assert_same_forces(warm.z, cold.z, A)


@laws
@given(problems())
def test_the_answer_is_a_fixed_point_of_its_own_start(lcp: Any, problem: Any) -> None:
    A, b = problem
    first = solve_qp(A, b, lcp)
    again = solve_qp(A, b, lcp, active=first.active)
    np.testing.assert_array_equal(again.active, first.active)
    assert again.iterations <= first.iterations


def has_solution(A: np.ndarray, b: np.ndarray) -> bool:
    """By linear programming on each of the 2^n faces."""
    n = len(b)
    for face in product([False, True], repeat=n):
        z_on = np.array(face)
        bounds = [(0, None if on else 0) for on in z_on]
        equal, above = A[z_on], A[~z_on]
        found = linprog(
            np.zeros(n),
            A_ub=-above if above.size else None,
            b_ub=b[~z_on] if above.size else None,
            A_eq=equal if equal.size else None,
            b_eq=-b[z_on] if equal.size else None,
            bounds=bounds,
        )
        if found.status == 0:
            return True
    return False


@pytest.mark.parametrize("seed", range(40))
def test_small_integer_problems_are_decided_as_by_linear_programming(seed: int, lcp: Any) -> None:
    """Degenerate and singular on purpose: entries from -2 to 2."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    A, b = rng.integers(-2, 3, (n, n)).astype(float), rng.integers(-2, 2, n).astype(float)
    expected = Outcome.SOLVED if has_solution(A, b) else Outcome.INFEASIBLE
    assert solve_lcp(A, b, lcp, method="enumerate").outcome is expected
    assert solve_lcp(A, b, lcp).outcome is expected
    if expected is Outcome.INFEASIBLE:
        assert solve_lcp(A, b, lcp, method="lemke").outcome is not Outcome.SOLVED


def test_a_solution_that_only_singular_bases_hold_is_found(lcp: Any) -> None:
    """z = (t, 0), t >= 1: the diagonal entry and the determinant of A are 0."""
    A, b = np.array([[0.0, 0.0], [1.0, -1.0]]), np.array([0.0, -1.0])
    answer = solve_lcp(A, b, lcp, method="enumerate")
    assert answer.outcome is Outcome.SOLVED
    assert answer.z[0] >= 1 - 1e-9
    assert answer.z[1] == 0


@pytest.mark.parametrize("n", [3, 6, 10])
def test_matrices_with_a_unique_solution_are_solved_by_every_method(n: int, lcp: Any) -> None:
    """M = B + S - S', B definite: M is a P-matrix, so each b has one solution."""
    rng = np.random.default_rng(n)
    for _ in range(20):
        B, S = rng.normal(size=(n, n + 1)), rng.normal(size=(n, n))
        M, b = B @ B.T + S - S.T, rng.normal(size=n)
        path, listed = (solve_lcp(M, b, lcp, method=method) for method in ("lemke", "enumerate"))
        assert path.outcome is listed.outcome is Outcome.SOLVED
        np.testing.assert_allclose(path.z, listed.z, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("n", [3, 5, 8])
def test_lemke_ends_on_every_feasible_monotone_problem_however_degenerate(n: int, lcp: Any) -> None:
    """Semidefinite plus skew, small integers: ties in every ratio test, and no ray where z, w >= 0 exist."""
    rng = np.random.default_rng(n)
    for _ in range(150):
        J, S = rng.integers(-1, 2, (n, rng.integers(1, n))), rng.integers(-1, 2, (n, n))
        A = (J @ J.T + S - S.T).astype(float)
        b = rng.integers(0, 2, n) - A @ rng.integers(0, 2, n)
        assert solve_lcp(A, b, lcp, method="lemke").outcome is Outcome.SOLVED
