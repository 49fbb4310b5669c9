"""Whether the user's own surfaces and curves are fit for contacts: regular, with their exterior outside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import casadi as ca
import numpy as np

from modelgen.errors import SceneError
from modelgen.geometry.curves import curve_of
from modelgen.geometry.frames import cross
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.scene.free_form_values import ControlPolygon, Net
from modelgen.scene.scene_types import Chart, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]
Area = Callable[[Array], tuple[Array, Array]]
Domain = tuple[tuple[float, float], tuple[float, float]]

_PAIRS = ((0, 0), (0, 1), (1, 0), (1, 1))  # (axis, end)
UNIT: Domain = ((0.0, 1.0), (0.0, 1.0))
GRID = 33  # samples of a chart in each direction, and of a curve
CELL_GRID = 9  # samples of a cell of a B-spline in each direction
ZOOM = 9  # samples around the worst one in each direction
ROUNDS = 14  # of zooming, each to the samples next to the worst
REGULAR = 1e-6  # least |c_u x c_v|, or |c'|, against the largest


@dataclass(frozen=True)
class Worst:
    """Place where |c_u x c_v| or |c'| is least, and its ratio to the largest value."""

    at: tuple[float, ...]
    ratio: float


@lru_cache(maxsize=256)
def check_user_shape(shape: Shape) -> tuple[str, ...]:
    """Warnings on a chart, curve, spline or solid of the user's own; SceneError where no contact could run.

    A chart must not degenerate inside its domain; where it does at an end of it, which is no declared pole,
    it is warned. A closed chart or control net must have c_u x c_v pointing outwards.
    """
    if shape.solid is not None:
        return tuple(text for each in shape.solid.features for text in check_user_shape(each.shape))
    if shape.curve is not None or isinstance(shape.spline, ControlPolygon):
        _check_curve(shape)
        return ()
    if shape.chart is not None:
        return _check_chart(shape)
    if isinstance(shape.spline, Net):
        _check_net(shape, shape.spline)
    return ()


def _check_chart(shape: Shape) -> tuple[str, ...]:
    chart = shape.chart
    assert chart is not None
    area = partial(_area_vectors(shape), _values(shape))
    points = _degenerate_ends(area, chart.domain)
    ends = [(points[k][0] or chart.poles[k][0], points[k][1] or chart.poles[k][1]) for k in (0, 1)]
    worst = _worst(partial(_area, area), [_axis(chart.domain[k], ends[k]) for k in (0, 1)])
    if worst.ratio <= REGULAR:
        u, v = worst.at
        raise SceneError(
            f"shape {shape.name!r}", f"c_u x c_v vanishes at u = {u:.6g}, v = {v:.6g}",
            "the two tangents of a chart span its tangent plane",
            "mend x, y, z or leave that part of the domain out",
        )  # fmt: skip
    if all(chart.periodic[k] or all(chart.poles[k]) for k in (0, 1)):
        _check_outside(shape, _volume(area, chart.domain, GRID))
    return tuple(
        _undeclared(shape, chart, axis, end) for axis, end in _PAIRS if _is_new(chart, points, axis, end)
    )


def _is_new(chart: Chart, points: Sequence[Sequence[bool]], axis: int, end: int) -> bool:
    return points[axis][end] and not chart.poles[axis][end]


def _undeclared(shape: Shape, chart: Chart, axis: int, end: int) -> str:
    name, value = "uv"[axis], chart.domain[axis][end]
    side = f"{name}_{('min', 'max')[end]}"
    return (
        f"shape {shape.name!r}: c_u x c_v vanishes at {name} = {value:.6g}; a contact cannot pass there;"
        f' if it is a smooth pole, declare it in poles = ["{side}"]'
    )


def _check_net(shape: Shape, net: Net) -> None:
    cells = features_of(replace(shape, cavity=False)).features
    vectors = _area_vectors(cells[0].shape)
    areas = [partial(vectors, _values(cell.shape)) for cell in cells]
    samples = (np.linspace(0, 1, CELL_GRID),) * 2
    least = [_least(partial(_area, area), samples)[1] for area in areas]
    weakest = min(range(len(cells)), key=least.__getitem__)
    worst = _worst(partial(_area, areas[weakest]), samples)
    if worst.ratio <= REGULAR:
        raise SceneError(
            f"shape {shape.name!r}", f"the surface has no tangent plane in {cells[weakest].name}",
            "neighbouring control points span a surface", "move them apart",
        )  # fmt: skip
    if all(net.periodic):
        _check_outside(shape, sum(_volume(area, UNIT, CELL_GRID) for area in areas))


def _check_outside(shape: Shape, volume: float) -> None:
    if volume < 0:
        remedy = "swap u and v, the first and the second direction; cavity = true puts the material outside"
        raise SceneError(
            f"shape {shape.name!r}", f"its exterior side is the inside (volume {volume:.4g} m^3)",
            "c_u x c_v of a closed surface points outwards", remedy,
        )  # fmt: skip


def _check_curve(shape: Shape) -> None:
    parts = [shape] if shape.curve is not None else [each.shape for each in features_of(shape).features]
    for part in parts:
        t = ca.SX.sym("t")
        jet = curve_of(part).jet(t, ca.SX(ca.DM(_values(part))))
        speed = ca.Function("speed", [t], [ca.norm_2(ca.densify(jet.first))])
        worst = _worst(partial(_speed, speed), (np.linspace(*curve_of(part).domain, GRID),))
        if worst.ratio <= REGULAR:
            raise SceneError(
                f"shape {shape.name!r}", f"the curve stands still at t = {worst.at[0]:.6g}",
                "the derivative of a curve is not zero", "choose another parameter, or leave a cusp out",
            )  # fmt: skip


def _worst(size: Callable[[Array], Array], axes: Sequence[Array]) -> Worst:
    """The least value on a grid, refined around it."""
    lower, upper = (np.array([axis[end] for axis in axes]) for end in (0, -1))
    at, least, largest = _least(size, axes)
    steps = np.array([axis[1] - axis[0] for axis in axes])
    for _ in range(ROUNDS):
        near = [
            np.linspace(max(a - h, low), min(a + h, high), ZOOM)
            for a, h, low, high in zip(at, steps, lower, upper, strict=True)
        ]
        at, least, _ = _least(size, near)
        steps = steps * (2 / (ZOOM - 1))
    return Worst(tuple(map(float, at)), least / largest if largest > 0 else 0.0)


def _least(size: Callable[[Array], Array], axes: Sequence[Array]) -> tuple[Array, float, float]:
    grid = np.array([entry.ravel() for entry in np.meshgrid(*axes, indexing="ij")])
    values = np.nan_to_num(size(grid), nan=0.0)
    index = int(np.argmin(values))
    return grid[:, index], float(values[index]), float(values.max())


def _axis(ends: tuple[float, float], poles: tuple[bool, bool]) -> Array:
    """Samples of a domain without its poles."""
    samples = np.linspace(*ends, GRID)
    return samples[int(poles[0]) : GRID - int(poles[1])]


def _degenerate_ends(area: Area, domain: Domain) -> list[list[bool]]:
    """For both ends of u and of v, whether the chart degenerates all along."""
    axes = [np.linspace(*ends, GRID) for ends in domain]
    largest = np.nan_to_num(_area(area, np.array([entry.ravel() for entry in np.meshgrid(*axes)]))).max()
    found = [[False, False], [False, False]]
    for axis, end in _PAIRS:
        held = np.full(GRID, domain[axis][end])
        at = np.array([held, axes[1]] if axis == 0 else [axes[0], held])
        found[axis][end] = not (_area(area, at) > REGULAR * largest).any()
    return found


def _area(area: Area, uv: Array) -> Array:
    """|c_u x c_v| (n,)."""
    return np.asarray(np.linalg.norm(area(uv)[1], axis=0))


def _speed(speed: ca.Function, t: Array) -> Array:
    return np.asarray(np.asarray(speed(t))[0])


def _area_vectors(shape: Shape) -> Callable[[Array, Array], tuple[Array, Array]]:
    """Parameters and uv (2,n) -> points (3,n) and c_u x c_v (3,n) of a kind of surface."""
    uv, p = ca.SX.sym("uv", 2), ca.SX.sym("p", len(shape.parameters))
    jet = surface_of(shape).jet(uv, p)
    outputs = [ca.densify(jet.x), ca.densify(cross(jet.first[:, 0], jet.first[:, 1]))]
    function = ca.Function("area_vectors", [uv, p], outputs)

    def evaluate(numbers: Array, at: Array) -> tuple[Array, Array]:
        x, area = function(at, numbers)
        return np.asarray(x), np.asarray(area)

    return evaluate


def _volume(area: Area, domain: Domain, count: int) -> float:
    """The flux of x/3 by midpoints: the volume inside, roughly, of a closed surface."""
    steps = [(upper - lower) / count for lower, upper in domain]
    axes = [lower + (np.arange(count) + 0.5) * step for (lower, _), step in zip(domain, steps, strict=True)]
    x, dA = area(np.array([entry.ravel() for entry in np.meshgrid(*axes, indexing="ij")]))
    return float(np.sum(x * dA) / 3 * steps[0] * steps[1])


def _values(shape: Shape) -> Array:
    return np.array([value for _, value in shape.parameters])
