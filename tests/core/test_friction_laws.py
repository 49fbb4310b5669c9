"""Laws that every problem with friction obeys, on arbitrary ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from modelgen.runtime.compiled_lcp import solve_qp
from modelgen.runtime.friction import FrictionProblem, Motion, Outcome, coulomb, relaxation, residual
from tests.core.frictional import feasible, mild, natural_map, with_bilateral

laws = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
seeds = st.integers(10_000, 2**32 - 1)
ENOUGH = 1e-9


def solved(problem: FrictionProblem, core: Any) -> Any:
    """The answer; how often there is none is counted in test_friction_study."""
    answer = coulomb(problem, core)
    assume(answer.outcome is not Outcome.NOT_FOUND)
    assert answer.outcome is Outcome.SOLVED
    assert natural_map(problem, answer.z) <= ENOUGH
    return answer


def turned(problem: FrictionProblem, angle: float) -> tuple[FrictionProblem, np.ndarray]:
    """The same with t1, t2 of every contact turned by `angle`, and the turn of its rows."""
    turn = np.eye(problem.n)
    c, s = np.cos(angle), np.sin(angle)
    for row, rows in zip(problem.first, problem.rows, strict=True):
        for at in (row + 1, row + 4)[: int(rows) // 3]:
            turn[at : at + 2, at : at + 2] = [[c, s], [-s, c]]
    return replace(problem, A=turn @ problem.A @ turn.T, b=turn @ problem.b), turn


@laws
@given(seeds)
def test_the_certificate_is_the_one_of_its_definition(lcp: Any, seed: int) -> None:
    problem, rng = feasible(seed, 6), np.random.default_rng(seed)
    z = rng.normal(size=problem.n) * (problem.cone[:, :1] > 0).repeat(3, axis=1).ravel()
    for law, relaxed in (("coulomb", False), ("relaxed", True)):
        assert residual(problem, z, lcp, law) == pytest.approx(natural_map(problem, z, relaxed), rel=1e-9)


@laws
@given(seeds, st.floats(-6, 6), st.floats(-6, 6))
def test_units_change_neither_the_certificate_nor_the_answer(lcp: Any, seed: int, a: float, b: float) -> None:
    problem, (p, q) = feasible(seed, 6), (10.0**a, 10.0**b)
    scaled = replace(problem, A=p * problem.A, b=q * problem.b)
    answer, other = solved(problem, lcp), solved(scaled, lcp)
    z = np.random.default_rng(seed).normal(size=problem.n) * (np.abs(answer.z) > 0)
    assert residual(scaled, q / p * z, lcp) == pytest.approx(residual(problem, z, lcp), rel=1e-6)
    assert residual(scaled, q / p * answer.z, lcp) <= ENOUGH
    assert residual(problem, p / q * other.z, lcp) <= ENOUGH


@laws
@given(seeds, st.floats(0, 6.3))
def test_the_frame_of_a_contact_does_not_matter(lcp: Any, seed: int, angle: float) -> None:
    problem = feasible(seed, 6)
    other, turn = turned(problem, angle)
    answer = solved(problem, lcp)
    assert residual(other, turn @ answer.z, lcp) <= ENOUGH
    assert residual(problem, turn.T @ solved(other, lcp).z, lcp) <= ENOUGH


@laws
@given(seeds)
def test_an_answer_is_a_solution_to_start_from(lcp: Any, seed: int) -> None:
    problem = feasible(seed)
    answer = solved(problem, lcp)
    again = coulomb(problem, lcp, start=answer.z)
    assert again.outcome is Outcome.SOLVED
    assert again.iterations <= 4


def with_resistance(seed: int) -> FrictionProblem:
    """1 to 3 contacts of 6 rows on a regular A."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    J = rng.normal(size=(6 * count, 6 * count + 3))
    cone = np.hstack([rng.uniform(0.1, 1, (count, 2)), rng.uniform(0.01, 0.3, (count, 2))])
    return FrictionProblem.of(J @ J.T, J @ rng.normal(size=6 * count + 3), cone, rows=6)


@pytest.mark.parametrize("make", [mild, with_resistance])
def test_an_answer_is_good_to_rounding(lcp: Any, make: Callable[[int], FrictionProblem]) -> None:
    for problem in map(make, range(200)):
        answer = coulomb(problem, lcp)
        d = np.sqrt(np.diag(problem.A))
        growth = max(1.0, np.abs(answer.z * d).max() / np.abs(problem.b / d).max())
        assert answer.outcome is Outcome.SOLVED
        assert natural_map(problem, answer.z) <= 4 * problem.n * np.finfo(float).eps * growth


@laws
@given(seeds)
def test_friction_never_gains_energy(lcp: Any, seed: int) -> None:
    """N >= 0 and f.w_t = -N |mu w_t| at every contact."""
    problem = feasible(seed)
    answer = solved(problem, lcp)
    size = np.abs(problem.b / np.sqrt(np.diag(problem.A))).max() ** 2
    for contact, row in enumerate(problem.first):
        for _, rows, mu in problem.discs(contact):
            power = answer.z[rows] @ answer.w[rows]
            expected = -answer.z[row] * np.linalg.norm(mu * answer.w[rows])
            growth = 1 + np.abs(answer.z * np.sqrt(np.diag(problem.A))).max() / np.sqrt(size)
            assert abs(power - expected) <= 1e-7 * size * growth


@laws
@given(seeds)
def test_motions_are_named_as_they_are(lcp: Any, seed: int) -> None:
    problem = feasible(seed)
    answer = solved(problem, lcp)
    d = np.sqrt(np.diag(problem.A))
    size = 1e-6 * np.abs(problem.b / d).max() * (1 + np.abs(answer.z * d).max() / np.abs(problem.b / d).max())
    for contact, seen in enumerate(answer.motions):
        row = problem.first[contact]
        if not seen:
            assert np.abs(answer.z[row : row + 3] * d[row]).max() <= size
        elif seen == Motion.PRESSES and problem.cone[contact, 0] > 0:
            assert np.abs(answer.w[row : row + 3] / d[row : row + 3]).max() <= size


@laws
@given(seeds)
def test_without_friction_it_is_the_frictionless_step(lcp: Any, seed: int) -> None:
    problem = feasible(seed, 8)
    smooth = replace(problem, cone=np.zeros_like(problem.cone))
    expected = solve_qp(problem.A[::3, ::3], problem.b[::3], lcp)
    answer = coulomb(smooth, lcp)
    assert answer.outcome.name == expected.outcome.name
    if expected.outcome.name == "SOLVED":
        size = np.abs(problem.b[::3]).max() * (1 + np.abs(expected.z * np.diag(problem.A)[::3]).max())
        assert np.abs(answer.w[::3] - expected.w).max() <= 1e-6 * size


@laws
@given(seeds, st.integers(1, 4))
def test_bilateral_rows_hold(lcp: Any, seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    problem = with_bilateral(feasible(seed, 5), rng, count)
    answer = solved(problem, lcp)
    assert np.abs(answer.w[-count:]).max() <= 1e-9 * (np.abs(problem.A[-count:]) @ np.abs(answer.z)).max()


@pytest.mark.parametrize("b", [-1.0, 1.0])
def test_a_contact_that_bilateral_rows_hold_can_only_be_free(lcp: Any, b: float) -> None:
    J = np.random.default_rng(3).normal(size=(6, 3))
    problem = FrictionProblem.of(J @ J.T, [b, 0.3, 0.2, 0, 0, 0], [0.5])
    assert coulomb(problem, lcp).outcome is (Outcome.SOLVED if b > 0 else Outcome.INFEASIBLE)


@laws
@given(seeds, st.floats(0.05, 2), st.floats(0.05, 2))
def test_elliptic_cones_are_solved(lcp: Any, seed: int, mu_1: float, mu_2: float) -> None:
    problem = feasible(seed, 5)
    solved(replace(problem, cone=np.tile([mu_1, mu_2, 0, 0], (len(problem.first), 1))), lcp)


@laws
@given(seeds, st.integers(1, 4), *[st.sampled_from((0.0, 1e-6, 0.01, 0.1, 0.5, 1.0))] * 3)
def test_spinning_and_rolling_resistance_are_solved(
    lcp: Any, seed: int, contacts: int, mu: float, spin: float, roll: float
) -> None:
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(6 * contacts, 6 * contacts + 3))
    cone = np.tile([mu, mu, spin, roll], (contacts, 1))
    problem = FrictionProblem.of(J @ J.T, J @ rng.normal(size=J.shape[1]), cone, rows=6)
    solved(problem, lcp)
    relaxed = relaxation(problem, lcp)
    assert relaxed.outcome is Outcome.SOLVED
    assert natural_map(problem, relaxed.z, relaxed=True) <= ENOUGH


@laws
@given(seeds)
def test_the_relaxation_is_the_least_of_the_convex_program(lcp: Any, seed: int) -> None:
    """No other forces in the cones have less z'Az/2 + b'z."""
    problem, rng = feasible(seed, 6), np.random.default_rng(seed)
    answer = relaxation(problem, lcp)
    if answer.outcome is not Outcome.SOLVED:
        return
    assert natural_map(problem, answer.z, relaxed=True) <= ENOUGH

    def energy(z: np.ndarray) -> float:
        return float(z @ problem.A @ z / 2 + problem.b @ z)

    least = energy(answer.z)
    for _ in range(20):
        other = answer.z + rng.normal(size=problem.n) * np.abs(answer.z).max() * 10 ** rng.uniform(-4, 0)
        other[::3] = np.maximum(other[::3], 0)
        f = other.reshape(-1, 3)[:, 1:]
        size = np.linalg.norm(f, axis=1)
        bound = problem.cone[:, 0] * other[::3]
        f *= np.minimum(1, bound / np.where(size > 0, size, 1))[:, None]
        assert energy(other) >= least - 1e-9 * (abs(least) + 1)


@pytest.mark.cases(1)
@pytest.mark.parametrize("real", ["float", "long double"])
def test_every_real_type_solves_to_its_own_accuracy(real: str, lcp_in: Any) -> None:
    core, limit = lcp_in(real), {"float": 1e-3, "long double": 1e-12}[real]
    for seed in range(30):
        rng = np.random.default_rng(seed)
        J = rng.normal(size=(9, 15))
        answer = coulomb(FrictionProblem.of(J @ J.T, J @ rng.normal(size=15), [0.1, 0.4, 0.8]), core)
        assert answer.outcome is Outcome.SOLVED
        assert answer.residual <= limit
