"""A smooth cubic spline through few nodes from many points that were measured with noise.

Its nodes lie on the least-squares spline of some intervals, which are halved where the points, on average
over a part of an interval, lie off the spline through the nodes by more than a tolerance (de Boor, A
Practical Guide to Splines, 2001, ch. XIV). The noise is taken from fourth divided differences. The points of
an interval that has too few to be halved are nodes themselves. Where it would have to be halved because the
profile turns as in a corner, the fit is refused.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.scene.interpolating_splines import MOST

Array = np.ndarray[Any, np.dtype[np.float64]]
Mask = np.ndarray[Any, np.dtype[np.bool_]]
Places = np.ndarray[Any, np.dtype[np.intp]]

FARTHEST = 1e9  # m, of a coordinate
REPEATED = 1e-12  # distance of points over the length of the profile that are one
FLAT = 1e-9  # width of an outline over its length that is none
FIRST = 4  # intervals of the coarsest spline
PARTS = 4  # parts of an interval over which points are averaged
FEWEST = 4  # points of a part
SURE = 4.0  # standard deviations of an average that are no chance
OUTLIER = 6.0  # standard deviations of a point that is none of the profile
BESIDE = 8  # points beside a spike that shares in what makes its neighbours no cubic
MOST_OUTLIERS = 0.02  # part of all points
JUMP = 1 / 8  # of a jump of curvature and the square of the distance of points
ISOLATED = 2.0  # curvature at a corner over that of the points beside it
ROUNDS = 40
PROJECTIONS = 3  # times that points find their parameters anew on the spline
DENSE = 100  # samples of an interval, to find the least radius of curvature
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


def fit_profile(
    points: Array, closed: bool = False, tolerance: float | None = None, source: str = "profile"
) -> Fitted:
    """The spline of few nodes near points in the order of the profile.

    Args:
        points: (n, 2) m.
        closed: whether the first point follows the last.
        tolerance: by which averages of points may lie off the spline, m; the noise when None.
        source: of the points, for messages.

    Raises:
        ModelgenError: too few points, points out of order, or a corner.
    """
    x, kept = _checked(np.asarray(points, dtype=float), closed, source)
    noise = noise_of(x, closed)
    allowed = noise if tolerance is None else tolerance
    limit = OUTLIER * max(noise, allowed) + _jump(x, closed)
    near = _spikes(x, closed, limit)
    outliers, x, kept, limit = kept[near], x[~near], kept[~near], limit[~near]
    nodes, off = _refined(x, closed, allowed, noise, source)
    bad = np.abs(off) > limit
    if bad.any():
        if bad.mean() > MOST_OUTLIERS:
            _refuse_noise(x, bad, source)
        outliers = np.sort([*outliers, *kept[bad]])
        nodes, off = _refined(x[~bad], closed, allowed, noise, source)
    least, at = _sharpest(nodes, closed)
    rms, largest = float(np.sqrt(np.mean(off**2))), float(np.abs(off).max())
    return Fitted(nodes, noise, rms, largest, tuple(map(int, outliers)), least, at)


def noise_of(x: Array, closed: bool) -> float:
    """Standard deviation of points (n, 2) across the line that they follow, m, from five at a time."""
    size = float(np.ptp(x, axis=0).max())
    return max(float(np.median(np.abs(_differences(x, closed)))) / MAD, SMALLEST * size)


def _differences(x: Array, closed: bool) -> Array:
    """(n - 4,) or, closed, (n,): how far five points are from a cubic, across their line, m.

    Divided differences with weights of unit length: their standard deviation is that of a point. The middle
    points are 2, 3, ... of the given ones.
    """
    around = np.vstack([x[-2:], x, x[:2]]) if closed else x
    windows = np.lib.stride_tricks.sliding_window_view(_chords(around), 5)
    gaps = windows[:, :, None] - windows[:, None, :]
    length = gaps[:, -1:, :1]
    gaps = gaps / np.where(length > 0, length, 1.0)
    order = np.sign(np.arange(5)[:, None] - np.arange(5))
    gaps = np.where(gaps == 0, REPEATED * order, gaps)  # points that meet once those between are left out
    gaps[:, np.arange(5), np.arange(5)] = 1.0
    weights = 1 / gaps.prod(axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    values = np.lib.stride_tricks.sliding_window_view(around, 5, axis=0)  # (windows, 2, 5)
    found = np.einsum("kc,kac->ka", weights, values)
    return _part_across(found, around[4:] - around[:-4])


def _part_across(span: Array, along: Array) -> Array:
    """(n,) parts of vectors (n, 2) across directions (n, 2), to the left; their lengths where there is no
    direction."""
    length = np.linalg.norm(along, axis=1)
    across = span[:, 1] * along[:, 0] - span[:, 0] * along[:, 1]
    return np.asarray(np.divide(across, length, out=np.linalg.norm(span, axis=1), where=length > 0))


def _jump(x: Array, closed: bool) -> Array:
    """(n,) m, by how much points of a smooth profile may lie off a cubic through their neighbours, where its
    curvature jumps by all that it is beside them, as between a line and an arc."""
    bend, width, _ = _bends(x, closed, 0.0)
    return np.asarray(JUMP * np.maximum(bend[:, 0], bend[:, 4]) * width**2)


def _spikes(x: Array, closed: bool, limit: Array) -> Mask:
    """(n,) whether a point is farther than a limit (n,) from a cubic through its neighbours, and they are not
    without it.

    Where they still are, the profile is not smooth there, and its points are kept.
    """
    first = 0 if closed else 2
    kept, removed = np.arange(len(x)), np.zeros(len(x), dtype=bool)
    for last in (False, False, False, True):
        off = np.abs(_differences(x[kept], closed))
        far = off > limit[kept][first : len(kept) - first]
        peaks = np.nonzero(far & (off >= _highest_beside(off)))[0] + first
        if last:
            for place in kept[peaks]:
                removed[max(0, place - BESIDE) : place + BESIDE + 1] = False
            break
        removed[kept[peaks]] = True
        kept = np.nonzero(~removed)[0]
    return removed


def _highest_beside(values: Array) -> Array:
    """The largest of each value and the four beside it."""
    wide = np.pad(values, 2, constant_values=-np.inf)
    return np.asarray(np.lib.stride_tricks.sliding_window_view(wide, 5).max(axis=1))


def _checked(x: Array, closed: bool, source: str) -> tuple[Array, Places]:
    """The points but for repeated ones, and their places among the given."""
    if x.ndim != 2 or x.shape[1] != 2 or not np.isfinite(x).all():
        raise ModelgenError(source, "points that are no pairs of finite numbers", "", "mend the file")
    if np.abs(x).max(initial=0.0) > FARTHEST:
        found = f"a coordinate of {np.abs(x).max():.3g} m"
        raise ModelgenError(source, found, f"at most {FARTHEST:g} m", "mend the file, or name its --unit")
    if closed and len(x) > 1 and np.array_equal(x[0], x[-1]):
        x = x[:-1]
    steps = np.linalg.norm(np.diff(x, axis=0), axis=1)
    apart = np.append(True, steps > REPEATED * steps.sum())[: len(x)]
    x, places = x[apart], np.nonzero(apart)[0]
    fewest = FIRST * PARTS * FEWEST
    if len(x) < fewest:
        raise ModelgenError(
            source, f"{len(x)} points", f"a profile that is fitted has {fewest} at least",
            "write the points into the scene, which interpolates them",
        )  # fmt: skip
    length, width = np.linalg.svd(x - x.mean(axis=0), compute_uv=False)
    if closed and width <= FLAT * length:
        raise ModelgenError(source, "points on a line", "an outline around an area", "mend the file")
    steps = np.diff(x, axis=0)
    back = np.nonzero((steps[1:] * steps[:-1]).sum(axis=1) < 0)[0]
    if len(back) > len(x) // 20:
        at = x[back[0] + 1]
        raise ModelgenError(
            source, f"points that go to and fro, first at ({at[0]:g}, {at[1]:g})",
            "points follow each other along the profile",
            "sort them, or take fewer, if their noise is as large as their distance",
        )  # fmt: skip
    return x, places


def _chords(x: Array) -> Array:
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1)))


def _refined(x: Array, closed: bool, tolerance: float, noise: float, source: str) -> tuple[Array, Array]:
    """Nodes of the spline of the scene, and the distances of the points across it, m."""
    u = _chords(np.vstack([x, x[:1]]) if closed else x)
    knots = np.linspace(0.0, u[-1], FIRST + 1)
    u = u[: len(x)]
    as_measured = np.zeros(FIRST, dtype=bool)  # intervals whose points are nodes
    for _ in range(ROUNDS):
        spline = _least_squares(x, u, knots, closed, source)
        for _ in range(PROJECTIONS):
            u = _projected(x, u, spline, knots, closed)
            spline = _least_squares(x, u, knots, closed, source)
        at, nodes = _nodes(x, u, knots, spline, as_measured, closed)
        if not np.diff(_chords(nodes)).all():
            raise _uneven(source)
        off = _across(x, u, at, nodes, closed)
        split = _to_halve(off, u, knots, tolerance, noise) & ~as_measured
        if not split.any():
            break
        counts = np.histogram(u, knots)[0]
        _check_corners(x, u, knots, split & (counts < 2 * FEWEST), noise, closed, source)
        halved = split & (counts >= FEWEST)
        as_measured = np.repeat(as_measured | (split & ~halved), 1 + halved)
        knots = np.sort(np.append(knots, (knots[:-1] + knots[1:])[halved] / 2))
        if len(nodes) + halved.sum() > MOST:
            raise ModelgenError(
                source, "a profile that so few nodes do not follow", f"{MOST} nodes at most",
                "split the file, or raise --tolerance",
            )  # fmt: skip
    return nodes, off


def _least_squares(x: Array, u: Array, knots: Array, closed: bool, source: str) -> Any:
    """The cubic spline with these knots nearest to the points; of a closed profile beyond one turn. Raises
    ModelgenError where the points leave it open."""
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
    with suppress(ValueError, np.linalg.LinAlgError):  # a part of the spline has too few points
        spline = make_lsq_spline(values, points, t, k=3)
        if np.isfinite(spline.c).all():
            return spline
    raise _uneven(source)


def _uneven(source: str) -> ModelgenError:
    return ModelgenError(
        source, "points that are too unevenly apart for a spline", "points follow each other closely",
        "mend those that lie far off, or measure it more densely",
    )  # fmt: skip


def _projected(x: Array, u: Array, spline: Any, knots: Array, closed: bool) -> Array:
    """Parameters of the nearest points of the spline, by one step of Newton's method of first order.

    No point moves by more than half a way to its neighbours; the ends of an open profile stay at its ends.
    """
    step = _step_along(x - spline(u), spline(u, 1))
    apart = np.diff(u)
    most = np.minimum(np.append(apart, apart[-1]), np.append(apart[0], apart)) / 2
    moved = u + np.clip(step, -most, most)
    if closed:
        return np.asarray(moved)
    return np.asarray(knots[0] + (moved - moved[0]) * (knots[-1] - knots[0]) / (moved[-1] - moved[0]))


def _step_along(span: Array, along: Array) -> Array:
    """(n,) steps of parameters that take points of a spline by the parts of vectors (n, 2) along its
    derivatives (n, 2); none where it stands still."""
    squared = (along**2).sum(axis=1)
    return np.asarray(
        np.divide((span * along).sum(axis=1), squared, out=np.zeros(len(span)), where=squared > 0)
    )


def _across(x: Array, u: Array, at: Array, nodes: Array, closed: bool) -> Array:
    """Signed distances of points from the spline of the scene through nodes, across it.

    Its parameter is the length of the chords; that of a point is sought from where it is between its nodes.
    """
    spline = _interpolated(nodes, closed)
    t = np.interp(u, at, spline.x)
    for _ in range(PROJECTIONS):
        t = t + _step_along(x - spline(t), spline(t, 1))
        t = t if closed else np.clip(t, spline.x[0], spline.x[-1])
    return _part_across(x - spline(t), spline(t, 1))


def _interpolated(nodes: Array, closed: bool) -> Any:
    """The spline of the scene (scene/interpolating_splines.py) through nodes, over the length of chords."""
    from scipy.interpolate import CubicSpline  # slow to import

    if closed:
        around = np.vstack([nodes, nodes[:1]])
        return CubicSpline(_chords(around), around, bc_type="periodic")
    return CubicSpline(_chords(nodes), nodes)


def _to_halve(off: Array, u: Array, knots: Array, tolerance: float, noise: float) -> Mask:
    """(k,) whether the points of an interval lie off the spline, on average over a part of it, by more than
    the tolerance and other than by chance."""
    place = _intervals_of(u, knots)
    found = np.zeros(len(knots) - 1, dtype=bool)
    for k in range(len(knots) - 1):
        own = off[place == k]
        parts = np.array_split(own, max(1, min(PARTS, len(own) // FEWEST)))
        for part in parts:
            if len(part):
                middle = float(np.median(part))
                found[k] |= abs(middle) > max(tolerance, SURE * noise / np.sqrt(len(part)))
    return found


def _intervals_of(u: Array, knots: Array) -> Places:
    return np.clip(np.searchsorted(knots, u, side="right") - 1, 0, len(knots) - 2)


def _check_corners(
    x: Array, u: Array, knots: Array, few: Mask, noise: float, closed: bool, source: str
) -> None:
    """Raises ModelgenError where the profile turns at one or two points of an interval and not beside them.

    The curvature at a point of a smooth profile, whose points show it, is not above twice that of both its
    neighbours and of both points beyond them by more than noise makes of it.
    """
    bend, _, chance = _bends(x, closed, noise)
    smooth = np.maximum(np.minimum(bend[:, 1], bend[:, 3]), np.maximum(bend[:, 0], bend[:, 4]))
    bend, place = bend[:, 2], _intervals_of(u, knots)
    corner = few[place] & (bend > ISOLATED * smooth + chance)
    if corner.any():
        k = int(np.argmax(np.where(corner, bend, 0.0)))
        reach = float(np.diff(knots)[place[k]])
        raise ModelgenError(
            source, f"a corner, or too few points, near ({x[k][0]:.4g}, {x[k][1]:.4g}) m: the profile "
            f"turns by {np.degrees(_turn(x, u, u[k], reach)):.0f} degrees within {4 * reach:.2g} m",
            "a profile is smooth", "split the file there, measure it more densely, or raise --tolerance",
        )  # fmt: skip


def _bends(x: Array, closed: bool, noise: float) -> tuple[Array, Array, Array]:
    """Curvature of circles through three points each.

    Returns:
        (n, 5) of points (n, 2) and the two on both sides of them, 1/m, 0 at and beyond the ends; (n,) the
        mean distance of a point from its neighbours, m; (n,) the curvature that noise may make, 1/m.
    """
    steps = np.diff(np.vstack([x[-3:], x, x[:3]]) if closed else x, axis=0)
    before, after = steps[:-1], steps[1:]
    sine = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    width = np.lib.stride_tricks.sliding_window_view(np.linalg.norm(steps, axis=1), 2).mean(axis=1)
    bend = np.abs(np.arctan2(sine, (before * after).sum(axis=1))) / width
    if not closed:
        bend, width = np.pad(bend, 3), np.pad(width, 3, mode="edge")
    width = width[2:-2]
    beside = np.lib.stride_tricks.sliding_window_view(bend, 5)
    return beside, width, SURE * np.sqrt(6) * noise / width**2


def _turn(x: Array, u: Array, middle: float, width: float) -> float:
    """Angle between the profile before and after a place, rad."""
    before, after = (
        x[(u > middle - 3 * width) & (u < middle - width)],
        x[(u > middle + width) & (u < middle + 3 * width)],
    )
    if len(before) < 2 or len(after) < 2:
        return 0.0
    a, b = before[-1] - before[0], after[-1] - after[0]
    return float(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def _refuse_noise(x: Array, bad: Mask, source: str) -> None:
    at = x[np.nonzero(bad)[0][0]]
    raise ModelgenError(
        source, f"{int(bad.sum())} of {len(x)} points lie off the others, first ({at[0]:g}, {at[1]:g})",
        f"{MOST_OUTLIERS:.0%} may be left out", "mend the file, or raise --tolerance",
    )  # fmt: skip


def _nodes(
    x: Array, u: Array, knots: Array, spline: Any, as_measured: Mask, closed: bool
) -> tuple[Array, Array]:
    """Nodes of the spline of the scene, and their parameters: points of a spline at its knots, and the points
    of the intervals that stay as they were measured. The parameters of a closed one end after one turn."""
    sites = knots[:-1] if closed else _open_sites(knots)
    touched = as_measured | np.roll(as_measured, 1)  # intervals, and those after them
    at_knot = np.append(touched, as_measured[-1])
    if not closed:
        at_knot[0] = as_measured[0]
    free = sites[~(as_measured[_intervals_of(sites, knots)] | np.isin(sites, knots[at_knot]))]
    own = np.nonzero(as_measured[_intervals_of(u, knots)])[0]
    at = np.concatenate([free, u[own]])
    order = np.argsort(at, kind="stable")
    nodes = np.vstack([spline(free), x[own]])[order]
    at = at[order]
    return (np.append(at, at[0] + knots[-1]) if closed else at), nodes


def _open_sites(knots: Array) -> Array:
    """The knots, and a place in the first and last interval, where an open spline has a node but no knot."""
    return np.sort([*knots, (knots[0] + knots[1]) / 2, (knots[-2] + knots[-1]) / 2])


def _sharpest(nodes: Array, closed: bool) -> tuple[float, tuple[float, float]]:
    """The least radius of curvature of the spline of the scene, m, and its place."""
    spline = _interpolated(nodes, closed)
    u = np.linspace(0, spline.x[-1], DENSE * len(nodes))
    d, dd = spline(u, 1), spline(u, 2)
    bend = (d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]) / (d**2).sum(axis=1) ** 1.5
    k = int(np.abs(bend).argmax())
    x, y = (float(each) for each in spline(u[k]))
    return float(1 / np.abs(bend[k])) if bend[k] else np.inf, (x, y)
