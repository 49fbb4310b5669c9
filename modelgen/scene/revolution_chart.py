"""Surfaces of revolution: a profile of t about z, composed to a chart at reading and oriented by itself.

(r(v) cos u, r(v) sin u, z(v)), u the azimuth. The exterior is the outside of what the profile encloses; where
it encloses nothing, the side away from the axis, and above if it is level. The profile may run either way:
where needed the azimuth counts the other way round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import Any

from modelgen.scene.expression import Expression, Name, Unary
from modelgen.scene.expression_algebra import cos, expression_of, sin, substitute, times
from modelgen.scene.finite_expressions import finite
from modelgen.scene.interpolating_splines import Parameters, check_points, check_reached, open_spline
from modelgen.scene.scene_types import Chart
from modelgen.scene.source_location import Place
from modelgen.scene.user_chart import check_chart, check_interval

SAMPLES = 256  # of a profile, for its side and its sign
ON_AXIS = 1e-9  # radius of a profile's end that lies on the axis, against its largest radius
CLOSE = 1e-4  # the same of an end that was meant to
FLAT = 1e-9  # what a profile encloses when it encloses nothing, against its size


@dataclass(frozen=True)
class Meridian:
    """r and z as expressions of t, and their values on samples of the domain, ends included."""

    r: Expression
    z: Expression
    domain: tuple[float, float]
    periodic: bool
    points: tuple[tuple[float, float], ...]


def read_revolution(values: Mapping[str, Any], place: Place) -> tuple[Chart, Parameters]:
    """The chart of the surface of revolution in the values of its table, and its parameters.

    Raises SceneError.
    """
    if values["points"] is not None:
        profile, parameters = _through_points(values["points"], place.key("points"))
    else:
        profile, parameters = _meridian(values, place), values["parameters"]
    chart = revolution(profile, _poles(profile, place))
    check_chart(chart, dict(parameters), place)
    return chart, parameters


def revolution(profile: Meridian, poles: tuple[bool, bool]) -> Chart:
    """The chart about z of a profile (r, z) whose ends on the axis are `poles`."""
    u, v = Name("u"), {"t": Name("v")}
    radius, height = substitute(profile.r.tree, v), substitute(profile.z.tree, v)
    y = times(radius, sin(u))
    if _turned(profile.points, closed=profile.periodic or all(poles)):
        y = Unary("-", y)
    return Chart(
        (expression_of(times(radius, cos(u))), expression_of(y), expression_of(height)),
        ((-pi, pi), profile.domain),
        (True, profile.periodic),
        ((False, False), poles),
    )


def _meridian(values: Mapping[str, Any], place: Place) -> Meridian:
    for key in ("r", "z", "domain"):
        if values[key] is None:
            raise place.error(
                f"a profile without {key}", "points, or r, z and domain, are needed", f"add {key}"
            )
    parameters = dict(values["parameters"])
    r, z = (place.key(key).expression(values[key], ("t", *parameters)) for key in "rz")
    lower, upper = values["domain"]
    check_interval((lower, upper), place.key("domain"))
    if "t" not in r.names | z.names:
        raise place.error("r and z do not depend on t", "a profile needs t", "use t")
    nodes = [parameters | {"t": lower + (upper - lower) * (k / SAMPLES)} for k in range(SAMPLES)]
    nodes.append(parameters | {"t": upper})
    columns = [
        [finite(each, node, place.key(key)) for node in nodes] for key, each in zip("rz", (r, z), strict=True)
    ]
    return Meridian(r, z, (lower, upper), values["periodic"], tuple(zip(*columns, strict=True)))


def _poles(profile: Meridian, place: Place) -> tuple[bool, bool]:
    """Which ends of the profile lie on the axis; raises SceneError where the profile crosses it."""
    radii = [radius for radius, _ in profile.points]
    largest = max(radii)
    for k, radius in enumerate(radii):
        inner = profile.periodic or 0 < k < SAMPLES
        if radius < -ON_AXIS * largest or (inner and radius <= ON_AXIS * largest) or largest <= 0:
            lower, upper = profile.domain
            at = lower + (upper - lower) * k / SAMPLES
            allowed = "r is positive, or zero at an end of the domain"
            raise place.key("r").error(f"r = {radius:g} at t = {at:g}", allowed, "mend r or the domain")
        if not inner and ON_AXIS * largest < radius < CLOSE * largest:
            found = f"a profile that ends {radius:.3g} m from the axis"
            raise place.key("domain").error(
                found, "", 'end it on the axis ("pi/2" in quotes is exact), or away'
            )
    if profile.periodic:
        return False, False
    return radii[0] <= ON_AXIS * largest, radii[-1] <= ON_AXIS * largest


def _turned(points: tuple[tuple[float, float], ...], closed: bool) -> bool:
    """Whether the normal of azimuth times profile points to the wrong side.

    By the volume pi int r^2 dz of what is enclosed; else by int r dz, away from the axis; else upwards.
    """
    power = 2 if closed else 1
    size = sum(((a[0] + b[0]) / 2) ** power * abs(b[1] - a[1]) for a, b in pairwise(points))
    side = sum(((a[0] + b[0]) / 2) ** power * (b[1] - a[1]) for a, b in pairwise(points))
    if abs(side) <= FLAT * size or size == 0:
        return points[-1][0] > points[0][0]
    return side < 0


def _through_points(points: Sequence[tuple[float, float]], place: Place) -> tuple[Meridian, Parameters]:
    """The spline through points (r, z); an end on the axis is put exactly there."""
    check_points(points, place)
    largest = max(r for r, _ in points)
    ends = tuple(abs(points[k][0]) <= ON_AXIS * largest for k in (0, -1))
    first, *inner, last = points
    on_axis = [(0.0, each[1]) if pole else each for each, pole in zip((first, last), ends, strict=True)]
    exact = [on_axis[0], *inner, on_axis[1]]
    spline = open_spline(exact, (ends[0], ends[1]))
    check_reached(spline, exact, False, place)
    r, z = spline.components
    values = dict(spline.parameters)
    nodes = [values | {"t": k / SAMPLES} for k in range(SAMPLES + 1)]
    columns = [[finite(each, node, place) for node in nodes] for each in (r, z)]
    for k, pole in zip((0, -1), ends, strict=True):
        columns[0][k] = 0.0 if pole else columns[0][k]
    return Meridian(r, z, (0.0, 1.0), False, tuple(zip(*columns, strict=True))), spline.parameters
