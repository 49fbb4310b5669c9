"""Covariance, and directions that are not seen, against closed forms; and these in words."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import linregress
from scipy.stats import t as student

from modelgen.identification.confidence import confidence_of, lag_correlation, repetition, sparse
from modelgen.identification.unidentifiable_in_words import in_words

NAMES = ("mass", "stiffness", "damping")


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e5])
def test_a_line_has_the_confidence_of_linear_regression(scale: float) -> None:
    random = np.random.default_rng(0)
    t = np.linspace(0, 1, 30)
    y = 0.3 + 2 * t + 0.1 * random.normal(size=30)
    known = linregress(t, y)
    residual = known.intercept + known.slope * t - y
    jacobian = np.stack([t, np.ones(30)], axis=1)
    found = confidence_of(jacobian, residual, np.ones(30), np.array([scale, 1.0]), given=False)
    assert found.deviation == pytest.approx([known.stderr, known.intercept_stderr], rel=1e-9)
    assert found.half_width[0] == pytest.approx(student.ppf(0.975, 28) * known.stderr, rel=1e-9)
    assert found.degrees == 28
    mean_square = np.sqrt(np.mean(t**2))
    assert found.correlation[0, 1] == pytest.approx(-t.mean() / mean_square, rel=1e-9)


def test_given_noise_is_not_narrowed_by_small_deviations() -> None:
    jacobian, residual = np.ones((25, 1)), 0.1 * np.ones(25)
    found = confidence_of(jacobian, residual, np.ones(25), np.ones(1), given=True)
    assert found.deviation == pytest.approx([1 / 5], rel=1e-12)
    wide = confidence_of(jacobian, 3 * np.ones(25), np.ones(25), np.ones(1), given=True)
    assert wide.deviation == pytest.approx([3 / 5 * np.sqrt(25 / 24)], rel=1e-12)


def test_the_sandwich_of_a_mean_is_that_of_its_weights() -> None:
    """Of a mean with weights w: sum (w r)^2 / (sum w)^2, as Huber has it, and with the degrees of freedom."""
    random = np.random.default_rng(1)
    residual, weights = random.normal(size=40), random.uniform(0.2, 1.0, 40)
    found = confidence_of(np.ones((40, 1)), residual, weights, np.ones(1), given=False)
    variance = np.sum((weights * residual) ** 2) / np.sum(weights) ** 2 * 40 / 39
    assert found.deviation == pytest.approx([np.sqrt(variance)], rel=1e-12)


def test_directions_that_change_nothing_are_found() -> None:
    """Columns 0 and 2 count as their sum alone; column 3 not at all; each uncertain one is said so."""
    random = np.random.default_rng(2)
    base = random.normal(size=(50, 2))
    jacobian = np.stack([base[:, 0], base[:, 1], base[:, 0], np.zeros(50)], axis=1)
    found = confidence_of(jacobian, 0.01 * random.normal(size=50), np.ones(50), np.ones(4), given=False)
    assert np.isinf(found.deviation).tolist() == [True, False, True, True]
    assert len(found.unseen) == 2
    rows = sorted(np.abs(found.unseen).tolist())
    assert rows == [pytest.approx([0, 0, 0, 1], abs=1e-9), pytest.approx([1, 0, 1, 0], abs=1e-9)]
    assert np.isnan(found.correlation[0, 1])


def test_a_sparse_basis_spans_the_same_space() -> None:
    random = np.random.default_rng(3)
    true = np.array([[1.0, 1.0, 0, 0, 0], [0, 0, 1.0, -0.5, 0]])
    mixed = np.linalg.qr((random.normal(size=(2, 2)) @ true).T)[0].T
    found = sparse(mixed)
    assert np.linalg.matrix_rank(np.vstack([found, true]), tol=1e-9) == 2
    assert np.count_nonzero(np.abs(found) > 1e-9) == 4


@pytest.mark.parametrize(
    ("direction", "words"),
    [
        ((1, 1, 0), "only the ratio of mass and stiffness is seen"),
        ((1, -1, 0), "only the product of mass and stiffness is seen"),
        ((0.5, 0, 1), "only mass^2/damping is seen"),
        ((1, 0, -0.5), "only mass*damping^2 is seen"),
        ((1, 1, 1), "only the ratios of mass, stiffness and damping are seen"),
        ((0, 0, 1), "damping is not seen"),
        ((1, 0.31, 0), "mass and stiffness can change together, unseen, as +1 %, +0.31 %"),
    ],
)
def test_words_for_directions(direction: tuple[float, ...], words: str) -> None:
    assert in_words(np.array(direction, dtype=float), NAMES, [True] * 3) == words


def test_the_exponents_in_words_are_those_that_stay() -> None:
    """mass^2/damping along (1/2, 1): the logarithm changes by 2 * 1/2 - 1 = 0."""
    direction = np.array([0.5, 0.0, 1.0])
    assert np.array([2.0, 0.0, -1.0]) @ direction == 0
    assert np.array([1.0, 0.0, 2.0]) @ np.array([1.0, 0.0, -0.5]) == 0


def test_starts_change_in_their_scales() -> None:
    told = in_words(np.array([1.0, -0.5, 0.0]), NAMES, [True, False, True])
    assert told == "mass and stiffness can change together, unseen, as +1 %, -0.5 (of their scales)"


def test_a_mean_of_deviations_that_follow_each_other_is_as_uncertain_as_it_is() -> None:
    """Against the spread of 400 means over an autoregressive process; 0.2 is six deviations of it."""
    random = np.random.default_rng(5)
    m, follow = 500, 0.8
    steps = random.normal(size=(400, m))
    series = np.zeros((400, m))
    for k in range(1, m):
        series[:, k] = follow * series[:, k - 1] + steps[:, k]
    told = []
    for row in series[:50]:
        left = row - row.mean()
        repeated = repetition(lag_correlation([left]), m)
        told.append(confidence_of(np.ones((m, 1)), left, np.ones(m), np.ones(1), False, repeated).deviation)
    assert np.mean(told) == pytest.approx(series.mean(axis=1).std(), rel=0.2)
    assert repetition(0.9 * 3 / np.sqrt(m), m) == 1.0


def test_lag_correlation() -> None:
    random = np.random.default_rng(4)
    noise = random.normal(size=2000)
    assert abs(lag_correlation([noise])) < 5 / np.sqrt(2000)
    assert lag_correlation([np.cumsum(noise)]) > 0.9
    assert lag_correlation([]) == 0.0
