"""What each solver loses, measured; and that they agree where nothing is lost."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen.runtime.friction import (
    FrictionProblem,
    Motion,
    Outcome,
    coulomb,
    polyhedral,
    relaxation,
    solver,
)
from modelgen.runtime.friction.mpcc import Conditions, minimise
from tests.core.frictional import feasible, mild

SLOPE, GRAVITY = 0.5, 9.81


def block(mu: float, speed: float = 0.0) -> FrictionProblem:
    """A point mass on a slope, one step of 1 s in velocities; t1 and the `speed` it has are downhill."""
    fall = GRAVITY * np.array([-np.cos(SLOPE), np.sin(SLOPE), 0])
    return FrictionProblem.of(np.eye(3), fall + np.array([0, speed, 0]), [mu])


@pytest.mark.parametrize("name", ["coulomb", "relaxation", "polyhedral", "mpcc"])
def test_a_block_sticks_below_the_angle_of_friction(name: Any, lcp: Any) -> None:
    answer = solver(name)(block(np.tan(SLOPE) + 0.01), lcp)
    assert answer.outcome is Outcome.SOLVED
    assert answer.motions == (Motion.PRESSES,)
    np.testing.assert_allclose(answer.w, 0, atol=1e-5)
    assert answer.coulomb_residual <= 1e-6


@pytest.mark.parametrize("name", ["coulomb", "polyhedral", "mpcc"])
def test_a_block_slips_above_it_by_the_difference(name: Any, lcp: Any) -> None:
    mu = np.tan(SLOPE) - 0.1
    answer = solver(name)(block(mu), lcp)
    expected = GRAVITY * (np.sin(SLOPE) - mu * np.cos(SLOPE))
    np.testing.assert_allclose(answer.w, [0, expected, 0], atol=1e-5)
    assert answer.motions == (Motion.PRESSES | Motion.SLIPS,)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.5])
def test_the_relaxation_lifts_what_slips_by_mu_times_its_slip(mu: float, lcp: Any) -> None:
    answer = relaxation(block(mu, speed=3.0), lcp)
    assert answer.w[0] == pytest.approx(mu * abs(answer.w[1]), rel=1e-9)
    assert answer.w[0] > 0.1
    assert answer.coulomb_residual > 0.01
    assert "slips" in answer.approximation


def test_the_relaxation_falls_towards_coulombs_law_with_mu(lcp: Any) -> None:
    """The error in w is of first order in mu."""
    mu = 0.1 * 0.5 ** np.arange(5)
    errors = [np.abs(relaxation(block(m, 3.0), lcp).w - coulomb(block(m, 3.0), lcp).w).max() for m in mu]
    order = np.polyfit(np.log(mu), np.log(errors), 1)[0]
    assert 0.9 <= order <= 1.1


def test_flat_sides_err_as_their_number_says(lcp: Any) -> None:
    """Sliding between two corners: the force is off by up to pi / facets in direction, never more."""
    b = np.array([-1.0, 4.0, 0.0])
    for facets in (4, 8, 16, 32, 64):
        worst = 0.0
        for angle in np.linspace(0.01, np.pi / 4, 7):
            turned = [b[0], b[1] * np.cos(angle), b[1] * np.sin(angle)]
            problem = FrictionProblem.of(np.eye(3), turned, [0.5])
            exact, flat = coulomb(problem, lcp), polyhedral(problem, lcp, facets=facets)
            worst = max(worst, float(np.linalg.norm(flat.z - exact.z)) / 0.5)
        assert worst <= np.pi / facets + 1e-9
        assert worst >= 0.2 * np.pi / facets


@pytest.mark.slow
def test_where_coulombs_answer_is_unique_all_exact_solvers_agree(lcp: Any) -> None:
    """Motions of the core and of IPOPT, on problems with a proof of uniqueness."""
    compared = 0
    for problem in map(mild, range(20)):
        answer, reference = coulomb(problem, lcp), solver("mpcc")(problem, lcp)
        assert reference.outcome is Outcome.SOLVED
        if answer.unique:
            compared += 1
            np.testing.assert_allclose(answer.w, reference.w, rtol=0, atol=1e-5 * np.abs(problem.b).max())
    assert compared >= 12


@pytest.mark.slow
def test_what_the_reference_finds_the_core_confirms(lcp: Any) -> None:
    """On problems of all kinds: started at IPOPT's forces, the core stays at its motion."""
    found = [(p, solver("mpcc")(p, lcp)) for p in (feasible(seed, 4) for seed in range(200, 210))]
    solved = [(p, reference) for p, reference in found if reference.outcome is Outcome.SOLVED]
    assert len(solved) >= 8
    for problem, reference in solved:
        answer = coulomb(problem, lcp, start=reference.z)
        assert answer.outcome is Outcome.SOLVED
        d = np.sqrt(np.diag(problem.A))
        assert np.abs((answer.w - reference.w) / d).max() <= 1e-3 * np.abs(problem.b / d).max()


X = [ca.SX.sym(name) for name in ("x", "y", "z")]
x, y, z = X
PROGRAMS: dict[str, tuple[ca.SX, list[tuple[ca.SX, ca.SX]], list[ca.SX], list[float], float]] = {
    "kth1": (x + y, [(x, y)], [], [1, 1], 0),
    "kth2": (x + (y - 1) ** 2, [(x, y)], [], [1, 1], 0),
    "kth3": ((x - 1) ** 2 / 2 + (y - 1) ** 2, [(x, y)], [], [0.5, 1], 0.5),
    "ralph2": (x**2 + y**2 - 4 * x * y, [(x, y)], [], [1, 1], 0),
    "scholtes1": (
        (x + 1) ** 2 + (y - 2.5) ** 2 + (z + 1) ** 2,
        [(y - ca.exp(x) - ca.exp(z), x)],
        [z],
        [0, 2, 0],
        2,
    ),
    "scholtes3": (((x - 1) ** 2 + (y - 1) ** 2) / 2, [(x, y)], [], [1e-4, 1e-4], 0.5),
    "scholtes5": ((x - 1) ** 2 + (y - 2) ** 2 + (z + 1) ** 2, [(x, z), (y, z)], [], [1, 1, 1], 1),
    "jr1": ((x - 1) ** 2 + y**2, [(y, y - x)], [], [0.5, 1], 0.5),
    "jr2": ((y - 1) ** 2 + x**2, [(y, y - x)], [], [0.5, 1], 0.5),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_of_macmpec_end_at_their_optimum(name: str) -> None:
    """S. Leyffer, MacMPEC; the values by hand but for scholtes1."""
    objective, pairs, above, start, value = PROGRAMS[name]
    answer = minimise(
        ca.vertcat(*X), objective, Conditions(pairs=pairs), [*start, *[0.0] * (3 - len(start))], above=above
    )
    assert answer.objective == pytest.approx(value, abs=1e-6)
    assert answer.complementarity <= 1e-5
    assert answer.violation <= 1e-6
