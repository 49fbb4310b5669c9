"""Siconos (V. Acary et al.), which shares nothing with this project, on the same problems."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from modelgen.runtime.friction import FrictionProblem, coulomb, residual
from tests.core.frictional import feasible, mild
from tests.core.siconos_fc3d import TOLERANCE, interpreter, siconos

HARD, MILD = 60, 40

pytestmark = pytest.mark.skipif(
    interpreter() is None, reason="no Python with Siconos (Debian: python3-siconos)"
)


@pytest.fixture(scope="module")
def compared(lcp: Any, tmp_path_factory: pytest.TempPathFactory) -> list[tuple[FrictionProblem, Any, Any]]:
    """(problem, our answer, what Siconos says); all coefficients positive, as its cones demand."""
    hard = (feasible(seed, 8) for seed in range(HARD))
    problems = [*(p for p in hard if (p.cone[:, 0] > 0).all()), *map(mild, range(MILD))]
    ours = [coulomb(problem, lcp) for problem in problems]
    records = [
        {"A": p.A.tolist(), "b": p.b.tolist(), "mu": p.cone[:, 0].tolist(), "z": answer.z.tolist()}
        for p, answer in zip(problems, ours, strict=True)
    ]
    theirs = siconos(records, tmp_path_factory.mktemp("siconos"))
    return list(zip(problems, ours, theirs, strict=True))


def test_siconos_finds_our_forces_exact(compared: Any) -> None:
    """Its error, relative to |b|, in units that are not scaled by mobility: at most 1e-9, mostly 1e-13."""
    errors = [theirs["given"] for _, answer, theirs in compared if answer.outcome.name == "SOLVED"]
    assert len(errors) >= 0.99 * len(compared)
    assert max(errors) <= 1e-9
    assert np.median(errors) <= 1e-12


def test_our_certificate_finds_its_answers_right(compared: Any, lcp: Any) -> None:
    """Where it converges (mass ratios stop it), to the accuracy that it was asked for, times the scales."""
    right = [(p, theirs) for p, _, theirs in compared if theirs["info"] == 0 and theirs["error"] <= TOLERANCE]
    assert len(right) >= 0.6 * len(compared)
    for problem, theirs in right:
        d = np.sqrt(np.diag(problem.A))
        unlike = d.max() / d.min() * max(1, np.abs(problem.b).max() / np.abs(problem.b / d).max() / d.min())
        assert residual(problem, theirs["z"], lcp) <= 1e3 * TOLERANCE * unlike


def test_motions_agree_where_the_answer_is_unique(compared: Any) -> None:
    """Elsewhere both are right and may differ."""
    same = [
        np.abs(answer.w - theirs["w"]).max() / np.abs(problem.b).max()
        for problem, answer, theirs in compared
        if theirs["info"] == 0 and answer.unique
    ]
    assert len(same) >= 0.5 * MILD
    assert max(same) <= 1e-6
