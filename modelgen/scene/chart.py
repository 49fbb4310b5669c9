"""The user's own surface or curve: its expressions, checked on a few points of its domain."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

from modelgen.scene.formulas import finite
from modelgen.scene.place import Place
from modelgen.scene.types import Chart, Curve

CLOSURE = 1e-9  # mismatch of the two ends of a periodic chart, against its size
NODES = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85)  # of the domain, where the components must be finite


def read_chart(values: Mapping[str, Any], place: Place) -> Chart:
    """The chart from the values of its table; raises SceneError."""
    names = ("u", "v", *(name for name, _ in values["parameters"]))
    x, y, z = (place.key(key).expression(values[key], names) for key in "xyz")
    for index, (lower, upper) in enumerate(values["domain"]):
        if not lower < upper:
            at = place.key("domain").item(index)
            raise at.error(f"the interval [{lower:g}, {upper:g}]", "the first number must be the smaller")
    chart = Chart((x, y, z), values["domain"], values["periodic"])
    _check_chart(chart, dict(values["parameters"]), place)
    return chart


def _check_chart(chart: Chart, parameters: dict[str, float], place: Place) -> None:
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


def read_curve(values: Mapping[str, Any], place: Place) -> Curve:
    """The curve from the values of its table; raises SceneError."""
    parameters = dict(values["parameters"])
    x, y, z = (place.key(key).expression(values[key], ("t", *parameters)) for key in "xyz")
    lower, upper = values["domain"]
    if not lower < upper:
        raise place.key("domain").error(
            f"the interval [{lower:g}, {upper:g}]", "the first number must be the smaller"
        )
    if "t" not in x.names | y.names | z.names:
        raise place.error("x, y, z do not depend on t", "a curve needs t", "use t")
    for key, component in zip("xyz", (x, y, z), strict=True):
        at = place.key(key)
        nodes = [parameters | {"t": lower + (upper - lower) * node} for node in NODES]
        size = max(abs(finite(component, node, at)) for node in nodes)
        if values["periodic"]:
            first, last = (finite(component, parameters | {"t": end}, at) for end in (lower, upper))
            _check_closed((first, last), size, "t", at, "curve")
    return Curve((x, y, z), (lower, upper), values["periodic"])


def _check_closed(
    ends: tuple[float, float], size: float, name: str, place: Place, noun: str = "chart"
) -> None:
    if abs(ends[0] - ends[1]) > CLOSURE * size:
        found = f"{ends[0]:.9g} and {ends[1]:.9g} at the two ends of {name}"
        raise place.error(
            found, f"a {noun} periodic in {name} closes there", f"mend it or the domain of {name}"
        )
