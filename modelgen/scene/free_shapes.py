"""The shapes beside the catalogue that are read to something else than a row of numbers.

Revolutions and profile walls become charts, and lines on surfaces become curves; splines keep their points.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from modelgen.scene.free_form_values import Spline
from modelgen.scene.outline_format import OUTLINE_FIELDS
from modelgen.scene.outline_joining import read_outline
from modelgen.scene.profile_wall_chart import read_profile_wall
from modelgen.scene.revolution_chart import read_revolution
from modelgen.scene.scalar_types import NUMBER, POSITIVE, ExpressionText, Switch
from modelgen.scene.shape_catalogue import REVOLUTION_PARAMETERS
from modelgen.scene.source_location import Place
from modelgen.scene.spline_format import (
    HEIGHT_FIELDS,
    NET_FIELDS,
    POLYGON_FIELDS,
    POLYLINE_FIELDS,
    read_heights,
    read_net,
    read_polygon,
    read_polyline,
)
from modelgen.scene.surface_lines import LINE_FIELDS, read_surface_line
from modelgen.scene.table_types import Field, Sequence

Reader = Callable[[Mapping[str, Any], Place], dict[str, Any]]


@dataclass(frozen=True, slots=True)
class FreeShape:
    """One way to write a shape; `read` gives the keywords of the Shape that it becomes."""

    kind: str
    doc: str
    fields: tuple[Field, ...]
    read: Reader
    curve: bool = False
    exclusive: tuple[tuple[str, ...], ...] = ()


def _revolution(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    chart, parameters = read_revolution(values, place)
    return {"kind": "chart", "parameters": parameters, "chart": chart}


def _profile_wall(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    chart, parameters = read_profile_wall(values, place)
    return {"kind": "chart", "parameters": parameters, "chart": chart}


def _line(values: Mapping[str, Any], place: Place) -> dict[str, Any]:
    curve, parameters = read_surface_line(values, place)
    return {"kind": "curve", "parameters": parameters, "curve": curve}


def _spline(read: Callable[[Mapping[str, Any], Place], Spline]) -> Reader:
    return lambda values, place: {"spline": read(values, place)}


_OF_T = ExpressionText("expression of t and the parameters, m")
_REVOLUTION_FIELDS = (
    Field("r", _OF_T, "r(t), distance of the profile from the z axis, m"),
    Field("z", _OF_T, "z(t), m; exterior outside, or away from the axis"),
    Field("domain", Sequence(NUMBER, 2), "[t_min, t_max]; an end with r = 0 is a pole"),
    Field(
        "points",
        Sequence(Sequence(NUMBER, 2), None),
        "points [r, z] of the profile instead, m, through which a spline runs; an end with r = 0 is a pole",
    ),
    Field("periodic", Switch(), "whether the profile closes", default=False),
    Field("parameters", REVOLUTION_PARAMETERS, "named numbers that r, z may use", default=()),
)

_WALL_FIELDS = (
    Field(
        "points", Sequence(Sequence(NUMBER, 2), None),
        "points [x, y] of the profile, m, through which a spline runs; exterior on their right",
        required=True,
    ),
    Field("length", POSITIVE, "length along z, m", required=True),
)  # fmt: skip

_POINTS_OR_FORMULAS = tuple(("points", key) for key in ("r", "z", "domain", "periodic", "parameters"))

FREE_SHAPES: Mapping[str, FreeShape] = {
    each.kind: each
    for each in (
        FreeShape(
            "revolution", "a profile r(t), z(t), or through points, turned about z", _REVOLUTION_FIELDS,
            _revolution, exclusive=_POINTS_OR_FORMULAS,
        ),
        FreeShape(
            "profile_wall", "an open profile through points, along z without its ends", _WALL_FIELDS,
            _profile_wall,
        ),
        FreeShape("bspline", "a B-spline surface", NET_FIELDS, _spline(read_net)),
        FreeShape("height_field", "heights on a grid", HEIGHT_FIELDS, _spline(read_heights)),
        FreeShape("bspline_curve", "a B-spline curve", POLYGON_FIELDS, _spline(read_polygon), curve=True),
        FreeShape(
            "polyline", "straight pieces with rounded corners", POLYLINE_FIELDS, _spline(read_polyline),
            curve=True,
        ),
        FreeShape(
            "outline", "an outline of pieces in z = 0, as of a thin plate", OUTLINE_FIELDS,
            lambda values, place: {"outline": read_outline(values, place)}, curve=True,
        ),
        FreeShape(
            "surface_line", "a boundary or parameter line of a surface", LINE_FIELDS, _line, curve=True,
            exclusive=(("u", "v"),),
        ),
    )
}  # fmt: skip
