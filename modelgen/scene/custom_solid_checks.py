"""Whether the edges of a user's solid lie where its faces end, and its vertices where its edges end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, hypot, inf, pi, sin, tan
from typing import Any

import numpy as np

from modelgen.rotations import rotation_of
from modelgen.scene.expression import evaluate
from modelgen.scene.scene_types import Condition, Feature, Pose, Shape
from modelgen.scene.source_location import Place

Array = np.ndarray[Any, np.dtype[np.float64]]
Part = tuple[Place, Feature]

APART = 1e-9  # distance of what should meet, against the size of the edge
LEVEL = 1e-6  # departure of an edge from a plane of constant z, against its size
STEP = 1e-4  # of the parameter, against its interval, for the tangent
SLANT = 1e-3  # slope of a wing against its face
SAMPLES = 33

_ROUND = (-pi, pi)


def check_places(parts: list[Part]) -> None:
    """Raises SceneError where an edge leaves its plane, its faces or their ends, or misses its vertices."""
    features = {feature.name: feature for _, feature in parts}
    for at, edge in parts:
        if edge.dimension != 1:
            continue
        ends = _ends(edge, at)
        points = np.array([point_on(edge.shape, t) for t in np.linspace(*ends, SAMPLES)])
        size = float(np.ptp(points, axis=0).max())
        if any(condition.kind == "wing" for condition in edge.conditions):
            _check_level(points, size, at)
        for condition in edge.conditions:
            other = features[condition.next] if condition.next is not None else None
            if condition.kind == "wing" and other is not None:
                _check_face(edge, _moved(edge.shape.pose, points), other, size, at)
                _check_wing(edge, condition, ends, other, at)
            if condition.kind == "parameter" and other is not None and other.dimension == 0:
                _check_vertex(edge, condition.numbers[2], other, size, at)


def point_on(shape: Shape, t: float) -> tuple[float, float, float]:
    """The point of a curve at its parameter t, in the shape frame, m."""
    p = dict(shape.parameters)
    if shape.curve is not None:
        x, y, z = (evaluate(component, {**p, "t": t}) for component in shape.curve.components)
        return x, y, z
    return _POINTS[shape.kind](t, p)


_POINTS: Mapping[str, Callable[[float, dict[str, float]], tuple[float, float, float]]] = {
    "line": lambda t, p: (0.0, 0.0, t),
    "segment": lambda t, p: (0.0, 0.0, p["length"] * t),
    "edge": lambda t, p: (t, 0.0, 0.0),
    "circle": lambda t, p: (p["radius"] * cos(t), p["radius"] * sin(t), 0.0),
    "ellipse_curve": lambda t, p: (p["a"] * cos(t), p["b"] * sin(t), 0.0),
    "helix": lambda t, p: (p["radius"] * cos(t), p["radius"] * sin(t), p["pitch"] * t),
}

_OFF: Mapping[str, Callable[[Array, dict[str, float]], Array]] = {  # about the distance of points (n,3), m
    "plane": lambda x, p: x[:, 2],
    "sphere": lambda x, p: np.linalg.norm(x, axis=1) - p["radius"],
    "cylinder": lambda x, p: np.hypot(x[:, 0], x[:, 1]) - p["radius"],
    "cone": lambda x, p: np.hypot(x[:, 0], x[:, 1]) + x[:, 2] * tan(p["half_angle"]),
    "torus": lambda x, p: np.hypot(np.hypot(x[:, 0], x[:, 1]) - p["major"], x[:, 2]) - p["minor"],
}


def _ends(edge: Feature, place: Place) -> tuple[float, float]:
    """Start and end of the edge, by its shape and by its conditions."""
    low, high = {
        "edge": (-inf, inf), "circle": _ROUND, "ellipse_curve": _ROUND, "segment": (-0.5, 0.5),
    }.get(edge.shape.kind, (-inf, inf))  # fmt: skip
    if edge.shape.curve is not None:
        low, high = edge.shape.curve.domain
    if edge.shape.kind == "edge":
        half = edge.shape.parameters[0][1] / 2
        low, high = -half, half
    for condition in edge.conditions:
        if condition.kind == "parameter":
            _, sign, bound = condition.numbers
            low, high = (max(low, bound), high) if sign > 0 else (low, min(high, bound))
    if not -inf < low < high < inf:
        raise place.error(
            f"an edge from t = {low:g} to {high:g}", "it has two ends, or is closed", "bound t by conditions"
        )
    return low, high


def _check_level(points: Array, size: float, place: Place) -> None:
    if float(np.ptp(points[:, 2])) > LEVEL * size:
        raise place.key("shape").error(
            "an edge with wings that is not level in its shape frame",
            "wings need a tangent perpendicular to the third axis of the edge's shape frame",
            "use edge, circle, ellipse_curve or a curve of constant z, and turn it by its pose",
        )


def _check_face(edge: Feature, points: Array, face: Feature, size: float, place: Place) -> None:
    """The points (n,3) of the edge lie on the face, and where its condition for the edge vanishes."""
    local = _local(face.shape.pose, points)
    off = _OFF.get(face.shape.kind)
    if off is not None:
        worst = float(np.abs(off(local, dict(face.shape.parameters))).max())
        if worst > APART * size:
            raise place.error(
                f"the edge {edge.name!r} lies {worst:.3g} m off the face {face.name!r}", "it must lie on it"
            )
    for condition in face.conditions:
        if condition.next == edge.name and condition.kind == "quadric":
            worst = float(np.abs(quadric(condition.numbers, local)).max())
            if worst > APART * size:
                raise place.error(
                    f"the condition of {face.name!r} for {edge.name!r} is {worst:.3g} m off zero there",
                    "the condition vanishes on the edge",
                )


def _check_wing(
    edge: Feature, wing: Condition, ends: tuple[float, float], face: Feature, place: Place
) -> None:
    """The wing leads along the face, and to where the face's condition for the edge is positive."""
    (a, b), middle, span = wing.numbers, sum(ends) / 2, ends[1] - ends[0]
    at = np.array(point_on(edge.shape, middle))
    along = np.subtract(
        point_on(edge.shape, middle + STEP * span), point_on(edge.shape, middle - STEP * span)
    )
    tangent = along / np.linalg.norm(along)
    w = a * np.array([tangent[1], -tangent[0], 0.0]) + b * np.array([0.0, 0.0, 1.0])  # T x z = (Ty, -Tx, 0)
    step = float(np.linalg.norm(along))
    local = _local(face.shape.pose, _moved(edge.shape.pose, np.array([at + step * w, at - step * w])))
    off = _OFF.get(face.shape.kind)
    if off is not None:
        ahead, behind = off(local, dict(face.shape.parameters))
        if abs(ahead - behind) > SLANT * step:
            raise place.error(
                f"a wing of {edge.name!r} that leads off the face {face.name!r}",
                "it lies in the face's tangent plane", "w = a T x z + b z; see the direction of T",
            )  # fmt: skip
    for condition in face.conditions:
        if condition.next == edge.name and condition.kind == "quadric":
            ahead, behind = quadric(condition.numbers, local)
            if not ahead > behind:
                raise place.error(
                    f"a wing of {edge.name!r} that points out of the face {face.name!r}",
                    "wings point from the edge into the face", "change the sign of a and b",
                )  # fmt: skip


def _check_vertex(edge: Feature, t: float, vertex: Feature, size: float, place: Place) -> None:
    at = np.array([value for _, value in vertex.shape.parameters])
    end = _moved(edge.shape.pose, np.array([point_on(edge.shape, t)]))[0]
    gap = hypot(*(end - at))
    if gap > APART * size:
        raise place.error(
            f"the vertex {vertex.name!r} is {gap:.3g} m from the end of {edge.name!r} at t = {t:g}",
            "a vertex lies on its edges", "move the vertex, or the bound",
        )  # fmt: skip


def quadric(numbers: Sequence[float], x: Array) -> Array:
    """The value (n,) of a quadric, the numbers of its condition, at points (n,3)."""
    c, bx, by, bz, xx, yy, zz, xy, xz, yz = numbers
    matrix = np.array([[xx, xy / 2, xz / 2], [xy / 2, yy, yz / 2], [xz / 2, yz / 2, zz]])
    value: Array = c + x @ np.array([bx, by, bz]) + np.einsum("ni,ij,nj->n", x, matrix, x)
    return value


def _moved(pose: Pose, points: Array) -> Array:
    """Points (n,3) of the shape frame in the frame of the solid."""
    moved: Array = points @ rotation_of(pose.quaternion).T + np.array(pose.position)
    return moved


def _local(pose: Pose, points: Array) -> Array:
    local: Array = (points - np.array(pose.position)) @ rotation_of(pose.quaternion)
    return local
