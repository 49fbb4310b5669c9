"""Free forms given by points: control nets, heights on a grid, control polygons, polylines. Lengths in m."""

from __future__ import annotations

from dataclasses import dataclass

Point = tuple[float, float, float]
Knots = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Net:
    """A tensor-product B-spline surface; u runs along the first index of its control points."""

    points: tuple[tuple[Point, ...], ...]
    degree: int
    knots: tuple[Knots, Knots]  # all of them; a period's breakpoints in a periodic direction
    periodic: tuple[bool, bool]


@dataclass(frozen=True, slots=True)
class HeightField:
    """z over a rectangular grid, interpolated by the bicubic spline with continuous second derivatives."""

    x: tuple[float, ...]
    y: tuple[float, ...]
    heights: tuple[tuple[float, ...], ...]  # [x][y]


@dataclass(frozen=True, slots=True)
class ControlPolygon:
    """A B-spline curve."""

    points: tuple[Point, ...]
    degree: int
    knots: Knots
    periodic: bool


@dataclass(frozen=True, slots=True)
class Polyline:
    """Straight pieces between points, its corners rounded by arcs of one radius."""

    points: tuple[Point, ...]
    radius: float
    closed: bool


Spline = Net | HeightField | ControlPolygon | Polyline
