"""A smooth cubic spline through few nodes from many points that were measured with noise.

Its intervals are halved where the points, averaged over a part of the interval, lie off the least-squares
spline by more than a tolerance (de Boor, A Practical Guide to Splines, 2001, ch. XIV). The noise is taken from
fourth divided differences. Where intervals cannot be halved any more, because the profile turns as in a
corner, the fit is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.scene.point_splines import MOST

Array = np.ndarray[Any, np.dtype[np.float64]]

FIRST = 4  # intervals of the coarsest spline
PARTS = 4  # parts of an interval over which points are averaged
FEWEST = 4  # points of a part
SURE = 4.0  # standard deviations of an average that are no chance
OUTLIER = 6.0  # standard deviations of a point that is none of the profile
MOST_OUTLIERS = 0.02  # part of all points
ROUNDS = 40
PROJECTIONS = 3  # times that points find their parameters anew on the spline
DENSE = 20  # samples of an interval, to find the nearest point
SMALLEST = 1e-9  # noise, against the size of the profile: that of rounded numbers
MAD = 0.6744897501960817  # median absolute deviation of a normal distribution with deviation 1


@dataclass(frozen=True)
class Fitted:
    """A profile as nodes of the spline that a scene takes through points.

    Attributes:
        nodes: (k, 2) m.
        noise: standard deviation of the points across the profile, from their differences, m.
        rms, largest: deviation of the points from the spline across it, m, outliers left out.
        outliers: indices of points that were left out.
        least_radius: of curvature, m, and its place.
    """

    nodes: Array
    noise: float
    rms: float
    largest: float
    outliers: tuple[int, ...]
    least_radius: float
    least_at: tuple[float, float]


def fit_profile(points: Array, closed: bool = False, tolerance: float | None = None, source: str = "profile") -> Fitted:
    """The spline of few nodes near points in the order of the profile.

    Args:
        points: (n, 2) m.
        closed: whether the first point follows the last.
        tolerance: by which averages of points may lie off the spline, m; the noise when None.
        source: of the points, for messages.

    Raises:
        ModelgenError: too few points, points out of order, or a corner.
    """
    x = _checked(np.asarray(points, dtype=float), closed, source)
    noise = noise_of(x, closed)
    kept, outliers = np.arange(len(x)), np.zeros(0, dtype=int)
    allowed = noise if tolerance is None else tolerance
    knots, u, spline = _refined(x, closed, allowed, noise, source)
    bad = np.abs(_across(x, u, spline)) > OUTLIER * max(noise, allowed)
    if bad.any():
        if bad.mean() > MOST_OUTLIERS:
            _refuse_noise(x, bad, source)
        kept, outliers = kept[~bad], kept[bad]
        knots, u, spline = _refined(x[kept], closed, allowed, noise, source)
    nodes = _nodes(knots, spline, closed)
    return _judged(nodes, x[kept], closed, noise, tuple(map(int, outliers)))


def noise_of(x: Array, closed: bool) -> float:
    """Standard deviation of points (n, 2) across the line that they follow, m: robust, from five at a time."""
    around = np.vstack([x[-4:], x]) if closed else x
    u = _chords(around)
    windows = np.lib.stride_tricks.sliding_window_view(u, 5)
    gaps = windows[:, :, None] - windows[:, None, :]
    gaps[:, np.arange(5), np.arange(5)] = 1.0
    weights = 1 / gaps.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    values = np.lib.stride_tricks.sliding_window_view(around, 5, axis=0)  # (windows, 2, 5)
    differences = np.einsum("kc,kac->ka", weights, values)
    along = around[4:] - around[:-4]
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    size = float(np.ptp(x, axis=0).max())
    across = np.abs((differences * normals).sum(axis=1))
    return max(float(np.median(across)) / MAD, SMALLEST * size)


def _checked(x: Array, closed: bool, source: str) -> Array:
    if x.ndim != 2 or x.shape[1] != 2 or not np.isfinite(x).all():
        raise ModelgenError(source, "points that are no pairs of finite numbers", "", "mend the file")
    if closed and len(x) > 1 and np.array_equal(x[0], x[-1]):
        x = x[:-1]
    apart = np.append(True, np.linalg.norm(np.diff(x, axis=0), axis=1) > 0)
    x = x[apart]
    fewest = FIRST * PARTS * FEWEST
    if len(x) < fewest:
        raise ModelgenError(
            source, f"{len(x)} points", f"a profile that is fitted has {fewest} at least",
            "write the points into the scene, which interpolates them",
        )  # fmt: skip
    steps = np.diff(x, axis=0)
    back = np.nonzero((steps[1:] * steps[:-1]).sum(axis=1) < 0)[0]
    if len(back) > len(x) // 20:
        at = x[back[0] + 1]
        raise ModelgenError(
            source, f"points that go to and fro, first at ({at[0]:g}, {at[1]:g})",
            "points follow each other along the profile", "sort them, or take fewer: their noise is as large as their distance",
        )  # fmt: skip
    return x


def _chords(x: Array) -> Array:
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1)))


def _refined(x: Array, closed: bool, tolerance: float, noise: float, source: str) -> tuple[Array, Array, Any]:
    """Knots from 0 to the length of the profile, parameters of the points, and the least-squares spline."""
    u = _chords(np.vstack([x, x[:1]]) if closed else x)
    knots = np.linspace(0.0, u[-1], FIRST + 1)
    u = u[: len(x)]
    for _ in range(ROUNDS):
        spline = _least_squares(x, u, knots, closed)
        for _ in range(PROJECTIONS):
            u = _projected(x, u, spline, knots, closed)
            spline = _least_squares(x, u, knots, closed)
        split = _to_halve(x, u, spline, knots, tolerance, noise)
        if not split.any():
            return knots, u, spline
        _check_halves(x, u, knots, split, source)
        knots = np.sort(np.append(knots, (knots[:-1] + knots[1:])[split] / 2))
    return knots, u, spline


def _least_squares(x: Array, u: Array, knots: Array, closed: bool) -> Any:
    """The cubic spline with these knots nearest to the points; of a closed profile beyond one turn."""
    from scipy.interpolate import make_lsq_spline  # slow to import

    if closed:
        length, side = knots[-1], max(4, len(knots) // 4)
        own = np.concatenate([knots[-side - 1 : -1] - length, knots, knots[1 : side + 1] + length])
        inside = (u - length >= own[0]), (u + length <= own[-1])
        values = np.concatenate([u[inside[0]] - length, u, u[inside[1]] + length])
        points = np.concatenate([x[inside[0]], x, x[inside[1]]])
    else:
        own, values, points = knots, u, x
    order = np.argsort(values, kind="stable")
    values, points = values[order], points[order]
    t = np.concatenate([[own[0]] * 3, own, [own[-1]] * 3])
    values = np.clip(values, own[0], own[-1])
    return make_lsq_spline(values, points, t, k=3)


def _projected(x: Array, u: Array, spline: Any, knots: Array, closed: bool) -> Array:
    """Parameters of the nearest points of the spline, by one step of Newton's method of first order.

    No point moves by more than half a way to its neighbours; the ends of an open profile stay at its ends.
    """
    along, span = spline(u, 1), x - spline(u)
    step = (span * along).sum(axis=1) / (along**2).sum(axis=1)
    apart = np.diff(u)
    most = np.minimum(np.append(apart, apart[-1]), np.append(apart[0], apart)) / 2
    moved = u + np.clip(step, -most, most)
    if closed:
        return moved
    return np.asarray(knots[0] + (moved - moved[0]) * (knots[-1] - knots[0]) / (moved[-1] - moved[0]))


def _across(x: Array, u: Array, spline: Any) -> Array:
    """Signed distances of the points from the spline, across it."""
    along = spline(u, 1)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    return np.asarray(((x - spline(u)) * normal).sum(axis=1))


def _to_halve(x: Array, u: Array, spline: Any, knots: Array, tolerance: float, noise: float) -> Array:
    """(k,) whether the points of an interval lie off the spline other than by chance.

    Averages over parts of an interval are compared with the tolerance, and their mean square with what noise
    makes of it.
    """
    off, place = _across(x, u, spline), np.clip(np.searchsorted(knots, u, side="right") - 1, 0, len(knots) - 2)
    found = np.zeros(len(knots) - 1, dtype=bool)
    for k in range(len(knots) - 1):
        own = off[place == k]
        parts = np.array_split(own, max(1, min(PARTS, len(own) // FEWEST)))
        for part in parts:
            if len(part):
                middle = float(np.median(part))
                found[k] |= abs(middle) > max(tolerance, SURE * noise / np.sqrt(len(part)))
    return found


def _check_halves(x: Array, u: Array, knots: Array, split: Array, source: str) -> None:
    """Raises ModelgenError where an interval has too few points to be halved: a corner."""
    counts = np.histogram(u, knots)[0]
    for k in np.nonzero(split)[0]:
        if counts[k] < 2 * FEWEST or len(knots) > MOST - 2:
            own = x[(u >= knots[k]) & (u <= knots[k + 1])]
            at = own[len(own) // 2] if len(own) else x[np.abs(u - knots[k]).argmin()]
            turn = _turn(x, u, (knots[k] + knots[k + 1]) / 2, knots[k + 1] - knots[k])
            raise ModelgenError(
                source, f"a corner, or too few points, at ({at[0]:.6g}, {at[1]:.6g}) m: it turns by "
                f"{np.degrees(turn):.1f} degrees within {2 * (knots[k + 1] - knots[k]):.2g} m",
                "a profile is smooth", "split the file there, measure it more densely, or raise --tolerance",
            )  # fmt: skip


def _turn(x: Array, u: Array, middle: float, width: float) -> float:
    """Angle between the profile before and after a place, rad."""
    before, after = x[(u > middle - 3 * width) & (u < middle - width)], x[(u > middle + width) & (u < middle + 3 * width)]
    if len(before) < 2 or len(after) < 2:
        return 0.0
    a, b = before[-1] - before[0], after[-1] - after[0]
    return float(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def _refuse_noise(x: Array, bad: Array, source: str) -> None:
    at = x[np.nonzero(bad)[0][0]]
    raise ModelgenError(
        source, f"{int(bad.sum())} of {len(x)} points lie off the others, the first at ({at[0]:g}, {at[1]:g})",
        f"{MOST_OUTLIERS:.0%} may be left out", "mend the file, or raise --tolerance",
    )  # fmt: skip


def _nodes(knots: Array, spline: Any, closed: bool) -> Array:
    """Nodes of the spline of the scene: the knots, and of an open one a point in the first and last interval,
    which it has no knot at."""
    at = knots[:-1] if closed else np.sort([*knots, (knots[0] + knots[1]) / 2, (knots[-2] + knots[-1]) / 2])
    return np.asarray(spline(at))


def _judged(nodes: Array, x: Array, closed: bool, noise: float, outliers: tuple[int, ...]) -> Fitted:
    """The fit with the deviation of the points from the spline that the scene takes through its nodes."""
    samples, curvature = _sampled(nodes, closed)
    off = distances(x, samples, closed)
    sharpest = int(np.abs(curvature).argmax())
    at = samples[sharpest]
    return Fitted(
        nodes, noise, float(np.sqrt(np.mean(off**2))), float(np.abs(off).max()), outliers,
        float(1 / np.abs(curvature[sharpest])), (float(at[0]), float(at[1])),
    )  # fmt: skip


def _sampled(nodes: Array, closed: bool) -> tuple[Array, Array]:
    """Points (m, 2) of the spline of the scene through nodes, and its curvatures (m,), 1/m."""
    from scipy.interpolate import CubicSpline  # slow to import

    if closed:
        around = np.vstack([nodes, nodes[:1]])
        spline = CubicSpline(_chords(around), around, bc_type="periodic")
    else:
        spline = CubicSpline(_chords(nodes), nodes)
    u = np.linspace(0, spline.x[-1], DENSE * len(nodes) * 5)
    d, dd = spline(u, 1), spline(u, 2)
    bend = (d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]) / (d**2).sum(axis=1) ** 1.5
    return spline(u), bend


def distances(x: Array, samples: Array, closed: bool) -> Array:
    """Distances (n,) of points (n, 2) from the chain of points (m, 2), m."""
    from scipy.spatial import cKDTree  # slow to import

    nearest = cKDTree(samples).query(x)[1]
    best = np.full(len(x), np.inf)
    for side in (-1, 0):
        first = (nearest + side) % len(samples) if closed else np.clip(nearest + side, 0, len(samples) - 2)
        a, b = samples[first], samples[(first + 1) % len(samples)]
        along = b - a
        part = np.clip(((x - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0, 1)
        best = np.minimum(best, np.linalg.norm(x - a - part[:, None] * along, axis=1))
    return best
