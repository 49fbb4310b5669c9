"""Published problems: the collection of Siconos (textbook and Drake cases), Murty's and Fathi's families."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen.runtime.compiled_lcp import Outcome, solve_lcp, solve_qp

CASES: dict[str, dict[str, Any]] = json.loads(
    (Path(__file__).parent / "data" / "lcp_siconos.json").read_text()
)
SOLVABLE = [name for name, case in CASES.items() if case["solutions"] != []]
SMALL = [name for name in SOLVABLE if len(CASES[name]["b"]) <= 9]


def natural_map(case: dict[str, Any], z: np.ndarray) -> float:
    A, b = np.array(case["A"]), np.array(case["b"])
    return float(np.abs(np.minimum(z, A @ z + b)).max() / max(1.0, np.abs(b).max()))


def assert_listed(case: dict[str, Any], z: np.ndarray) -> None:
    assert natural_map(case, z) <= 1e-9
    if case["unique"] and case["solutions"]:
        nearest = min(np.abs(z - np.array(s)).max() / np.abs(s).max() for s in case["solutions"])
        assert nearest <= 1e-9


@pytest.mark.cases(8)
@pytest.mark.parametrize("name", SOLVABLE)
def test_a_listed_solution_is_found(name: str, lcp: Any) -> None:
    case = CASES[name]
    answer = solve_lcp(case["A"], case["b"], lcp)
    assert answer.outcome is Outcome.SOLVED
    assert_listed(case, answer.z)


@pytest.mark.parametrize("name", [n for n in SOLVABLE if CASES[n]["symmetric"] and CASES[n]["semidefinite"]])
def test_symmetric_semidefinite_ones_are_solved_by_the_qp(name: str, lcp: Any) -> None:
    answer = solve_qp(CASES[name]["A"], CASES[name]["b"], lcp)
    assert answer.outcome is Outcome.SOLVED
    assert_listed(CASES[name], answer.z)


@pytest.mark.parametrize("name", SMALL)
def test_enumeration_solves_every_small_one(name: str, lcp: Any) -> None:
    answer = solve_lcp(CASES[name]["A"], CASES[name]["b"], lcp, method="enumerate")
    assert answer.outcome is Outcome.SOLVED
    assert_listed(CASES[name], answer.z)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("method", ["qp", "lemke", "enumerate"])
def test_no_method_claims_a_solution_that_is_none(name: str, method: Any, lcp: Any) -> None:
    """The QP is given matrices that are not its own here; the certificate must see it."""
    case = CASES[name]
    answer = solve_lcp(case["A"], case["b"], lcp, method=method)
    assert answer.outcome is not Outcome.SOLVED or natural_map(case, answer.z) <= 1e-9


def test_the_perturbed_problem_of_pang_has_no_solution(lcp: Any) -> None:
    case = CASES["Pang_isolated_sol_perturbed"]
    assert solve_lcp(case["A"], case["b"], lcp).outcome is Outcome.INFEASIBLE
    assert solve_lcp(case["A"], case["b"], lcp, method="lemke").outcome is Outcome.RAY


def test_lemke_reports_the_ray_that_enumeration_gets_past(lcp: Any) -> None:
    case = CASES["CPS_3"]
    assert solve_lcp(case["A"], case["b"], lcp, method="lemke").outcome is Outcome.RAY
    assert_listed(case, solve_lcp(case["A"], case["b"], lcp).z)


def test_of_a_segment_of_solutions_the_least_norm_is_returned(lcp: Any) -> None:
    answer = solve_qp(CASES["CPS_1"]["A"], CASES["CPS_1"]["b"], lcp)
    np.testing.assert_allclose(answer.z, [0.5, 0.5], rtol=1e-15)
    assert answer.rank == 1


def murty(n: int) -> np.ndarray:
    return np.triu(np.full((n, n), 2.0), 1) + np.eye(n)


@pytest.mark.parametrize("n", [4, 8, 12, 16, 32])
def test_families_that_are_exponential_for_a_fixed_rule_of_pivots(n: int, lcp: Any) -> None:
    """Murty, Linear Complementarity, chapter 6; Fathi, Math. Programming 17 (1979)."""
    M, i = murty(n), np.arange(1, n + 1)
    tolerance = 1e-8 if n <= 16 else 1e-6
    for A, b, z in (
        (M, -np.ones(n), np.eye(n)[-1]),
        (M, -(2.0 ** (n + 1) - 2.0**i), 2.0**n * np.eye(n)[-1]),
        (M.T @ M, -np.ones(n), np.eye(n)[0]),
    ):
        answer = solve_lcp(A, b, lcp)
        assert answer.outcome is Outcome.SOLVED
        assert np.abs(answer.z - z).max() <= tolerance * z.max()
