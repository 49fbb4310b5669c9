"""How well the unknowns are known: covariance, correlation, and directions that the data do not show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr, svd
from scipy.special import stdtrit

from modelgen.identification.recordings import Array

LEVEL = 0.95  # of the intervals
UNSEEN = 1e-8  # singular value, over the largest, below which a direction has no effect
CHANCE = 3.0  # standard deviations of a correlation of independent deviations, which is 1/sqrt(m)
SHARE = 1e-3  # of an unknown in such a direction that counts


@dataclass(frozen=True)
class Confidence:
    """Of n unknowns."""

    deviation: Array  # (n,) standard deviations; infinite where the data do not show the unknown
    half_width: Array  # (n,) of the intervals of LEVEL
    correlation: Array  # (n, n); NaN where not shown
    unseen: Array  # (k, n) directions with an uncertainty above all of an unknown's scale, in scales
    reduced: float  # sum of squared deviations over noise, over the degrees of freedom
    degrees: int


def confidence_of(
    jacobian: Array, residual: Array, slopes: Array, scales: Array, given: bool, repeated: float = 1.0
) -> Confidence:
    """From derivatives (m, n) and deviations (m,) over noise at the solution.

    Args:
        jacobian, residual: as they are.
        slopes: (m,) weights of the loss, 1 for the linear one; others lead to the sandwich covariance of
            M-estimators (Huber 1981).
        scales: (n,) changes of the unknowns that matter.
        given: whether the noise is that of the user: then deviations below it do not narrow the intervals.
        repeated: how many deviations count as one (`repetition`).
    """
    m, n = jacobian.shape
    scaled = jacobian * scales
    _, sizes, directions = svd(scaled * np.sqrt(slopes)[:, None], full_matrices=m < n)
    sizes = np.concatenate([sizes, np.zeros(n - len(sizes))])
    seen = sizes > UNSEEN * sizes[0] if sizes[0] > 0 else np.zeros(n, dtype=bool)
    degrees = max(m - int(seen.sum()), 1)
    reduced = float(np.sum((slopes * residual) ** 2) / np.sum(slopes**2) * m / degrees)
    factor = repeated * (max(reduced, 1.0) if given else reduced)
    inverse = directions[seen].T / sizes[seen] ** 2 @ directions[seen]
    if np.all(slopes == 1.0):
        covariance = factor * inverse
    else:
        pull = scaled * (slopes * residual)[:, None]
        covariance = repeated * m / degrees * inverse @ (pull.T @ pull) @ inverse
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    hidden = np.sqrt(np.sum(directions[~seen] ** 2, axis=0)) > SHARE
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = covariance / np.outer(deviation, deviation)
    correlation[hidden], correlation[:, hidden] = np.nan, np.nan
    deviation[hidden] = np.inf
    vague = ~seen | (np.sqrt(factor) > sizes)
    quantile = float(stdtrit(degrees, (1 + LEVEL) / 2))  # Student's
    return Confidence(
        deviation * scales,
        quantile * deviation * scales,
        correlation,
        sparse(directions[vague]),
        reduced,
        degrees,
    )


def sparse(directions: Array) -> Array:
    """Another basis (k, n) of the space of directions (k, n), with zeros where k entries can be: reduced
    rows, the largest entry of each 1."""
    k = len(directions)
    if not k:
        return directions
    _, _, order = qr(directions, pivoting=True, mode="economic")
    rows = np.linalg.solve(directions[:, order[:k]], directions)
    rows[np.abs(rows) < SHARE * np.abs(rows).max(axis=1, keepdims=True)] = 0.0
    largest = np.abs(rows).argmax(axis=1)
    return np.asarray(rows / rows[np.arange(k), largest][:, None])


def repetition(following: float, m: int) -> float:
    """How many of m deviations count as one where each has this correlation with that before: that of the
    variance of a mean over an autoregressive process of order 1; 1 where chance may have made it."""
    return (1 + following) / max(1 - following, 1 / m) if following > CHANCE / np.sqrt(m) else 1.0


def lag_correlation(parts: Sequence[Array]) -> float:
    """Correlation of deviations (nt,) with those of the row before, over all parts; 0 for none."""
    before = np.concatenate([part[:-1] for part in parts] or [np.zeros(0)])
    after = np.concatenate([part[1:] for part in parts] or [np.zeros(0)])
    whole = np.isfinite(before) & np.isfinite(after)
    size = np.sqrt(np.sum(before[whole] ** 2) * np.sum(after[whole] ** 2))
    return float(np.sum(before[whole] * after[whole]) / size) if size > 0 else 0.0
