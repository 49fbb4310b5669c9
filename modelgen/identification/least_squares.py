"""Nonlinear least squares over growing parts of the recordings, from one or several first guesses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from modelgen.errors import SimulationError
from modelgen.identification.measurement_noise import Noise
from modelgen.identification.recording_residuals import Counts, RecordedRuns
from modelgen.identification.recordings import Array
from modelgen.runtime.sensitivity import outputs_of

LOSSES = {  # scipy's losses with the deviation, in noise, from which they flatten
    "linear": 1.0,
    "soft_l1": 1.345,
    "huber": 1.345,  # 95 % efficiency for normal noise (Huber 1981)
    "cauchy": 2.385,  # the same
}
SHARES = (0.25, 0.5)  # of the time of each recording, fitted before the whole
TOLERANCE = 1e-8  # relative, of cost and unknowns
ROUGH = 1e-3  # the same for parts of the recordings
SAME = 1e-3  # relative difference of costs that are one minimum
NO_EFFECT = 1e-6  # derivative by an unknown, in its scale, over the largest, below which it is not seen
POINTS = 8  # at which such an unknown is sought
ROUNDS = 4  # of fits with noise estimated anew
SETTLED = 0.05  # relative change of an estimated noise
SPREAD = 0.5  # of first guesses, in logarithms or scales

Report = Callable[[str], None]


@dataclass(frozen=True)
class Attempt:
    """A first guess and where it led; NaN where it has no run."""

    first: Array
    found: Array
    cost: float


@dataclass(frozen=True)
class Solution:
    """The unknowns found, the deviations there (nt, n) and derivatives (nt, n, n_unknowns) of each run."""

    x: Array
    noise: Noise
    deviations: list[Array]
    derivatives: list[Array]
    counts: Counts  # there
    all_counts: Counts  # of the whole fit
    converged: bool
    message: str
    attempts: list[Attempt]


class Problem:
    """Deviations over noise, in one column, for the first rows of each recording."""

    def __init__(self, runs: RecordedRuns, noise: Noise, share: float = 1.0, anchor: Array | None = None):
        """`anchor`: values that hold unknowns which this part of the recordings does not show."""
        self._runs, self._anchor = runs, anchor
        self._rows = [_rows(each.recording.t, share) for each in runs.runs]
        self._weights = [1 / noise.of(each) for each in runs.runs]
        self.counts = Counts()
        self._masks = [
            np.isfinite(each.comparison.deviations(each.recording, _nothing(each.comparison.of, n, runs)))
            for each, n in zip(runs.runs, self._rows, strict=True)
        ]

    @property
    def size(self) -> int:
        """Number of deviations."""
        return int(sum(mask.sum() for mask in self._masks))

    def residual(self, x: Array) -> Array:
        """(m,) deviations over noise; NaN where a run cannot start or ends early."""
        try:
            parts = [self._runs.deviations(run, x, n) for run, n in self._pairs()]
        except SimulationError:
            return np.full(self.size + len(self._pulls(x)), np.nan)
        weighted = zip(parts, self._weights, self._masks, strict=True)
        return np.concatenate([*((part * w)[mask] for part, w, mask in weighted), self._pulls(x)])

    def jacobian(self, x: Array) -> Array:
        """(m, n_unknowns)"""
        parts = [self._runs.derivatives(run, x, n, self.counts) for run, n in self._pairs()]
        rows = [
            (part * w[:, None])[mask] for part, w, mask in zip(parts, self._weights, self._masks, strict=True)
        ]
        pulls = [] if self._anchor is None else [np.diag(1 / self._runs.scales)]
        return np.concatenate([*rows, *pulls])

    def _pairs(self) -> list[tuple[Any, int]]:
        return list(zip(self._runs.runs, self._rows, strict=True))

    def _pulls(self, x: Array) -> Array:
        return np.zeros(0) if self._anchor is None else (x - self._anchor) / self._runs.scales


def _rows(t: Array, share: float) -> int:
    return max(int(np.count_nonzero(t <= share * t[-1])), 1)


def _nothing(of: Sequence[str], n: int, runs: RecordedRuns) -> Array:
    known = outputs_of(runs.library.manifest.instance)
    return np.zeros((n, sum(len(known[name]) for name in of)))


def solve(
    runs: RecordedRuns, noise: Noise, loss: str, starts: int, seed: int, most: int, report: Report
) -> Solution:
    """The unknowns of least cost over `starts` first guesses.

    Raises SimulationError where no first guess has a run.
    """
    x_first = np.array([each.first for each in runs.unknowns])
    counts = Counts()
    attempts: list[Attempt] = []
    refused: SimulationError | None = None
    for k in range(starts):
        first = x_first if k == 0 else _other(runs, x_first, np.random.default_rng((seed, k)))
        report(f"fitting from first guess {k + 1} of {starts}")
        try:
            attempts.append(_attempt(runs, noise, loss, first, most, counts))
        except SimulationError as error:
            refused = refused or error
            attempts.append(Attempt(first, np.full(len(first), np.nan), np.inf))
    least = min(each.cost for each in attempts)
    best = next(each for each in attempts if each.cost <= least * (1 + SAME))
    if not np.isfinite(best.cost) and refused:
        raise refused
    return _whole(runs, noise, loss, best.found, attempts, most, counts, report)


def _attempt(runs: RecordedRuns, noise: Noise, loss: str, first: Array, most: int, counts: Counts) -> Attempt:
    """From a first guess over parts of the recordings to the whole."""
    for run in runs.runs:  # says what is wrong with the guess
        runs.deviations(run, first, len(run.recording.t))
    x = first
    for share in SHARES:
        problem = Problem(runs, noise, share, anchor=first)
        x = _least_squares(problem, runs, x, loss, most, ROUGH).x
        counts.add(problem.counts)
    problem = Problem(runs, noise)
    costs = [np.sum(problem.residual(each) ** 2) for each in (first, x)]
    result = _least_squares(problem, runs, x if costs[1] <= costs[0] else first, loss, most)
    elsewhere = _elsewhere(problem, runs, result.x, result.jac)
    if elsewhere is not None:
        other = _least_squares(problem, runs, elsewhere, loss, most)
        result = min(result, other, key=lambda each: float(each.cost))
    counts.add(problem.counts)
    return Attempt(first, result.x, float(result.cost))


def _elsewhere(problem: Problem, runs: RecordedRuns, x: Array, jacobian: Array) -> Array | None:
    """A better point in the ranges of unknowns that the recordings do not show at x, as friction where all
    contacts stick; None where there is none."""
    effects = np.linalg.norm(jacobian * runs.scales, axis=0)
    least, found = (1 - SAME) * np.sum(problem.residual(x) ** 2), None
    for k in runs.common:
        if effects[k] > NO_EFFECT * effects.max():
            continue
        for value in _grid(runs, x, k):
            moved = (x if found is None else found).copy()
            moved[k] = value
            size = np.sum(problem.residual(moved) ** 2)
            if size < least:
                least, found = size, moved
    return found


def _grid(runs: RecordedRuns, x: Array, k: int) -> Array:
    """Values over the range of an unknown; without one, around its present value."""
    low, high = runs.low[k], runs.high[k]
    shares = (np.arange(POINTS) + 0.5) / POINTS
    if np.isfinite(low) and np.isfinite(high):
        return np.asarray(low + (high - low) * shares)
    factors = 2.0 ** np.arange(-POINTS // 2, POINTS // 2 + 1)
    return np.asarray(np.clip(factors * (x[k] or runs.scales[k]), low, high))


def _whole(
    runs: RecordedRuns,
    noise: Noise,
    loss: str,
    x: Array,
    attempts: list[Attempt],
    most: int,
    counts: Counts,
    report: Report,
) -> Solution:
    """The fit over the whole recordings, repeated until the noise that is estimated stays."""
    converged, message = False, ""
    for round_ in range(ROUNDS):
        report(f"fitting the whole, round {round_ + 1}")
        problem = Problem(runs, noise)
        lost = min(len(x) / problem.size, 0.5)
        deviations = _deviations(runs, x)
        before, noise = noise, noise.fitted(runs.runs, deviations, lost, loss != "linear")
        changes = [abs(noise.estimated[k] / before.estimated[k] - 1) for k in noise.estimated]
        problem = Problem(runs, noise)
        result = _least_squares(problem, runs, x, loss, most)
        counts.add(problem.counts)
        x, converged, message = result.x, result.status > 0, str(result.message)
        if max(changes, default=0.0) <= SETTLED:
            break
    here = Counts()
    derivatives = [runs.derivatives(run, x, len(run.recording.t), here) for run in runs.runs]
    return Solution(x, noise, _deviations(runs, x), derivatives, here, counts, converged, message, attempts)


def _deviations(runs: RecordedRuns, x: Array) -> list[Array]:
    return [runs.deviations(run, x, len(run.recording.t)) for run in runs.runs]


def _least_squares(
    problem: Problem, runs: RecordedRuns, x: Array, loss: str, most: int, tolerance: float = TOLERANCE
) -> Any:
    inside = np.clip(x, np.nextafter(runs.low, np.inf), np.nextafter(runs.high, -np.inf))
    start = problem.residual(inside)
    if not np.all(np.isfinite(start)):
        inside = x
    return least_squares(
        problem.residual,
        inside,
        jac=problem.jacobian,
        bounds=(runs.low, runs.high),
        x_scale=runs.scales,
        loss=loss,
        f_scale=LOSSES[loss],
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=most,
    )


def _other(runs: RecordedRuns, first: Array, random: np.random.Generator) -> Array:
    """Another first guess of what is common to the recordings: anywhere in a bounded range, else around the
    first."""
    found = first.copy()
    for k in runs.common:
        low, high, scale = runs.low[k], runs.high[k], runs.scales[k]
        if np.isfinite(low) and np.isfinite(high):
            found[k] = random.uniform(low, high)
        elif first[k]:
            found[k] = first[k] * np.exp(SPREAD * random.normal())
        else:
            found[k] = SPREAD * scale * random.normal()
    return np.asarray(np.clip(found, runs.low, runs.high))
