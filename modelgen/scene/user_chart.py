"""The user's own surface or curve: its expressions, checked on a few points of its domain."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

from modelgen.scene.finite_expressions import finite
from modelgen.scene.scene_types import Chart, Curve
from modelgen.scene.source_location import Place

CLOSURE = 1e-9  # mismatch of the two ends of a periodic chart, against its size
NODES = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85)  # of the domain, where the components must be finite


def read_chart(values: Mapping[str, Any], place: Place) -> Chart:
    """The chart from the values of its table; raises SceneError."""
    names = ("u", "v", *(name for name, _ in values["parameters"]))
    x, y, z = (place.key(key).expression(values[key], names) for key in "xyz")
    for index, interval in enumerate(values["domain"]):
        check_interval(interval, place.key("domain").item(index))
    chart = Chart((x, y, z), values["domain"], values["periodic"], _poles(values, place.key("poles")))
    check_chart(chart, dict(values["parameters"]), place)
    return chart


def _poles(values: Mapping[str, Any], place: Place) -> tuple[tuple[bool, bool], tuple[bool, bool]]:
    """Which ends of u and of v are single points, about which the other coordinate turns."""
    written = values["poles"]
    (u_min, u_max), (v_min, v_max) = ((f"{name}_min" in written, f"{name}_max" in written) for name in "uv")
    for index, name in enumerate(written):
        around = "v" if name[0] == "u" else "u"
        if not values["periodic"]["uv".index(around)] or values["periodic"]["uv".index(name[0])]:
            found = f"a pole at {name} with periodic = {[*values['periodic']]}".lower()
            allowed = f"{around} turns about the pole and is periodic, {name[0]} is not"
            raise place.item(index).error(found, allowed)
    return (u_min, u_max), (v_min, v_max)


def check_interval(interval: tuple[float, float], place: Place) -> None:
    """Raises SceneError unless the interval is one."""
    lower, upper = interval
    if not lower < upper:
        raise place.error(f"the interval [{lower:g}, {upper:g}]", "the first number must be the smaller")


def check_chart(chart: Chart, parameters: dict[str, float], place: Place) -> None:
    """Raises SceneError unless the chart needs u and v, is finite, and closes where it is periodic."""
    used = frozenset().union(*(component.names for component in chart.components))
    for name in ("u", "v"):
        if name not in used:
            raise place.error(f"x, y, z do not depend on {name}", "a surface needs u and v", f"use {name}")
    nodes = [[lower + (upper - lower) * node for node in NODES] for lower, upper in chart.domain]
    points = [{"u": u, "v": v} | parameters for u, v in product(*nodes)]
    for key, component in zip("xyz", chart.components, strict=True):
        size = max(abs(finite(component, point, place.key(key))) for point in points)
        for axis, name in enumerate("uv"):
            if chart.periodic[axis]:
                ends = [points[0] | {name: end} for end in chart.domain[axis]]
                first, last = (finite(component, point, place.key(key)) for point in ends)
                _check_closed((first, last), size, name, place.key(key))
            for end, pole in enumerate(chart.poles[axis]):
                if pole:
                    around = [point | {name: chart.domain[axis][end]} for point in points]
                    _check_pole(
                        [finite(component, each, place.key(key)) for each in around], size, name, place
                    )


def read_curve(values: Mapping[str, Any], place: Place) -> Curve:
    """The curve from the values of its table; raises SceneError."""
    parameters = dict(values["parameters"])
    x, y, z = (place.key(key).expression(values[key], ("t", *parameters)) for key in "xyz")
    lower, upper = values["domain"]
    check_interval((lower, upper), place.key("domain"))
    if "t" not in x.names | y.names | z.names:
        raise place.error("x, y, z do not depend on t", "a curve needs t", "use t")
    curve = Curve((x, y, z), (lower, upper), values["periodic"])
    check_curve(curve, parameters, place)
    return curve


def check_curve(curve: Curve, parameters: dict[str, float], place: Place) -> None:
    """Raises SceneError unless the curve is finite on its domain, and closes if it is periodic."""
    lower, upper = curve.domain
    for key, component in zip("xyz", curve.components, strict=True):
        at = place.key(key)
        nodes = [parameters | {"t": lower + (upper - lower) * node} for node in NODES]
        size = max(abs(finite(component, node, at)) for node in nodes)
        if curve.periodic:
            first, last = (finite(component, parameters | {"t": end}, at) for end in (lower, upper))
            _check_closed((first, last), size, "t", at, "curve")


def _check_pole(values: list[float], size: float, name: str, place: Place) -> None:
    if max(values) - min(values) > CLOSURE * size:
        found = f"{min(values):.9g} and {max(values):.9g} at the pole of {name}"
        raise place.key("poles").error(found, "at a pole x, y, z are one point", "mend them or the domain")


def _check_closed(
    ends: tuple[float, float], size: float, name: str, place: Place, noun: str = "chart"
) -> None:
    if abs(ends[0] - ends[1]) > CLOSURE * size:
        found = f"{ends[0]:.9g} and {ends[1]:.9g} at the two ends of {name}"
        raise place.error(
            found, f"a {noun} periodic in {name} closes there", f"mend it or the domain of {name}"
        )
