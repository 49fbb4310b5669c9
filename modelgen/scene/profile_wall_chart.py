"""The chart of a wall: an open profile through points, along z without ends, as of rails and ways.

(x(u), y(u), v); the exterior is on the right of the direction in which the points follow each other, as that
of a counterclockwise outline is.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.scene.expression import Name
from modelgen.scene.expression_algebra import expression_of, substitute
from modelgen.scene.interpolating_splines import Parameters, check_points, check_reached, open_spline
from modelgen.scene.scene_types import Chart
from modelgen.scene.source_location import Place
from modelgen.scene.user_chart import check_chart


def read_profile_wall(values: Mapping[str, Any], place: Place) -> tuple[Chart, Parameters]:
    """The chart of the wall in the values of its table, and its parameters; raises SceneError."""
    points, at = values["points"], place.key("points")
    check_points(points, at)
    spline = open_spline(points, (False, False))
    check_reached(spline, points, False, at)
    along = {"t": Name("u")}
    x, y = (expression_of(substitute(each.tree, along)) for each in spline.components)
    half = values["length"] / 2
    chart = Chart((x, y, expression_of(Name("v"))), ((0.0, 1.0), (-half, half)), (False, False))
    check_chart(chart, dict(spline.parameters), place)
    return chart, spline.parameters
