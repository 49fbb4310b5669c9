"""Triangles and lines of bodies, so fine that they stay within a tolerance of the smooth shapes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.coordinate_domains import domain_within
from modelgen.geometry.curves import curve_of
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.face_meshes import face_mesh
from modelgen.geometry.shape_features import features_of
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, Pose, Shape

FIRST, MOST = 8, 1024  # chords of a curve, at first and at most

Array = np.ndarray[Any, Any]


@dataclass(frozen=True, slots=True)
class Mesh:
    """A body for drawing, in the axes of its centre of mass, m."""

    vertices: Array  # (n, 3)
    normals: Array  # (n, 3), out of the material
    triangles: Array  # (m, 3) of vertices, counter-clockwise seen from outside
    lines: Array  # (k, 2, 3) edges and curves
    deviation: float = 0.0  # m, bound of the distances of triangles and lines from the shapes

    @property
    def is_empty(self) -> bool:
        return not len(self.triangles) and not len(self.lines)


def body_mesh(body: Body, centre: Sequence[float], reach: float, tolerance: float) -> Mesh:
    """All shapes of a body.

    Args:
        centre: its centre of mass in body axes as written, m.
        reach: how far unbounded surfaces and curves are drawn, m.
        tolerance: of the distance of the triangles from the surfaces, and of the lines from the curves, as
            a part of the radius of the shape, or of the reach. `deviation` tells what was attained: a shape
            that needs more than 256 cells along a coordinate gets these.
    """
    return _joined([_shape_mesh(shape, reach, tolerance) for shape in body.shapes], -np.array(centre))


def _joined(parts: Sequence[Mesh], shift: Array | None = None) -> Mesh:
    """Several meshes as one, moved by a vector."""
    none, by = np.zeros((0, 3)), np.zeros(3) if shift is None else shift
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    shifted = [part.triangles + start for part, start in zip(parts, starts, strict=False)]
    return Mesh(
        np.concatenate([none, *(part.vertices for part in parts)]) + by,
        np.concatenate([none, *(part.normals for part in parts)]),
        np.concatenate([np.zeros((0, 3), dtype=int), *shifted]),
        np.concatenate([np.zeros((0, 2, 3)), *(part.lines for part in parts)]) + by,
        max((part.deviation for part in parts), default=0.0),
    )


def _shape_mesh(shape: Shape, reach: float, tolerance: float) -> Mesh:
    radius = bounding_radius(shape)
    size = radius if isfinite(radius) and radius > 0 else reach
    parts, none = [], np.zeros((0, 3))
    for feature in features_of(shape).features:
        if feature.dimension == 2:
            face = face_mesh(feature, size, tolerance * size)
            turn = rotation_of(feature.shape.pose.quaternion)
            vertices, normals = _placed(feature.shape.pose, face.vertices), face.normals @ turn.T
            parts.append(Mesh(vertices, normals, face.triangles, np.zeros((0, 2, 3)), face.deviation))
        elif feature.dimension == 1:
            lines, off = _line(feature.shape, size, tolerance * size)
            parts.append(Mesh(none, none, np.zeros((0, 3), dtype=int), lines, off))
    whole = _joined(parts)
    return Mesh(
        _placed(shape.pose, whole.vertices),
        whole.normals @ rotation_of(shape.pose.quaternion).T,
        whole.triangles,
        _placed(shape.pose, whole.lines),
        whole.deviation,
    )


def _placed(pose: Pose, points: Array) -> Array:
    placed: Array = points @ rotation_of(pose.quaternion).T + np.array(pose.position)
    return placed


def _line(curve: Shape, size: float, allowed: float) -> tuple[Array, float]:
    """A curve as segments (k, 2, 3), and how far they are from it."""
    (ends,) = domain_within(curve, size)
    t, numbers = ca.SX.sym("t"), ca.DM([value for _, value in curve.parameters])
    function = ca.Function("point", [t], [ca.densify(curve_of(curve).jet(t, ca.SX(numbers)).x)])
    points, off = _chain(lambda at: np.asarray(function(at.reshape(1, -1))).T, ends, allowed)
    points = _placed(curve.pose, points)
    return np.stack([points[:-1], points[1:]], axis=1), off


def _chain(point: Callable[[Array], Array], ends: tuple[float, float], allowed: float) -> tuple[Array, float]:
    """Points (n, 3) of a curve whose chords stay near it, and the largest distance that was found."""
    at = np.linspace(*ends, FIRST + 1)
    while True:
        x, off = point(at), np.zeros(len(at) - 1)
        for s in (0.25, 0.5, 0.75):
            chord = x[:-1] + s * (x[1:] - x[:-1])
            off = np.maximum(off, np.linalg.norm(point(at[:-1] + s * np.diff(at)) - chord, axis=1))
        far = off > allowed
        if not far.any() or len(at) - 1 + far.sum() > MOST:
            return x, float(off.max())
        at = np.sort(np.concatenate([at, (at[:-1] + at[1:])[far] / 2]))
