"""B-splines and height fields as polynomial cells, each leading to its neighbours where its own end is.

Neighbours join with continuous second derivatives: they are computed from the same control points, each
relative to one of its own, so that nothing of their curvature is lost far from the origin.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from modelgen.geometry.composites.feature_constructors import at_least, at_most, edge, face, linear, smooth
from modelgen.scene.free_form_values import ControlPolygon, HeightField, Knots, Net
from modelgen.scene.scene_types import Composite, Condition, Feature, Pose, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]
Indices = np.ndarray[Any, np.dtype[np.int_]]

CUBIC = 3


class Line:
    """The spans of one direction: which control points a cell has, and its Bernstein points from them."""

    def __init__(self, knots: Knots | Array, degree: int, periodic: bool) -> None:
        inner = np.asarray(knots, dtype=np.float64)
        self.degree, self.periodic = degree, periodic
        self.knots = _wrapped(inner, degree) if periodic else inner
        self.cells = len(inner) - 1 if periodic else len(inner) - 2 * degree - 1
        self.points = self.cells if periodic else self.cells + degree

    def chosen(self, cell: int) -> Indices:
        """Indices (degree + 1,) of the control points of a cell."""
        return np.arange(cell, cell + self.degree + 1) % self.points

    def ends(self, cell: int) -> tuple[float, float]:
        return float(self.knots[cell + self.degree]), float(self.knots[cell + self.degree + 1])

    def bernstein(self, cell: int) -> Array:
        """(degree + 1, degree + 1): control points to Bernstein points, by blossoming at the two ends."""
        a, b = self.ends(cell)
        return np.stack(
            [self._blossom(cell, [a] * (self.degree - j) + [b] * j) for j in range(self.degree + 1)]
        )

    def _blossom(self, cell: int, arguments: Sequence[float]) -> Array:
        """Weights of the control points in the blossom (de Boor's algorithm with an argument per level)."""
        p = self.degree
        weights = np.eye(p + 1)
        t = self.knots[cell : cell + 2 * p + 2]
        for level, x in enumerate(arguments, start=1):
            for k in range(p, level - 1, -1):
                share = (x - t[k]) / (t[k + p + 1 - level] - t[k])
                weights[k] = (1 - share) * weights[k - 1] + share * weights[k]
        return np.asarray(weights[p])

    def neighbour(self, cell: int, step: int) -> int | None:
        """The next cell in a direction, or None at an end."""
        other = cell + step
        if self.periodic:
            return other % self.cells
        return other if 0 <= other < self.cells else None


def _wrapped(breakpoints: Array, degree: int) -> Array:
    """The knots of a period, continued to both sides."""
    steps = np.diff(breakpoints)
    count = len(steps)
    before = breakpoints[0] - np.cumsum([steps[-1 - k % count] for k in range(degree)])[::-1]
    after = breakpoints[-1] + np.cumsum([steps[k % count] for k in range(degree)])
    return np.concatenate([before, breakpoints, after])


def bspline(shape: Shape) -> Composite:
    """The cells of a B-spline surface, faces `cell_i_j` of kind `bezier`."""
    net = shape.spline
    assert isinstance(net, Net)
    u, v = (Line(net.knots[k], net.degree, net.periodic[k]) for k in (0, 1))
    points = np.array(net.points)

    def cell(i: int, j: int) -> Feature:
        local = points[np.ix_(u.chosen(i), v.chosen(j))]
        first, offsets = _offsets(local, (u.bernstein(i), v.bernstein(j)))
        shape = smooth("bezier", Pose(), **_named(first, offsets))
        return face(
            _name(i, j),
            shape,
            *_sides(u, 0, i, lambda k: _name(k, j)),
            *_sides(v, 1, j, lambda k: _name(i, k)),
        )

    return Composite(tuple(cell(i, j) for i, j in product(range(u.cells), range(v.cells))), convex=False)


def height_field(shape: Shape) -> Composite:
    """The cells of the bicubic spline through the heights, faces `cell_i_j` of kind `bezier_graph`.

    The spline has not-a-knot ends: the two outer spans of a direction are one polynomial (de Boor, A
    Practical Guide to Splines, 2001, ch. IV).
    """
    from scipy.interpolate import make_interp_spline  # slow to import, and needed by height fields alone

    field = shape.spline
    assert isinstance(field, HeightField)
    along_x = make_interp_spline(np.array(field.x), np.array(field.heights), k=CUBIC)
    along_y = make_interp_spline(np.array(field.y), along_x.c.T, k=CUBIC)
    x, y = (Line(spline.t, CUBIC, periodic=False) for spline in (along_x, along_y))
    points = along_y.c.T[..., None]

    def cell(i: int, j: int) -> Feature:
        local = points[np.ix_(x.chosen(i), y.chosen(j))]
        first, offsets = _offsets(local, (x.bernstein(i), y.bernstein(j)))
        (x0, x1), (y0, y1) = x.ends(i), y.ends(j)
        numbers = {"x0": x0, "width_x": x1 - x0, "y0": y0, "width_y": y1 - y0, "z": float(first[0])}
        numbers |= {f"z_{k}": float(offset[0]) for k, offset in enumerate(offsets, start=1)}
        return face(
            _name(i, j), smooth("bezier_graph", Pose(), **numbers),
            *_walls(x, 0, i, lambda k: _name(k, j)), *_walls(y, 1, j, lambda k: _name(i, k)),
        )  # fmt: skip

    return Composite(tuple(cell(i, j) for i, j in product(range(x.cells), range(y.cells))), convex=False)


def bspline_curve(shape: Shape) -> Composite:
    """The pieces of a B-spline curve, `piece_i` of kind `bezier_curve`."""
    polygon = shape.spline
    assert isinstance(polygon, ControlPolygon)
    line = Line(polygon.knots, polygon.degree, polygon.periodic)
    points = np.array(polygon.points)

    def piece(i: int) -> Feature:
        first, offsets = _offsets(points[line.chosen(i)], (line.bernstein(i),))
        shape = smooth("bezier_curve", Pose(), **_named(first, offsets))
        return edge(f"piece_{i}", shape, *_sides(line, 0, i, lambda k: f"piece_{k}"))

    return Composite(tuple(piece(i) for i in range(line.cells)), convex=False)


def _offsets(local: Array, transforms: Sequence[Array]) -> tuple[Array, Array]:
    """The first Bernstein point, and the others less the first, without loss far from the origin."""
    base = local.reshape(-1, local.shape[-1])[0]
    points = local - base
    for axis, transform in enumerate(transforms):
        points = np.moveaxis(np.tensordot(transform, points, axes=(1, axis)), 0, axis)
    flat = points.reshape(-1, local.shape[-1])
    return base + flat[0], flat[1:] - flat[0]


def _named(first: Array, offsets: Array) -> dict[str, float]:
    """x, y, z of the first point, then x_1, y_1, z_1, ... of the offsets."""
    numbers = dict(zip("xyz", map(float, first), strict=True))
    for index, offset in enumerate(offsets, start=1):
        numbers |= {f"{axis}_{index}": float(value) for axis, value in zip("xyz", offset, strict=True)}
    return numbers


def _name(i: int, j: int) -> str:
    return f"cell_{i}_{j}"


def _next(line: Line, cell: int, step: int, name: Callable[[int], str]) -> str | None:
    other = line.neighbour(cell, step)
    return None if other is None else name(other)


def _sides(line: Line, index: int, cell: int, name: Callable[[int], str]) -> tuple[Condition, Condition]:
    """0 <= eta_index <= 1."""
    return (
        at_least(index, 0.0, _next(line, cell, -1, name)),
        at_most(index, 1.0, _next(line, cell, 1, name)),
    )


def _walls(line: Line, index: int, cell: int, name: Callable[[int], str]) -> tuple[Condition, Condition]:
    """x or y between the ends of the cell, so that cells work with any parametrisation of their points."""
    conditions = []
    for end, step in zip(line.ends(cell), (-1, 1), strict=True):
        axis, point = np.zeros(3), np.zeros(3)
        axis[index], point[index] = -step, end
        conditions.append(linear(point, axis, _next(line, cell, step, name)))
    return conditions[0], conditions[1]
