"""What cannot be solved is not called solved; what is not unique is called so; what is unique is proved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from modelgen.errors import SimulationError
from modelgen.runtime.friction import (
    FrictionProblem,
    Motion,
    Outcome,
    Paradox,
    coulomb,
    relaxation,
    residual,
    sliding,
    solver,
)
from tests.core.frictional import feasible, impossible, mild, natural_map, stack

laws = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
seeds = st.integers(10_000, 2**32 - 1)


def rod(mu: float, angle: float, push: float) -> FrictionProblem:
    """A uniform rod of mass 1 and length 2 that touches the ground with one end, leaning by `angle`.

    `push` is b_n, t1 along the ground; the moment of inertia is 1/3 (F. Genot, B. Brogliato, Eur. J. Mech. A
    18 (1999), 653-677).
    """
    s, c = np.sin(angle), np.cos(angle)
    A = np.eye(3) + 3 * np.array([[c * c, c * s, 0], [c * s, s * s, 0], [0, 0, 0]])
    return FrictionProblem.of(A, [push, 0, 0], [mu])


ANGLE = 1.1
CRITICAL = (1 + 3 * np.cos(ANGLE) ** 2) / (3 * np.sin(ANGLE) * np.cos(ANGLE))


@pytest.mark.parametrize(
    ("mu", "push", "paradox"),
    [
        (0.9 * CRITICAL, -1.0, Paradox.NONE),
        (0.9 * CRITICAL, 1.0, Paradox.NONE),
        (1.1 * CRITICAL, -1.0, Paradox.INCONSISTENT),
        (1.1 * CRITICAL, 1.0, Paradox.INDETERMINATE),
    ],
)
def test_painleve_rod(mu: float, push: float, paradox: Paradox) -> None:
    """A_nn - mu A_nt changes its sign at the critical mu; pushing then has no answer, pulling two."""
    answer = sliding(rod(mu, ANGLE, push), [[1.0, 0.0]])
    assert answer.paradox is paradox
    assert len(answer.normal_forces) == {Paradox.NONE: 1, Paradox.INCONSISTENT: 0}.get(paradox, 2)


def test_the_core_proves_the_inconsistent_rod_to_have_no_solution(lcp: Any) -> None:
    """The same with the sliding force put into the one column of A."""
    problem = rod(1.1 * CRITICAL, ANGLE, -1.0)
    slope = problem.A[0, 0] - 1.1 * CRITICAL * problem.A[0, 1]
    assert coulomb(FrictionProblem.of([[slope]], [-1.0], [0.0], rows=1), lcp).outcome is Outcome.INFEASIBLE
    assert coulomb(FrictionProblem.of([[-slope]], [-1.0], [0.0], rows=1), lcp).outcome is Outcome.SOLVED


def test_in_impulses_the_inconsistent_rod_has_a_solution(lcp: Any) -> None:
    """The slip may then change within the step: the rod jams (A. M. Ivanov's tangential impact)."""
    problem = rod(1.1 * CRITICAL, ANGLE, -1.0)
    pushed = FrictionProblem.of(problem.A, problem.b + np.array([0, 0.1, 0]), [1.1 * CRITICAL])
    answer = coulomb(pushed, lcp)
    assert answer.outcome is Outcome.SOLVED
    assert answer.motions == (Motion.PRESSES,)


def test_every_answer_of_sliding_contacts_is_one(lcp: Any) -> None:
    """Two contacts, slip and friction at random: each listed answer is complementary."""
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(60):
        J = rng.normal(size=(6, 8))
        slip, mu = rng.normal(size=(2, 2)), rng.uniform(0, 2, 2)
        problem = FrictionProblem.of(J @ J.T, rng.normal(size=6), mu)
        answer = sliding(problem, slip)
        seen.add(answer.paradox)
        for z, w in zip(answer.normal_forces, answer.accelerations, strict=False):
            assert min(z.min(), w.min()) >= -1e-9
            assert np.abs(z * w).max() <= 1e-9
    assert Paradox.NONE in seen
    assert len(seen) > 1


def test_sliding_needs_contacts_of_three_rows() -> None:
    with pytest.raises(SimulationError, match="3 rows"):
        sliding(FrictionProblem.of(np.eye(1), [1.0], [0.0], rows=1), [[0.0, 0.0]])


@laws
@given(seeds)
def test_no_solver_claims_what_does_not_exist(lcp: Any, seed: int) -> None:
    problem = impossible(seed)
    assert coulomb(problem, lcp).outcome is not Outcome.SOLVED
    assert relaxation(problem, lcp).outcome is not Outcome.SOLVED
    assert solver("polyhedral")(problem, lcp).outcome is not Outcome.SOLVED


@laws
@given(seeds)
def test_what_is_called_solved_has_the_certificate(lcp: Any, seed: int) -> None:
    """Data of no physics at all: A of any signs and not symmetric."""
    rng = np.random.default_rng(seed)
    n = 3 * int(rng.integers(1, 6))
    problem = FrictionProblem.of(rng.normal(size=(n, n)), rng.normal(size=n), rng.uniform(0, 2, n // 3))
    answer = coulomb(problem, lcp)
    assert answer.outcome is not Outcome.INFEASIBLE
    if answer.outcome is Outcome.SOLVED:
        assert residual(problem, answer.z, lcp) <= 1e-9


@pytest.mark.slow
def test_fewer_starts_find_less_and_are_no_less_honest(lcp: Any) -> None:
    solved = {}
    for starts in (1, 2, 0):
        answers = [(p, coulomb(p, lcp, starts=starts)) for p in map(feasible, range(200))]
        solved[starts] = [(p, answer.z) for p, answer in answers if answer.outcome is Outcome.SOLVED]
    assert 180 <= len(solved[1]) < len(solved[2]) <= len(solved[0])
    assert max(natural_map(p, z) for p, z in solved[1]) <= 1e-9


@pytest.mark.slow
def test_the_relaxation_is_decided(lcp: Any) -> None:
    """Its program can be infeasible where Coulomb's law has a solution; then that is proved."""
    outcomes = [relaxation(feasible(seed), lcp).outcome for seed in range(150)]
    assert outcomes.count(Outcome.NOT_FOUND) <= 2
    assert outcomes.count(Outcome.INFEASIBLE) >= 10


@laws
@given(seeds)
def test_the_relaxation_has_the_motion_of_coulombs_law_where_nothing_slips(lcp: Any, seed: int) -> None:
    """And what opens does so faster than mu |w_t|."""
    problem = mild(seed)
    problem = replace(problem, b=problem.b - np.tile([np.abs(problem.b).max(), 0, 0], len(problem.first)))
    problem = replace(problem, cone=problem.cone + np.array([[2, 2, 0, 0]]))
    exact, relaxed = coulomb(problem, lcp), relaxation(problem, lcp)
    assume(set(exact.motions) == {Motion.PRESSES})
    assert relaxed.outcome is Outcome.SOLVED
    np.testing.assert_allclose(relaxed.w, exact.w, rtol=0, atol=1e-7 * np.abs(problem.b).max())


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e308])
@pytest.mark.parametrize("place", ["A", "b"])
def test_data_out_of_range_are_named(bad: float, place: str, lcp: Any) -> None:
    A, b = np.eye(6), -np.ones(6)
    (A[0] if place == "A" else b)[1] = bad
    answer = coulomb(FrictionProblem.of(A, b, [0.5, 0.5]), lcp)
    assert (
        answer.outcome is not Outcome.SOLVED
        or natural_map(FrictionProblem.of(A, b, [0.5, 0.5]), answer.z) <= 1e-9
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"A": np.eye(5), "b": np.ones(6), "friction": [0.5]}, "shape"),
        ({"A": np.eye(6), "b": np.ones(6), "friction": [0.5, -0.1]}, "contact 1"),
        ({"A": np.eye(6), "b": np.ones(6), "friction": [0.5], "first": [4]}, "row 4"),
        ({"A": np.eye(6), "b": np.ones(6), "friction": [0.5, 0.5], "first": [0, 2]}, "row 2"),
        ({"A": np.eye(6), "b": np.ones(6), "friction": [[0.5] * 3]}, "friction of shape"),
        ({"A": np.eye(2), "b": np.ones(2), "friction": [0.5], "rows": 2}, "2 rows"),
    ],
)
def test_a_record_that_does_not_fit_is_refused(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(SimulationError, match=words):
        FrictionProblem.of(**arguments)


def test_an_unknown_solver_is_refused_with_the_known() -> None:
    with pytest.raises(SimulationError, match="coulomb, relaxation, polyhedral, mpcc"):
        solver("exact")  # type: ignore[arg-type]


def test_forces_under_four_feet_are_called_not_unique(lcp: Any) -> None:
    """12 rows, 6 ways to move: the forces are not determined, the motion is."""
    answer = coulomb(stack(1, 0.5), lcp)
    assert answer.outcome is Outcome.SOLVED
    assert (answer.rank, answer.active, answer.unique) == (6, 12, False)
    assert np.abs(answer.w).max() <= 1e-9


def test_of_forces_that_are_not_unique_the_even_ones_are_returned(lcp: Any) -> None:
    np.testing.assert_allclose(coulomb(stack(1, 0.5), lcp).z, np.tile([1 / 4, 0, 0], 4), atol=1e-9)


def test_forces_that_are_called_not_unique_can_be_changed(lcp: Any) -> None:
    problem = stack(1, 0.5)
    answer = coulomb(problem, lcp)
    null = np.linalg.svd(problem.A)[2][6:]
    for change in null:
        assert natural_map(problem, answer.z + 0.01 * change) <= 1e-9


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("boxes", [2, 5, 10])
def test_a_stack_rests_with_the_weight_above_on_every_level(boxes: int, ratio: float, lcp: Any) -> None:
    """Six ways to move a box, twelve rows below it."""
    answer = coulomb(stack(boxes, 0.5, ratio), lcp)
    mass = ratio ** (np.arange(boxes) / (boxes - 1))
    assert answer.outcome is Outcome.SOLVED
    assert (answer.rank, answer.active) == (6 * boxes, 12 * boxes)
    carried = answer.z[::3].reshape(boxes, 4).sum(axis=1)
    np.testing.assert_allclose(carried, mass[::-1].cumsum()[::-1], rtol=1e-6)


@laws
@given(seeds)
def test_what_is_called_unique_is_found_from_every_start(lcp: Any, seed: int) -> None:
    problem, rng = mild(seed), np.random.default_rng(seed)
    answer = coulomb(problem, lcp)
    assume(answer.unique)
    for _ in range(5):
        other = coulomb(problem, lcp, start=rng.normal(size=problem.n) * 10 * np.abs(answer.z).max())
        np.testing.assert_allclose(other.z, answer.z, rtol=0, atol=1e-8 * np.abs(answer.z).max())


def test_strong_friction_that_has_two_answers_is_not_called_unique(lcp: Any) -> None:
    """A rod beyond the critical coefficient that is pulled and starts to slide: it may lift or jam."""
    problem = rod(1.5 * CRITICAL, ANGLE, 0.1)
    problem = FrictionProblem.of(problem.A, problem.b + np.array([0, 1.0, 0]), [1.5 * CRITICAL])
    free, jammed = coulomb(problem, lcp), coulomb(problem, lcp, start=-np.linalg.solve(problem.A, problem.b))
    assert free.outcome is jammed.outcome is Outcome.SOLVED
    assert free.unique is not True
    assert jammed.unique is not True


@laws
@given(seeds)
def test_uniqueness_is_claimed_of_no_deficient_matrix(lcp: Any, seed: int) -> None:
    problem = feasible(seed)
    answer = coulomb(problem, lcp)
    if answer.unique:
        assert np.linalg.matrix_rank(problem.A[::3, ::3]) == len(problem.first)
