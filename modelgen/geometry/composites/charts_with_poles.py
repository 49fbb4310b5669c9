"""Charts with poles: the user's chart away from them, and a polynomial cap over each."""

from __future__ import annotations

from dataclasses import replace

from modelgen.geometry.composites.feature_constructors import at_least, at_most, face, smooth
from modelgen.geometry.pole_caps import Pole, cap_at, poles_of
from modelgen.scene.scene_types import NO_POLES, Chart, Composite, Condition, Pose, Shape

SHEET = "sheet"
INNER = 0.6  # of a cap's radius, where the chart hands over; the cap hands back at its own radius


def has_poles(shape: Shape) -> bool:
    return shape.chart is not None and any(any(ends) for ends in shape.chart.poles)


def atlas(shape: Shape) -> Composite:
    """The faces `sheet`, `pole_u_min`, ...; they overlap, and are the same surface where they do."""
    assert shape.chart is not None
    caps, conditions = [], ends_of(shape.chart)
    for pole in poles_of(shape.chart):
        cap, name = cap_at(shape, pole), f"pole_{pole.name}"
        conditions.append(_away_from(shape.chart, pole, INNER * cap.radius, name))
        caps.append(
            face(name, smooth(cap.kind, Pose(), **dict(cap.parameters)), Condition("disc", (1.0,), SHEET))
        )
    chart = replace(shape.chart, poles=NO_POLES)
    sheet = replace(shape, chart=chart, pose=Pose(), cavity=False)
    return Composite((face(SHEET, sheet, *conditions), *caps), convex=False)


def _away_from(chart: Chart, pole: Pole, distance: float, cap: str) -> Condition:
    end = chart.domain[pole.axis][pole.end]
    if pole.end == 0:
        return at_least(pole.axis, end + distance, cap)
    return at_most(pole.axis, end - distance, cap)


def ends_of(chart: Chart) -> list[Condition]:
    """Ends of the surface: sides of the domain that are neither poles nor joined."""
    conditions = []
    for axis, (lower, upper) in enumerate(chart.domain):
        if not chart.periodic[axis]:
            poles = chart.poles[axis]
            conditions += [] if poles[0] else [at_least(axis, lower, None)]
            conditions += [] if poles[1] else [at_most(axis, upper, None)]
    return conditions
