"""Bodies with edges in the scene format: fields, numbers in a fixed order, and what makes them degenerate.

Shape frames: box, cylinder with a length, tube, disc, capsule and frustum centred at the origin, round about
z; half torus the half y >= 0 of a torus about z; extrusion along z, centred in z.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from modelgen.scene.extrusion_profile import read_profile, spline_profile
from modelgen.scene.outline_format import OUTLINE_FIELDS
from modelgen.scene.outline_joining import read_outline
from modelgen.scene.pose_input import VECTOR
from modelgen.scene.scalar_types import NUMBER, POSITIVE, ExpressionText, Switch
from modelgen.scene.shape_catalogue import CURVE_PARAMETER_NAMES, ShapeSpec, torus_constraint
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, NamedNumbers, Sequence
from modelgen.scene.user_chart import check_interval

Point = tuple[float, float]
Reader = Callable[[Mapping[str, Any], Place], dict[str, Any]]

THIN = 1e-6  # extent of a polyhedron in its thinnest direction, against that in its widest
STRAIGHT = 1e-9  # sine of a corner of a polygon that is none
THINNEST = 1e-3  # length of a dome, and of what is cut off from its ball, against the radius


@dataclass(frozen=True, slots=True)
class SolidSpec:
    """One kind of body with edges; `read` gives the keywords of its Shape."""

    kind: str
    doc: str
    fields: tuple[Field, ...]
    read: Reader
    closed: bool = True  # bounds a finite volume
    cavity: bool = False  # may be one
    exclusive: tuple[tuple[str, ...], ...] = ()


LENGTH = Field("length", POSITIVE, "length along z, m", required=True)
_RADIUS = Field("radius", POSITIVE, "radius, m", required=True)


def _outline_wall(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    return {"parameters": (("length", values["length"]),), "outline": read_outline(values, place)}


def _of_numbers(spec: ShapeSpec) -> Reader:
    return lambda values, place: {"parameters": spec.numbers(values, place)}


def _dome_constraint(values: tuple[float, ...]) -> str:
    radius, length = values
    within = THINNEST * radius <= length <= (2 - THINNEST) * radius
    return "" if within else f"length {length:g} of a part of a ball of radius {radius:g}"


def _tube_constraint(values: tuple[float, ...]) -> str:
    radius, bore, _ = values
    return "" if bore < radius else f"bore {bore:g} is not smaller than radius {radius:g}"


POLYHEDRON_FIELDS = (
    Field("vertices", Sequence(VECTOR, None), "points [x, y, z], m, whose convex hull it is", required=True),
)

_OF_T = ExpressionText("expression of t and the parameters, m")

EXTRUSION_FIELDS = (
    Field("points", Sequence(Sequence(NUMBER, 2), None), "corners [x, y] of a polygon in order, m"),
    Field("smooth", Switch(), "a closed spline through the points instead of the polygon", default=False),
    Field("x", _OF_T, "x(t) of a smooth closed outline, m"),
    Field("y", _OF_T, "y(t) of a smooth closed outline, m"),
    Field("domain", Sequence(NUMBER, 2), "[t_min, t_max] of one turn along the outline"),
    Field(
        "parameters",
        NamedNumbers(
            CURVE_PARAMETER_NAMES, "a letter, then letters, digits, single _ (not pi, t) are allowed"
        ),
        "named numbers that x, y may use",
        default=(),
    ),
    LENGTH,
)
POLYGON_OR_OUTLINE = tuple((a, b) for a in ("points", "smooth") for b in ("x", "y", "domain", "parameters"))


def read_polyhedron(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """parameters x0, y0, z0, x1, ...; raises SceneError for points that span no volume."""
    points, at = values["vertices"], place.key("vertices")
    if len(points) < 4:
        raise at.error(f"{len(points)} points", "4 at least, not in one plane, span a body")
    centred = np.array(points) - np.mean(points, axis=0)
    extents = np.linalg.svd(centred, compute_uv=False)
    if extents[2] <= THIN * extents[0]:
        where = "plane" if extents[1] > THIN * extents[0] else "line"
        raise at.error(
            f"{len(points)} points on one {where}", "they must span a volume", "move a point out of it"
        )
    names = (f"{axis}{index}" for index in range(len(points)) for axis in "xyz")
    return {"parameters": tuple(zip(names, (c for point in points for c in point), strict=True))}


def read_extrusion(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """parameters x0, y0, x1, ..., length of a polygon, or length and the user's own of a smooth outline."""
    length = ("length", values["length"])
    if values["points"] is not None and values["smooth"]:
        profile, own = spline_profile(values["points"], place.key("points"))
        return {"parameters": (length, *own), "profile": profile}
    if values["points"] is not None:
        points = _polygon(values["points"], place.key("points"))
        names = (f"{axis}{index}" for index in range(len(points)) for axis in "xy")
        return {"parameters": (*zip(names, (c for point in points for c in point), strict=True), length)}
    missing = [key for key in ("x", "y", "domain") if values[key] is None]
    if missing:
        raise place.error(
            f"an outline without {missing[0]}", "points, or x, y and domain, are needed", f"add {missing[0]}"
        )
    check_interval(values["domain"], place.key("domain"))
    if "length" in dict(values["parameters"]):
        raise place.key("parameters").error(
            "the name 'length'", "length is that of the extrusion", "rename it"
        )
    return {"parameters": (length, *values["parameters"]), "profile": read_profile(values, place)}


def _polygon(points: tuple[Point, ...], place: Place) -> tuple[Point, ...]:
    """The corners counterclockwise; raises SceneError unless they bound one area without crossings."""
    if len(points) < 3:
        raise place.error(f"{len(points)} points", "a polygon has 3 corners at least")
    for k, (a, b, c) in enumerate(_triples(points)):
        size = float(np.hypot(b[0] - a[0], b[1] - a[1]) * np.hypot(c[0] - b[0], c[1] - b[1]))
        if abs(_turn(a, b, c)) <= STRAIGHT * size:
            raise place.item(k).error(
                "a point on one line with its neighbours", "every point is a corner", "leave it out"
            )
    count = len(points)
    sides = [(points[k], points[(k + 1) % count]) for k in range(count)]
    for i, j in combinations(range(count), 2):
        if j - i not in (1, count - 1) and _meet(sides[i], sides[j]):
            raise place.error(
                f"sides {i} and {j} that cross", "a polygon does not meet itself", "reorder points"
            )
    area = sum(a[0] * b[1] - a[1] * b[0] for a, b in sides)
    return points if area > 0 else points[::-1]


def _triples(points: tuple[Point, ...]) -> list[tuple[Point, Point, Point]]:
    """Each point with its two neighbours."""
    return list(zip((points[-1], *points[:-1]), points, (*points[1:], points[0]), strict=True))


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])


def _meet(p: tuple[Point, Point], q: tuple[Point, Point]) -> bool:
    """Whether two segments have a point in common."""
    across = _turn(*p, q[0]) * _turn(*p, q[1]) <= 0 and _turn(*q, p[0]) * _turn(*q, p[1]) <= 0
    boxes = all(
        min(p[0][k], p[1][k]) <= max(q[0][k], q[1][k]) and min(q[0][k], q[1][k]) <= max(p[0][k], p[1][k])
        for k in range(2)
    )
    return across and boxes


_COMPOSITES = (
    ShapeSpec(
        "box", "a box centred at the origin", ("x", "y", "z"),
        (Field("size", Sequence(POSITIVE, 3, "[x, y, z]"), "edges [x, y, z], m", required=True),),
        closed=True, implicit=False,
    ),
    ShapeSpec(
        "disc", "a flat disc in z = 0 without thickness", ("radius",), (_RADIUS,),
        closed=False, implicit=False,
    ),
    ShapeSpec(
        "capsule", "a cylinder about z between two half spheres", ("radius", "length"),
        (_RADIUS, Field("length", POSITIVE, "length of the straight part, m", required=True)),
        closed=True, implicit=False,
    ),
    ShapeSpec(
        "tube", "a cylinder about z with a bore", ("radius", "bore", "length"),
        (_RADIUS, Field("bore", POSITIVE, "radius of the bore, m", required=True), LENGTH),
        closed=True, implicit=False, constraint=_tube_constraint, rule="bore must be smaller than radius",
    ),
    ShapeSpec(
        "frustum", "a truncated cone about z", ("radius_bottom", "radius_top", "length"),
        (
            Field("radius_bottom", POSITIVE, "radius at z = -length/2, m", required=True),
            Field("radius_top", POSITIVE, "radius at z = length/2, m", required=True),
            LENGTH,
        ),
        closed=True, implicit=False,
    ),
    ShapeSpec(
        "dome", "the part of a ball above z = 0: half of it if length is the radius", ("radius", "length"),
        (
            Field("radius", POSITIVE, "radius of the ball, m", required=True),
            Field("length", POSITIVE, "length from the flat base to the top, m", required=True),
        ),
        closed=True, implicit=False, constraint=_dome_constraint,
        rule=f"length is from {THINNEST:g} to {2 - THINNEST:g} times the radius",
    ),
    ShapeSpec(
        "half_torus", "the half y >= 0 of a ring about z", ("major", "minor"),
        (
            Field("major", POSITIVE, "radius of the circle of tube centres, m", required=True),
            Field("minor", POSITIVE, "radius of the tube, m", required=True),
        ),
        closed=True, implicit=False, constraint=torus_constraint, rule="major must be larger than minor",
    ),
)  # fmt: skip


_CAVITIES = ("box", "capsule", "frustum")  # convex: without edges where the material is outside

SOLIDS: Mapping[str, SolidSpec] = {
    spec.kind: SolidSpec(
        spec.kind, spec.doc, spec.fields, _of_numbers(spec), spec.closed, spec.kind in _CAVITIES
    )
    for spec in _COMPOSITES
} | {
    "polyhedron": SolidSpec(
        "polyhedron", "the convex hull of points", POLYHEDRON_FIELDS, read_polyhedron, cavity=True
    ),
    "extrusion": SolidSpec(
        "extrusion", "a polygon or a smooth outline along z", EXTRUSION_FIELDS, read_extrusion,
        exclusive=POLYGON_OR_OUTLINE,
    ),
    "outline_wall": SolidSpec(
        "outline_wall", "the sides of an outline of pieces along z, without its ends",
        (*OUTLINE_FIELDS, LENGTH), _outline_wall,
    ),
}  # fmt: skip
