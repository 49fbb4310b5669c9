"""Cubic splines through points as expressions of t in [0, 1]: one smooth curve with continuous curvature.

Their conditions are solved for coefficients of B-splines (de Boor, A Practical Guide to Splines, 2001), and
they are written as polynomials between their knots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist
from typing import Any

import numpy as np

from modelgen.scene.expression import Cubic, Expression, Name, evaluate
from modelgen.scene.expression_algebra import expression_of
from modelgen.scene.source_location import Place

Array = np.ndarray[Any, np.dtype[np.float64]]
Parameters = tuple[tuple[str, float], ...]

FEWEST, MOST = 6, 400  # points of a spline
GHOSTS = 3  # spans by which a closed spline goes on beyond both ends of its domain
MISS = 1e-10  # of a point by its spline, against its size: points too uneven for double precision


@dataclass(frozen=True)
class PointSpline:
    """Components over t in [0, 1] with named parameters; `reach` is how far beyond a closed one is right."""

    components: tuple[Expression, ...]
    parameters: Parameters
    reach: float


def open_spline(points: Sequence[tuple[float, float]], poles: tuple[bool, bool]) -> PointSpline:
    """The spline through points (r, z), without a knot at the second and the last but one.

    At a pole r is odd and z even in the distance from the end, up to a knot halfway to the next point: a
    profile turned about z is smooth there.
    """
    x = np.array(points)
    u = _chords(x)
    breaks = [*u]
    if poles[0]:
        breaks.insert(1, u[1] / 2)
    if poles[1]:
        breaks.insert(-1, (u[-2] + 1) / 2)
    knots = np.array([0.0] * 3 + breaks + [1.0] * 3)
    odd, even = [_rows(knots, u, 0)], [_rows(knots, u, 0)]
    for at, pole, inner in ((0.0, poles[0], breaks[1]), (1.0, poles[1], breaks[-2])):
        smooth = [_jump(knots, inner)]
        odd += [_rows(knots, [at], 2), *smooth] if pole else smooth
        even += [_rows(knots, [at], 1), _rows(knots, [at], 3)] if pole else smooth
    columns = []
    for k, conditions in enumerate((odd, even)):
        matrix = np.vstack(conditions)
        right = np.concatenate([x[:, k], np.zeros(len(matrix) - len(x))])
        columns.append(np.linalg.solve(matrix, right))
    return _written(knots, np.array(columns).T, "rz", 0.0)


def closed_spline(points: Sequence[tuple[float, float]]) -> PointSpline:
    """The closed spline through points (x, y), the first of which follows the last."""
    x = np.array(points)
    count = len(x)
    u = _chords(np.vstack([x, x[:1]]))
    steps = np.diff(u)
    around = np.concatenate(
        [[0.0], np.cumsum([steps[k % count] for k in range(-GHOSTS - 3, count + GHOSTS + 3)])]
    )
    knots = around - around[GHOSTS + 3]
    wide = _rows(knots, u[:-1], 0)
    matrix = np.zeros((count, count))
    for j in range(wide.shape[1]):
        matrix[:, j % count] += wide[:, j]
    turn = np.linalg.solve(matrix, x)
    coefficients = turn[np.arange(wide.shape[1]) % count]
    return _written(knots, coefficients, "xy", float(min(-knots[3], knots[-4] - 1)))


def check_points(points: Sequence[tuple[float, float]], place: Place) -> None:
    """Raises SceneError for points that no spline is taken through."""
    if not FEWEST <= len(points) <= MOST:
        raise place.error(f"{len(points)} points", f"from {FEWEST} to {MOST} are allowed")
    for index, (a, b) in enumerate(pairwise(points), start=1):
        if a == b:
            raise place.item(index).error("a point equal to the one before", "", "leave it out")


def check_reached(
    spline: PointSpline, points: Sequence[tuple[float, float]], closed: bool, place: Place
) -> None:
    """Raises SceneError where rounding keeps the spline from its points."""
    missed = _miss(spline, points, closed)
    if not missed <= MISS:
        found = f"points so uneven that the spline misses them by {missed:.3g} of its size"
        raise place.error(found, f"at most {MISS:g} is allowed", "space the points more evenly")


def _miss(spline: PointSpline, points: Sequence[tuple[float, float]], closed: bool) -> float:
    """The largest distance of a point from the spline at its t, against the size of the points."""
    x = np.array(points)
    u = _chords(np.vstack([x, x[:1]]) if closed else x)[: len(x)]
    values = dict(spline.parameters)
    found = np.array([[evaluate(each, {**values, "t": t}) for each in spline.components] for t in u])
    return float(np.abs(found - x).max() / np.ptp(x, axis=0).max())


def _chords(x: Array) -> Array:
    """Parameters of the points from 0 to 1, by the lengths of the chords."""
    steps = [dist(a, b) for a, b in pairwise(x)]
    u = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(u / u[-1])


def _rows(knots: Array, at: Sequence[float] | Array, order: int) -> Array:
    """(len(at), n): derivatives of an order of all B-splines at some t."""
    from scipy.interpolate import BSpline  # slow to import, and needed by splines alone

    n = len(knots) - 4
    splines = BSpline(knots, np.eye(n), 3)
    return np.asarray(splines(np.asarray(at, dtype=np.float64), nu=order))


def _jump(knots: Array, at: float) -> Array:
    """(1, n): jumps of the third derivatives at a simple knot."""
    before, after = (knots[knots < at].max() + at) / 2, (knots[knots > at].min() + at) / 2
    return _rows(knots, [after], 3) - _rows(knots, [before], 3)


def _written(knots: Array, coefficients: Array, axes: str, reach: float) -> PointSpline:
    """The spline with the control points (n, 2) as polynomials between its knots."""
    from scipy.interpolate import BSpline, PPoly

    inner = np.unique(knots[3:-3])
    numbers = {f"k_{i}": float(k) for i, k in enumerate(inner)}
    components = []
    for axis, column in zip(axes, coefficients.T, strict=True):
        pieces = PPoly.from_spline(BSpline(knots, column, 3))
        cubic = Cubic(Name("t"), axis, len(inner) - 1)
        cubes, squares, slopes, values = pieces.c[:, np.searchsorted(pieces.x, inner[:-1], side="right") - 1]
        numbers |= cubic.numbers(values, slopes, squares, cubes)
        numbers |= cubic.deviations(numbers)
        components.append(expression_of(cubic))
    return PointSpline(tuple(components), tuple(numbers.items()), reach)
