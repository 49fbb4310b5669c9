"""Published problems of three-dimensional Coulomb friction: six of the collection of Siconos."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen.runtime.friction import FrictionProblem, Outcome, coulomb, residual, solver
from tests.core.frictional import natural_map

CASES: dict[str, dict[str, Any]] = json.loads(
    (Path(__file__).parent / "data" / "fc3d_siconos.json").read_text()
)


def problem_of(case: dict[str, Any]) -> FrictionProblem:
    return FrictionProblem.of(case["A"], case["b"], case["mu"])


@pytest.mark.parametrize("name", CASES)
def test_the_published_solution_is_found(name: str, lcp: Any) -> None:
    """Forces and motions to 1e-6, natural map to 1e-8: both far above what is reached."""
    case, problem = CASES[name], problem_of(CASES[name])
    answer = coulomb(problem, lcp)
    assert answer.outcome is Outcome.SOLVED
    assert natural_map(problem, answer.z) <= 1e-12
    for found, expected in ((answer.z, case["r"]), (answer.w, case["u"])):
        assert np.abs(found - expected).max() <= 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("name", CASES)
def test_the_published_solution_has_the_certificate(name: str, lcp: Any) -> None:
    assert residual(problem_of(CASES[name]), CASES[name]["r"], lcp) <= 1e-9


@pytest.mark.parametrize("name", CASES)
def test_interior_points_find_it_too(name: str, lcp: Any) -> None:
    case, answer = CASES[name], solver("mpcc")(problem_of(CASES[name]), lcp)
    assert answer.outcome is Outcome.SOLVED
    assert np.abs(answer.z - case["r"]).max() <= 1e-5 * np.abs(case["r"]).max()


@pytest.mark.parametrize("name", CASES)
def test_flat_cones_come_near_as_facets_are_added(name: str, lcp: Any) -> None:
    """The direction of the force is off by at most half the angle between two corners."""
    from modelgen.runtime.friction import polyhedral

    case, problem = CASES[name], problem_of(CASES[name])
    errors = []
    for facets in (8, 32, 128):
        answer = polyhedral(problem, lcp, facets=facets)
        assert answer.outcome is Outcome.SOLVED
        errors.append(np.abs(answer.z - case["r"]).max() / np.abs(case["r"]).max())
    assert errors[0] <= 0.5
    assert errors[-1] <= 0.05
