"""The contact QP on random families against qpOASES, and at its borders."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np
import pytest

from modelgen.errors import SimulationError
from modelgen.runtime.compiled_lcp import Outcome, solve_lcp, solve_qp
from modelgen.runtime.qp_reference import reference_qp
from tests.core.compiling import active_solve

Problem = tuple[np.ndarray, np.ndarray]
SIZES = (1, 2, 3, 4, 7, 12)


def gram(J: np.ndarray, masses: np.ndarray, acceleration: np.ndarray) -> Problem:
    return J @ np.diag(1 / masses) @ J.T, J @ acceleration


def definite(rng: np.random.Generator, n: int) -> Problem:
    return gram(rng.normal(size=(n, n + 2)), np.ones(n + 2), rng.normal(size=n + 2))


def redundant(rng: np.random.Generator, n: int) -> Problem:
    r = max(1, n // 2)
    return gram(rng.normal(size=(n, r)), 10 ** rng.uniform(-1, 1, r), rng.normal(size=r))


def mass_ratio(rng: np.random.Generator, n: int) -> Problem:
    r = 3 * n // 2 + 1
    return gram(rng.normal(size=(n, r)), 10 ** rng.uniform(-3, 3, r), rng.normal(size=r))


def redundant_mass_ratio(rng: np.random.Generator, n: int) -> Problem:
    r = (n + 1) // 2
    return gram(rng.normal(size=(n, r)), 10 ** rng.uniform(-3, 3, r), rng.normal(size=r))


def pile(rng: np.random.Generator, n: int) -> Problem:
    """n bodies on top of each other, masses from 1e-3 to 1e3."""
    return gram(np.eye(n) - np.eye(n, k=-1), 10 ** rng.uniform(-3, 3, n), rng.normal(size=n) - 9.81)


def many_legs(rng: np.random.Generator, n: int) -> Problem:
    """One rigid table on n legs."""
    J = np.column_stack([np.ones(n), rng.normal(size=(n, 2))])
    return gram(J, np.array([1.0, 0.3, 2.0]), np.array([-9.81, *rng.normal(size=2)]))


def repeated(rng: np.random.Generator, n: int) -> Problem:
    A, b = definite(rng, max(1, n // 3))
    rows = rng.integers(0, len(b), n)
    return A[np.ix_(rows, rows)], b[rows]


FAMILIES = (definite, redundant, mass_ratio, redundant_mass_ratio, pile, many_legs, repeated)
Family = Callable[[np.random.Generator, int], Problem]


def scales(A: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, float]:
    d = np.sqrt(np.diag(A))
    return d, float(np.abs(b / d).max())


@pytest.mark.parametrize("family", FAMILIES)
def test_every_feasible_problem_is_solved(family: Family, lcp: Any) -> None:
    """b in the range of A, so that a solution exists; certified anew here."""
    rng = np.random.default_rng(7)
    for n, _ in product(SIZES, range(80)):
        A, b = family(rng, n)
        answer = solve_qp(A, b, lcp)
        d, scale = scales(A, b)
        assert answer.outcome is Outcome.SOLVED
        assert (answer.z >= 0).all()
        residual = np.abs(np.minimum(answer.z * d, (A @ answer.z + b) / d)).max()
        assert residual <= 1e-9 * scale
        assert answer.residual == pytest.approx(residual / scale, abs=1e-10)


@pytest.mark.parametrize("family", [definite, redundant, many_legs, repeated])
def test_accelerations_and_least_forces_agree_with_qpoases(family: Family, lcp: Any) -> None:
    rng = np.random.default_rng(11)
    for n, _ in product(SIZES, range(6)):
        A, b = family(rng, n)
        answer, other = solve_qp(A, b, lcp), reference_qp(A, b)
        d, scale = scales(A, b)
        assert np.abs((answer.w - other.w) / d).max() <= 1e-9 * scale
        size = np.linalg.norm(d * other.z)
        assert np.linalg.norm(d * (answer.z - other.z)) <= 1e-6 * max(size, scale)


@pytest.mark.parametrize("family", FAMILIES)
def test_no_solution_known_to_qpoases_has_less_norm(family: Family, lcp: Any) -> None:
    rng = np.random.default_rng(13)
    for n, _ in product(SIZES, range(4)):
        A, b = family(rng, n)
        answer, other = solve_qp(A, b, lcp), reference_qp(A, b)
        d, scale = scales(A, b)
        assert np.linalg.norm(d * answer.z) <= np.linalg.norm(d * other.z) * (1 + 1e-6) + 1e-9 * scale


@pytest.mark.parametrize("n", [2, 3, 6, 10])
def test_feasible_or_not_as_qpoases_finds(n: int, lcp: Any) -> None:
    """Rank n/2 and any b: about half of them have no solution."""
    rng, seen = np.random.default_rng(n), set()
    for _ in range(25):
        J = rng.normal(size=(n, max(1, n // 2)))
        A, b = J @ J.T, rng.normal(size=n)
        answer, other = solve_qp(A, b, lcp), reference_qp(A, b)
        feasible = other.outcome is Outcome.SOLVED and other.residual < 1e-7
        assert answer.outcome is (Outcome.SOLVED if feasible else Outcome.INFEASIBLE)
        seen.add(answer.outcome)
    assert len(seen) == 2


@pytest.mark.cases(8)
@pytest.mark.parametrize("misfit", [0.0, *10.0 ** np.arange(-16, 0)])
def test_rows_that_repeat_each_other_may_disagree_by_any_amount(misfit: float, lcp: Any) -> None:
    """Of equal rows the one with the least b decides: these rows alone give all accelerations."""
    rng = np.random.default_rng(17)
    for n, copies in product((1, 2, 3, 5), (2, 3, 4)):
        for _ in range(20):
            A, b = definite(rng, n)
            rows = np.repeat(np.arange(n), copies)
            least = b - misfit * rng.uniform(0, 1, n)
            wide = least[rows] + misfit * rng.uniform(0, 1, len(rows)) * (np.arange(len(rows)) % copies > 0)
            order = rng.permutation(len(rows))
            answer = solve_qp(A[np.ix_(rows, rows)][np.ix_(order, order)], wide[order], lcp)
            alone = solve_qp(A, least, lcp)
            expected = alone.w[rows] + wide - least[rows]
            d, scale = scales(A, least)
            assert answer.outcome is Outcome.SOLVED
            assert np.abs((answer.w - expected[order]) / d[rows][order]).max() <= 1e-9 * scale


@pytest.mark.parametrize(
    ("A", "b"),
    [
        ([[0.0]], [-1.0]),
        ([[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0]),
        ([[1.0, -1.0], [-1.0, 1.0]], [1.0, -1.001]),
        ([[2.0, 0.0], [0.0, 0.0]], [-1.0, -1e-3]),
        ([[1.0, 0.0, -1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]], [-1.0, -1.0, -1.0]),
        (np.zeros((3, 3)), [0.0, 1.0, -1.0]),
    ],
)
def test_what_no_force_can_give_is_infeasible(A: Any, b: Any, lcp: Any) -> None:
    assert solve_qp(A, b, lcp).outcome is Outcome.INFEASIBLE
    assert solve_lcp(A, b, lcp).outcome is Outcome.INFEASIBLE
    assert solve_lcp(A, b, lcp, method="enumerate").outcome is Outcome.INFEASIBLE
    assert solve_lcp(A, b, lcp, method="lemke").outcome is not Outcome.SOLVED


@pytest.mark.parametrize("gap", 10.0 ** np.arange(-7, 1))
def test_squeezed_bodies_are_infeasible_however_little(gap: float, lcp: Any) -> None:
    """A body between two walls that approach each other: b leaves the range of A by `gap`."""
    n = 4
    J = np.array([[1.0], [-1.0], [1.0], [-2.0]])
    answer = solve_qp(J @ J.T, J[:, 0] - gap * np.ones(n), lcp)
    assert answer.outcome is Outcome.INFEASIBLE


def test_rows_without_inverse_mass_stay_at_zero(lcp: Any) -> None:
    A, b = definite(np.random.default_rng(3), 4)
    wide = np.zeros((6, 6))
    wide[np.ix_([0, 2, 3, 5], [0, 2, 3, 5])] = A
    answer = solve_qp(wide, np.insert(b, [1, 3], [0.5, 0.0]), lcp)
    assert answer.outcome is Outcome.SOLVED
    np.testing.assert_allclose(answer.z[[0, 2, 3, 5]], solve_qp(A, b, lcp).z, rtol=1e-12, atol=1e-14)
    assert not answer.z[[1, 4]].any()


def test_no_contact_is_solved_by_nothing(lcp: Any) -> None:
    for method in ("auto", "qp", "lemke", "enumerate"):
        answer = solve_lcp(np.zeros((0, 0)), np.zeros(0), lcp, method=method)
        assert answer.outcome is Outcome.SOLVED
        assert answer.z.shape == (0,)


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("method", ["auto", "qp", "lemke", "enumerate"])
def test_data_that_are_no_numbers_are_reported(n: int, bad: float, method: Any, lcp: Any) -> None:
    A, b = np.eye(n), -np.ones(n)
    broken = A.copy()
    broken[n - 1, 0] = bad
    assert solve_lcp(broken, b, lcp, method=method).outcome is Outcome.NOT_FINITE
    assert solve_lcp(A, [*b[1:], bad], lcp, method=method).outcome is Outcome.NOT_FINITE


def test_shapes_that_do_not_fit_are_refused(lcp: Any) -> None:
    with pytest.raises(SimulationError, match=r"\(2, 3\)"):
        solve_qp(np.zeros((2, 3)), np.zeros(2), lcp)
    with pytest.raises(SimulationError, match=r"\(3,\)"):
        solve_qp(np.eye(2), np.zeros(2), lcp, active=[True, False, True])


def test_the_iteration_limit_is_reported_and_nothing_claimed(lcp: Any) -> None:
    A, b = redundant(np.random.default_rng(0), 30)
    answer = solve_qp(A, b, lcp, iterations=1)
    assert answer.outcome is Outcome.ITERATIONS
    assert answer.residual > 1e-9


@pytest.mark.cases(3)
@pytest.mark.parametrize(("real", "tolerance"), [("float", 1e-3), ("double", 1e-9), ("long double", 1e-12)])
@pytest.mark.parametrize("rank", [2, 5, 20])
def test_one_source_serves_every_real(
    real: str, tolerance: float, rank: int, lcp_in: Callable[[str], Any]
) -> None:
    library, rng = lcp_in(real), np.random.default_rng(5)
    for n, _ in product(SIZES, range(20)):
        J, x = (array.astype(library.dtype) for array in (rng.normal(size=(n, rank)), rng.normal(size=rank)))
        answer = solve_qp(J @ J.T, J @ x, library)
        assert answer.outcome is Outcome.SOLVED
        assert answer.residual <= tolerance
        assert answer.rank <= min(rank, n)


@pytest.mark.parametrize("family", [definite, redundant, many_legs, repeated])
def test_forces_on_a_given_set_are_the_pseudoinverse(family: Family, lcp: Any) -> None:
    rng = np.random.default_rng(17)
    for n, _ in product(SIZES, range(20)):
        A, b = family(rng, n)
        active = rng.random(n) < 0.8
        z, rank = active_solve(lcp, A, b, active)
        d, _ = scales(A, b)
        block = (A / d[:, None] / d)[np.ix_(active, active)]
        expected = np.zeros(n)
        expected[active] = -np.linalg.pinv(block, rcond=1e-11, hermitian=True) @ (b / d)[active] / d[active]
        assert np.linalg.norm(d * (z - expected)) <= 1e-8 * max(1.0, np.linalg.norm(d * expected))
        assert rank == (np.linalg.matrix_rank(block, tol=1e-11, hermitian=True) if active.any() else 0)
