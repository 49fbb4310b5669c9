"""B-spline surfaces and curves, height fields and polylines from the values of their tables."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from math import acos, dist, pi, tan
from typing import Any

from modelgen.scene.free_form_values import ControlPolygon, HeightField, Knots, Net, Point, Polyline
from modelgen.scene.scalar_types import NUMBER, POSITIVE, Switch, Whole
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Sequence

CUBIC = 3  # the lowest degree with continuous curvature
MOST = 10_000  # points of one shape
STRAIGHT = 1e-9  # rad, turn of a corner that is none
ROUNDING = 1e-12  # of a straight piece between two arcs that touch, against its length

_POINT = Sequence(NUMBER, 3)
_KNOTS = Sequence(NUMBER, None)
_DEGREE = Field(
    "degree", Whole(CUBIC, 5), "polynomial degree; curvature is continuous from 3 up", default=CUBIC
)
_UNIFORM = "all of them, not decreasing, or the breakpoints of one period; uniform and clamped if absent"

NET_FIELDS = (
    Field(
        "points", Sequence(Sequence(_POINT, None), None),
        "control net, a list of rows of points [x, y, z], m; u counts rows, (along u) x (along v) is outside",
        required=True,
    ),
    _DEGREE,
    Field("knots", Sequence(_KNOTS, 2), f"knots [of u, of v]: {_UNIFORM}", default=((), ())),
    Field("periodic", Sequence(Switch(), 2), "whether the net closes along [u, v]", default=(False, False)),
)  # fmt: skip

HEIGHT_FIELDS = (
    Field("x", _KNOTS, "x of the grid, increasing, m", required=True),
    Field("y", _KNOTS, "y of the grid, increasing, m", required=True),
    Field(
        "heights",
        Sequence(_KNOTS, None),
        "z over the grid, m, a row over y for each x; exterior +z",
        required=True,
    ),
)

POLYGON_FIELDS = (
    Field("points", Sequence(_POINT, None), "control points [x, y, z], m", required=True),
    _DEGREE,
    Field("knots", _KNOTS, f"knots: {_UNIFORM}", default=()),
    Field("periodic", Switch(), "whether the curve closes", default=False),
)

POLYLINE_FIELDS = (
    Field("points", Sequence(_POINT, None), "the corners [x, y, z], m", required=True),
    Field("radius", POSITIVE, "radius of the rounded corners, m", required=True),
    Field("closed", Switch(), "whether the last point joins the first", default=False),
)


def read_net(values: Mapping[str, Any], place: Place) -> Net:
    """The control net of a B-spline surface; raises SceneError."""
    points, degree = values["points"], values["degree"]
    sizes = (len(points), len(points[0]) if points else 0)
    _check_grid(points, sizes[1], place.key("points"))
    at = place.key("knots")
    of_u, of_v = (
        _knots(values["knots"][k], sizes[k], degree, values["periodic"][k], at.item(k), place.key("points"))
        for k in range(2)
    )
    return Net(points, degree, (of_u, of_v), values["periodic"])


def read_polygon(values: Mapping[str, Any], place: Place) -> ControlPolygon:
    """The control polygon of a B-spline curve; raises SceneError."""
    points, degree, periodic = values["points"], values["degree"], values["periodic"]
    _check_count(len(points), place.key("points"))
    knots = _knots(values["knots"], len(points), degree, periodic, place.key("knots"), place.key("points"))
    return ControlPolygon(points, degree, knots, periodic)


def read_heights(values: Mapping[str, Any], place: Place) -> HeightField:
    """The grid and the heights of a height field; raises SceneError."""
    for key in "xy":
        grid, at = values[key], place.key(key)
        if len(grid) <= CUBIC:
            raise at.error(f"{len(grid)} values", f"at least {CUBIC + 1} are needed")
        for index, (a, b) in enumerate(pairwise(grid), start=1):
            if not a < b:
                raise at.item(index).error(f"{b:g} after {a:g}", "the grid increases")
    at = place.key("heights")
    if len(values["heights"]) != len(values["x"]):
        raise at.error(f"{len(values['heights'])} rows", f"x has {len(values['x'])} values, one for each row")
    _check_grid(values["heights"], len(values["y"]), at)
    return HeightField(values["x"], values["y"], values["heights"])


def read_polyline(values: Mapping[str, Any], place: Place) -> Polyline:
    """The corners of a polyline; raises SceneError where the arcs have no room."""
    points, radius, closed = values["points"], values["radius"], values["closed"]
    at = place.key("points")
    fewest = 3 if closed else 2
    if len(points) < fewest:
        raise at.error(f"{len(points)} points", f"at least {fewest} are needed")
    _check_count(len(points), at)
    round_trip = (*points, points[0]) if closed else points
    for index, (a, b) in enumerate(pairwise(round_trip), start=1):
        if dist(a, b) <= 0:
            raise at.item(index % len(points)).error("a point equal to the one before", "", "leave it out")
    taken = [_setback(points, radius, k, closed, at) for k in range(len(points))]
    for index, (a, b) in enumerate(pairwise(round_trip)):
        needed = taken[index] + taken[(index + 1) % len(points)]
        if needed > dist(a, b) * (1 + ROUNDING):
            found = f"arcs that need {needed:.6g} m of the {dist(a, b):.6g} m to the next point"
            raise at.item(index).error(
                found, "rounded corners fit between the points", "use a smaller radius"
            )
    return Polyline(points, radius, closed)


def _setback(points: tuple[Point, ...], radius: float, k: int, closed: bool, place: Place) -> float:
    """Length of both neighbouring pieces that the arc at a corner replaces: radius tan(turn/2), m."""
    if not closed and k in (0, len(points) - 1):
        return 0.0
    a, b, c = points[k - 1], points[k], points[(k + 1) % len(points)]
    along = sum((q - p) * (r - q) for p, q, r in zip(a, b, c, strict=True)) / (dist(a, b) * dist(b, c))
    turn = acos(max(-1.0, min(1.0, along)))
    if turn > pi - 1e-3:
        raise place.item(k).error(f"a turn of {turn:.6g} rad", "a corner turns by less than half a turn")
    return radius * tan(turn / 2) if turn > STRAIGHT else 0.0


def _check_grid(rows: tuple[tuple[Any, ...], ...], width: int, place: Place) -> None:
    for index, row in enumerate(rows):
        if len(row) != width:
            raise place.item(index).error(f"a row of {len(row)}", f"every row has {width}")
    _check_count(len(rows) * width, place)


def _check_count(count: int, place: Place) -> None:
    if count > MOST:
        raise place.error(f"{count} points", f"at most {MOST} are allowed", "use several shapes")


def _knots(written: Knots, count: int, degree: int, periodic: bool, at: Place, points: Place) -> Knots:
    """The knots of `count` control points; if not written uniform, and clamped or around the period."""
    if count <= degree:
        raise points.error(
            f"{count} control points in a direction", f"degree {degree} needs at least {degree + 1}"
        )
    if not written:
        spans = count if periodic else count - degree
        inner = tuple(float(k) for k in range(spans + 1))
        return inner if periodic else (0.0,) * degree + inner + (inner[-1],) * degree
    wanted = count + 1 if periodic else count + degree + 1
    if len(written) != wanted:
        raise at.error(f"{len(written)} knots", f"{count} control points of degree {degree} need {wanted}")
    low, high = (0, count) if periodic else (degree, count)
    for index, (a, b) in enumerate(pairwise(written), start=1):
        if b < a or (a == b and low < index <= high):
            allowed = "knots do not decrease, and increase over the domain: the surface stays smooth"
            raise at.item(index).error(f"the knot {b:g} after {a:g}", allowed)
    return written
