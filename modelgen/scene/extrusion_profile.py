"""The smooth closed outline of an extrusion, checked on samples and turned counterclockwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, hypot, pi
from typing import Any

from modelgen.scene.expression import Expression, Name, number
from modelgen.scene.expression_algebra import expression_of, minus, substitute
from modelgen.scene.finite_expressions import finite
from modelgen.scene.interpolating_splines import Parameters, check_points, check_reached, closed_spline
from modelgen.scene.scene_types import Profile
from modelgen.scene.source_location import Place

Point = tuple[float, float]

SAMPLES = 512
CLOSURE = 1e-9  # gap between the two ends of the outline, against its size
CORNER = 1e-3  # change of direction where the outline closes that is no corner, rad
STEP = 1e-6  # of the parameter, against its domain, for the direction at the ends


def read_profile(values: Mapping[str, Any], place: Place) -> Profile:
    """The outline from the values of its table; raises SceneError."""
    parameters = dict(values["parameters"])
    x, y = (place.key(key).expression(values[key], ("t", *parameters)) for key in "xy")
    profile = Profile((x, y), values["domain"])
    points = _samples(profile, parameters, place)
    _check_closed(profile, points, parameters, place)
    if signed_area(points) < 0:
        profile = _reversed(profile)
        points = points[::-1]
    _check_seen(points, place)
    return profile


def spline_profile(points: Sequence[Point], place: Place) -> tuple[Profile, Parameters]:
    """The closed spline through the points and its parameters; raises SceneError."""
    check_points([*points, points[0]] if points else points, place)
    if signed_area(list(points)) < 0:
        points = points[::-1]
    spline = closed_spline(points)
    check_reached(spline, points, True, place)
    x, y = spline.components
    profile = Profile((x, y), (0.0, 1.0), spline.reach)
    _check_seen(_samples(profile, dict(spline.parameters), place), place)
    return profile, spline.parameters


def signed_area(points: list[Point]) -> float:
    """Signed area of the polygon of the points, m^2; positive counterclockwise."""
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in _sides(points)) / 2


def centroid(points: list[Point]) -> Point:
    """Centroid of the polygon of the points, m."""
    weights = [a[0] * b[1] - a[1] * b[0] for a, b in _sides(points)]
    total = 3 * sum(weights)
    x, y = (
        sum(w * (a[k] + b[k]) for w, (a, b) in zip(weights, _sides(points), strict=True)) / total
        for k in (0, 1)
    )
    return x, y


def point_at(profile: Profile, t: float, parameters: Mapping[str, float], place: Place) -> Point:
    """The point of the outline at t, m; raises SceneError where it is not finite."""
    x, y = (
        finite(component, {**parameters, "t": t}, place.key(key))
        for key, component in zip("xy", profile.components, strict=True)
    )
    return x, y


def _samples(profile: Profile, parameters: Mapping[str, float], place: Place) -> list[Point]:
    lower, upper = profile.domain
    return [
        point_at(profile, lower + (upper - lower) * (k / SAMPLES), parameters, place) for k in range(SAMPLES)
    ]


def _sides(points: list[Point]) -> list[tuple[Point, Point]]:
    return list(zip(points, [*points[1:], points[0]], strict=True))


def _check_closed(
    profile: Profile, points: list[Point], parameters: Mapping[str, float], place: Place
) -> None:
    size = max(hypot(x - points[0][0], y - points[0][1]) for x, y in points)
    lower, upper = profile.domain
    step = STEP * (upper - lower)
    first, second, before, last = (
        point_at(profile, t, parameters, place) for t in (lower, lower + step, upper - step, upper)
    )
    gap = hypot(first[0] - last[0], first[1] - last[1])
    if not gap <= CLOSURE * size:
        raise place.key("domain").error(
            f"an outline whose ends are {gap:.3g} m apart",
            "it must close",
            'mend the domain ("2*pi" in quotes is exact)',
        )
    a, b = (second[0] - first[0], second[1] - first[1]), (last[0] - before[0], last[1] - before[1])
    turn, along = a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]
    if not abs(turn) <= CORNER * along:
        raise place.error(
            "an outline with a corner where it closes", "it must be smooth there too", "use points"
        )


def _check_seen(points: list[Point], place: Place) -> None:
    """Every point of the outline is seen from its centroid, so that its ends have a chart."""
    check_simple(points, place)
    area, size = signed_area(points), max(hypot(a[0] - b[0], a[1] - b[1]) for a, b in _sides(points))
    if not area > size * size:
        raise place.error("an outline that encloses next to nothing", "it must bound an area", "mend x or y")
    x, y = centroid(points)
    for a, b in _sides(points):
        if (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x) <= 0:
            raise place.error(
                f"an outline that, at ({a[0]:.4g}, {a[1]:.4g}), its centroid ({x:.4g}, {y:.4g}) cannot see",
                "a smooth outline is star-shaped about its centroid, and does not meet itself",
                "use points, or several extrusions",
            )


def check_simple(points: list[Point], place: Place) -> None:
    """An outline that turns about itself once: a figure of eight turns not at all, a loop in a loop twice."""
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in _sides(points)]
    turns = [
        atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
        for a, b in zip(steps, [*steps[1:], steps[0]], strict=True)
    ]
    turned = round(sum(turns) / (2 * pi))
    if abs(turned) != 1:
        raise place.error(
            f"an outline that turns {turned} times about itself: it crosses itself, like a figure of eight",
            "an outline bounds one area and turns once",
            "mend x or y, halve the domain, or use one extrusion for each loop",
        )


def _reversed(profile: Profile) -> Profile:
    """The outline run the other way: t becomes t_min + t_max - t."""
    lower, upper = profile.domain
    turned = {"t": minus(number(lower + upper), Name("t"))}

    def turn(component: Expression) -> Expression:
        return expression_of(substitute(component.tree, turned))

    x, y = profile.components
    return Profile((turn(x), turn(y)), profile.domain)
