"""Charts that end: the user's chart, a polynomial cap over each pole, a rim where a revolution is open."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np

from modelgen.errors import ExpressionError
from modelgen.geometry.composites.feature_constructors import TILT, at_least, at_most, edge, face, smooth
from modelgen.geometry.pole_caps import Pole, cap_at, poles_of
from modelgen.geometry.power_series import taylor
from modelgen.geometry.revolved_charts import meridian_of_chart
from modelgen.scene.expression import Expression
from modelgen.scene.revolution_chart import ON_AXIS
from modelgen.scene.scene_types import NO_POLES, Chart, Composite, Condition, Feature, Pose, Shape

SHEET = "sheet"
INNER = 0.6  # of a cap's radius, where the chart hands over; the cap hands back at its own radius
ENDS = ((0, "v_min"), (1, "v_max"))  # of a profile


def has_parts(shape: Shape) -> bool:
    """Whether a chart has features beside itself."""
    return shape.chart is not None and (any(map(any, shape.chart.poles)) or bool(_rims(shape)))


def is_open(sheet: Feature) -> bool:
    """Whether a chart, as a feature of its shape, has an end that is no pole."""
    return any(not (each.next or "").startswith("pole_") for each in sheet.conditions)


def atlas(shape: Shape) -> Composite:
    """The faces `sheet`, `pole_u_min`, ..., which overlap and are the same surface where they do, and the
    rims `rim_v_min`, `rim_v_max`."""
    assert shape.chart is not None
    rims = _rims(shape)
    caps, conditions = [], ends_of(shape.chart, {rim.name for rim in rims})
    for pole in poles_of(shape.chart):
        cap, name = cap_at(shape, pole), f"pole_{pole.name}"
        conditions.append(_away_from(shape.chart, pole, INNER * cap.radius, name))
        piece = replace(smooth(cap.kind, Pose(), **dict(cap.parameters)), cavity=shape.cavity)
        caps.append(face(name, piece, Condition("disc", (1.0,), SHEET)))
    chart = replace(shape.chart, poles=NO_POLES)
    sheet = face(SHEET, replace(shape, chart=chart, pose=Pose()), *conditions)
    return Composite((sheet, *caps, *rims), convex=False)


def _away_from(chart: Chart, pole: Pole, distance: float, cap: str) -> Condition:
    end = chart.domain[pole.axis][pole.end]
    if pole.end == 0:
        return at_least(pole.axis, end + distance, cap)
    return at_most(pole.axis, end - distance, cap)


def ends_of(chart: Chart, rims: set[str]) -> list[Condition]:
    """Ends of the surface: sides of the domain that are neither poles nor joined, some of them with rims."""
    conditions = []
    for axis, (lower, upper) in enumerate(chart.domain):
        if not chart.periodic[axis]:
            poles, names = chart.poles[axis], [f"rim_{'uv'[axis]}_{end}" for end in ("min", "max")]
            low, high = (name if name in rims else None for name in names)
            conditions += [] if poles[0] else [at_least(axis, lower, low)]
            conditions += [] if poles[1] else [at_most(axis, upper, high)]
    return conditions


def _rims(shape: Shape) -> tuple[Feature, ...]:
    """The circles at which a surface of revolution is open."""
    chart = shape.chart
    assert chart is not None
    found = meridian_of_chart(chart)
    if found is None or chart.periodic[1]:
        return ()
    (r, _, z), turned = found[0].components, found[1]
    rims = (_rim(shape, (r, z), turned, end, name) for end, name in ENDS if not chart.poles[1][end])
    return tuple(rim for rim in rims if rim is not None)


def _rim(
    shape: Shape, profile: tuple[Expression, Expression], turned: bool, end: int, name: str
) -> Feature | None:
    """The rim at an end of the profile. None where that is on the axis, or has no direction.

    One wing rises above the surface and leads to it; the other sinks below it, where nothing is.
    """
    assert shape.chart is not None
    inward = 1 - 2 * end  # of the parameter
    numbers = {key: np.array([[value], [0.0]]) for key, value in shape.parameters}
    numbers["t"] = np.array([[shape.chart.domain[1][end]], [inward]])
    try:
        (radius, across), (height, along) = (taylor(each, numbers)[:, 0].tolist() for each in profile)
    except ExpressionError:
        return None
    length, (lower, upper) = hypot(across, along), shape.chart.domain[1]
    if radius <= ON_AXIS * length * (upper - lower):
        return None
    x, z = across / length, along / length
    side = inward * (-TILT if turned != shape.cavity else TILT)  # of the exterior: (z, -x)
    wings = (
        Condition("wing", (x + side * z, z - side * x), SHEET),
        Condition("wing", (x - side * z, z + side * x), None),
    )
    return edge(f"rim_{name}", smooth("circle", Pose((0.0, 0.0, height)), radius=radius), *wings)
