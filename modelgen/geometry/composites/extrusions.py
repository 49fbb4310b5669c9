"""Prisms along z over a polygon, convex or not, and over a smooth outline.

The ends of a prism that is not convex are convex pieces side by side in one plane. Over a smooth outline they
are charts s, t of the points centre + s (outline(t) - centre), so that the outline is the line s = 1, and a
round core of the plane about the centre, where that chart has its pole; the two overlap.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isfinite
from typing import Any

import numpy as np

from modelgen.geometry.composites.convex_pieces import convex_pieces, is_convex_polygon
from modelgen.geometry.composites.facets import Facets, facet_features
from modelgen.geometry.composites.feature_constructors import at_least, at_most, edge, face, smooth, wing
from modelgen.scene.expression import Expression, Name, Node, constant_expression, evaluate, number
from modelgen.scene.expression_algebra import expression_of, minus, plus, substitute, times
from modelgen.scene.pose_arithmetic import UPSIDE_DOWN
from modelgen.scene.scene_types import Chart, Composite, Condition, Curve, Feature, Pose, Profile, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

SAMPLES = 512  # of an outline, for its centre and its inner radius
ROUNDING = 1e-12  # a coordinate of the centre that is zero, against the outline's size
CORE, HOLE = 0.5, 0.25  # radius of the core, and of the hole in the chart around it, against the inner radius


def extrusion(shape: Shape) -> Composite:
    """A prism centred in z; parameters x0, y0, x1, ..., length, or length and those of the outline."""
    if shape.profile is not None:
        return _smooth(shape.profile, shape.parameters[0][1], shape.parameters[1:])
    return Composite(facet_features(prism_facets(shape)), convex=is_convex_polygon(corners(shape)))


def corners(shape: Shape) -> Array:
    """The polygon (n,2) of a prism, counterclockwise, m."""
    return np.array([value for _, value in shape.parameters[:-1]]).reshape(-1, 2)


def prism_facets(shape: Shape) -> Facets:
    """side<k> from corner k to the next, edge<k> at corner k; top, bottom or their pieces.

    Point k is corner k at the top, point n + k at the bottom.
    """
    polygon = corners(shape)
    half, count = shape.parameters[-1][1] / 2, len(polygon)
    points = np.vstack([np.column_stack([polygon, np.full(count, z)]) for z in (half, -half)])
    loops: list[tuple[int, ...]] = []
    faces: list[str] = []
    edges: dict[tuple[int, int], str] = {}
    pieces = convex_pieces(polygon)
    for index, piece in enumerate(pieces):
        tail = "" if len(pieces) == 1 else str(index)
        loops += [tuple(piece), tuple(count + k for k in reversed(piece))]
        faces += [f"top{tail}", f"bottom{tail}"]
    for k in range(count):
        after = (k + 1) % count
        loops.append((k, count + k, count + after, after))
        faces.append(f"side{k}")
        edges[k, count + k] = f"edge{k}"
        edges[min(k, after), max(k, after)] = f"rim_top{k}"
        edges[count + min(k, after), count + max(k, after)] = f"rim_bottom{k}"
    vertices = [f"corner_{end}{k}" for end in ("top", "bottom") for k in range(count)]
    return Facets(points, tuple(loops), tuple(faces), edges, tuple(vertices))


def outline_points(profile: Profile, parameters: Sequence[tuple[str, float]], t: Array) -> Array:
    """Points (n,2) of an outline at the parameters t (n,), m."""
    values = dict(parameters)
    return np.array([[evaluate(each, {**values, "t": at}) for each in profile.components] for at in t])


def _smooth(profile: Profile, length: float, parameters: tuple[tuple[str, float], ...]) -> Composite:
    t = np.linspace(*profile.domain, SAMPLES, endpoint=False)
    points = outline_points(profile, parameters, t)
    centre = _centroid(points)
    centre = np.where(np.abs(centre) < ROUNDING * np.ptp(points), 0.0, centre)
    radii = np.linalg.norm(points - centre, axis=1)
    z = Name("v"), (-length / 2, length / 2)
    side_chart = Chart(
        (*_in_terms_of(profile, "u"), expression_of(z[0])), (profile.domain, z[1]), (True, False)
    )
    side = face(
        "side", _own(Pose(), parameters, chart=side_chart),
        at_most(1, length / 2, "rim_top"), at_least(1, -length / 2, "rim_bottom"),
        *_around(profile, 0, "side"),
    )  # fmt: skip
    features = [side]
    for name, height in (("top", length / 2), ("bottom", -length / 2)):
        features += _end(name, height, profile, parameters, centre, (float(radii.min()), float(radii.max())))
    return Composite(tuple(features), convex=is_convex_polygon(points))


def _end(
    name: str, height: float, profile: Profile, parameters: tuple[tuple[str, float], ...], centre: Array,
    radii: tuple[float, float],
) -> tuple[Feature, ...]:  # fmt: skip
    """The end at a height, its core and its rim; `radii` are the least and the largest about the centre."""
    rim, core, pose = f"rim_{name}", f"{name}_core", Pose((0.0, 0.0, height))
    hole, disc = HOLE * radii[0], CORE * radii[0]
    inward, least = (0 if height > 0 else 1), hole / radii[1] / 2
    chart = _fan(profile, centre, least, up=height > 0)
    x, y = _in_terms_of(profile, "t")
    curve = Curve((x, y, constant_expression(0.0)), profile.domain, periodic=True)
    turned = Pose((float(centre[0]), float(centre[1]), height), UPSIDE_DOWN)
    plane = Pose(turned.position) if height > 0 else turned
    return (
        face(
            name, _own(pose, parameters, chart=chart),
            at_most(inward, 1.0, rim), at_least(inward, least, core),
            _circle(centre, hole, core, inside=False), *_around(profile, 1 - inward, name),
        ),
        face(core, smooth("plane", plane), _circle(np.zeros(2), disc, name, inside=True)),
        edge(
            rim, _own(pose, parameters, curve=curve),
            wing(-1.0, 0.0, name), wing(0.0, -1.0 if height > 0 else 1.0, "side"), *_around(profile, 0, rim),
        ),
    )  # fmt: skip


def _around(profile: Profile, index: int, name: str) -> tuple[Condition, ...]:
    """Conditions that lead from both ends of what the expressions of an outline hold back into one turn.

    A feature leads to itself, one turn on; the expressions hold a little farther than these conditions.
    """
    if not isfinite(profile.reach):
        return ()
    lower, upper = profile.domain
    return at_least(index, lower - profile.reach / 2, name), at_most(index, upper + profile.reach / 2, name)


def _fan(profile: Profile, centre: Array, least: float, up: bool) -> Chart:
    """centre + s (outline(t) - centre) with (u, v) = (s, t), whose normal is +z, or (t, s), for -z."""
    s, t = ("u", "v") if up else ("v", "u")
    outline = _in_terms_of(profile, t)
    x, y = (
        expression_of(plus(number(float(c)), times(Name(s), minus(each.tree, number(float(c))))))
        for each, c in zip(outline, centre, strict=True)
    )
    flat = constant_expression(0.0)
    reach = (least, 1.0)
    if up:
        return Chart((x, y, flat), (reach, profile.domain), (False, True))
    return Chart((x, y, flat), (profile.domain, reach), (True, False))


def _in_terms_of(profile: Profile, name: str) -> tuple[Expression, Expression]:
    by: dict[str, Node] = {"t": Name(name)}
    x, y = (expression_of(substitute(each.tree, by)) for each in profile.components)
    return x, y


def _own(
    pose: Pose,
    parameters: tuple[tuple[str, float], ...],
    chart: Chart | None = None,
    curve: Curve | None = None,
) -> Shape:
    kind = "curve" if chart is None else "chart"
    return Shape(kind, parameters, pose=pose, chart=chart, curve=curve, name=kind)


def _circle(centre: Array, radius: float, next: str, inside: bool) -> Condition:
    """sign (radius^2 - (x - cx)^2 - (y - cy)^2)/(2 radius), sign -1 for the outside."""
    sign = 1.0 if inside else -1.0
    x, y = (float(entry) for entry in centre)
    bend = sign / (2 * radius)
    constant = bend * (radius * radius - hypot(x, y) ** 2)
    return Condition(
        "quadric", (constant, 2 * bend * x, 2 * bend * y, 0.0, -bend, -bend, 0.0, 0.0, 0.0, 0.0), next
    )


def _centroid(points: Array) -> Array:
    """Centroid of the polygon of points (n,2), m."""
    after = np.roll(points, -1, axis=0)
    weights = points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]
    return np.asarray(weights @ (points + after) / (3 * weights.sum()))
