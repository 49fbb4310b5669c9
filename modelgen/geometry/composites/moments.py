"""Volume, centre and second moments of composite solids, in closed form or by rules that are exact."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from modelgen.geometry.composites.extrusions import corners
from modelgen.geometry.composites.facets import Facets
from modelgen.geometry.composites.polyhedra import polyhedron_facets
from modelgen.scene.scene_types import Shape

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Moments:
    """volume m^3; centre (3,) m in the shape frame; second (3,3) m^5: int (x - centre)(x - centre)^T dV."""

    volume: float
    centre: Array
    second: Array


def moments_of(shape: Shape) -> Moments | None:
    """The moments of a composite solid; None for shapes of other kinds."""
    if shape.kind not in _MOMENTS or shape.profile is not None or len(shape.parameters) < 2:
        return None
    return _MOMENTS[shape.kind](shape)


def prism(area: float, centre: Array, second: Array, length: float) -> Moments:
    """A prism centred in z: area m^2, centroid (2,) m, second moments (2,2) m^4 about it, length m."""
    full = np.zeros((3, 3))
    full[:2, :2] = second * length
    full[2, 2] = area * length**3 / 12
    return Moments(area * length, np.array([*centre, 0.0]), full)


def tetrahedra(facets: Facets) -> Moments:
    """The sum over the tetrahedra between a point inside and the triangles of the faces.

    Over a tetrahedron 0, a, b, c of volume V and s = a + b + c the integral of x x^T is
    V/20 (s s^T + a a^T + b b^T + c c^T).
    """
    origin = facets.points.mean(axis=0)
    points = facets.points - origin
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for loop in facets.loops:
        for b, c in pairwise(loop[1:]):
            triangle = points[[loop[0], b, c]]
            part = float(np.linalg.det(triangle)) / 6
            total = triangle.sum(axis=0)
            volume += part
            first += part / 4 * total
            second += part / 20 * (np.outer(total, total) + triangle.T @ triangle)
    arm = first / volume
    return Moments(volume, origin + arm, second - volume * np.outer(arm, arm))


def _box(shape: Shape) -> Moments:
    edges = np.array([value for _, value in shape.parameters])
    volume = float(np.prod(edges))
    return Moments(volume, np.zeros(3), np.diag(volume * edges**2 / 12))


def _cylinder(shape: Shape) -> Moments:
    (_, radius), (_, length) = shape.parameters
    return _layers(radius, radius, length)


def _tube(shape: Shape) -> Moments:
    """The cylinder less its bore; both are centred."""
    (_, radius), (_, bore), (_, length) = shape.parameters
    whole, hole = _layers(radius, radius, length), _layers(bore, bore, length)
    return Moments(whole.volume - hole.volume, whole.centre, whole.second - hole.second)


def _frustum(shape: Shape) -> Moments:
    (_, bottom), (_, top), (_, length) = shape.parameters
    return _layers(bottom, top, length)


def _layers(bottom: float, top: float, length: float) -> Moments:
    """Discs over z; the integrands are polynomials of degree 4, for which 3 nodes are exact."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    z, dz = nodes * length / 2, weights * length / 2
    square = ((bottom + top) / 2 + (top - bottom) * nodes / 2) ** 2
    areas = pi * square * dz
    volume = float(areas.sum())
    height = float(areas @ z) / volume
    across, along = float(areas @ square) / 4, float(areas @ (z - height) ** 2)
    return Moments(volume, np.array([0.0, 0.0, height]), np.diag([across, across, along]))


def _capsule(shape: Shape) -> Moments:
    (_, r), (_, length) = shape.parameters
    half = length / 2
    volume = pi * r**2 * length + 4 / 3 * pi * r**3
    across = pi * r**4 * length / 4 + 4 / 15 * pi * r**5
    caps = 4 / 3 * pi * r**3 * half**2 + pi * r**4 * half + 4 / 15 * pi * r**5
    return Moments(volume, np.zeros(3), np.diag([across, across, pi * r**2 * length**3 / 12 + caps]))


def _dome(shape: Shape) -> Moments:
    """Discs of radius^2 = z (2 radius - z) below the top, z; the integrands are polynomials of degree 4."""
    (_, radius), (_, length) = shape.parameters
    nodes, weights = np.polynomial.legendre.leggauss(3)
    depth = length * (1 + nodes) / 2  # below the top
    square = depth * (2 * radius - depth)
    areas = pi * square * weights * length / 2
    volume, z = float(areas.sum()), length - depth
    centre = float(areas @ z) / volume
    across, along = float(areas @ square) / 4, float(areas @ (z - centre) ** 2)
    return Moments(volume, np.array([0.0, 0.0, centre]), np.diag([across, across, along]))


def _half_torus(shape: Shape) -> Moments:
    """Over the tube's section int rho^2 = A (R^2 + r^2/4) and int rho^3 = A (R^3 + 3/4 R r^2)."""
    (_, R), (_, r) = shape.parameters
    area = pi * r**2
    volume = pi * area * R
    y = 2 * area * (R**2 + r**2 / 4) / volume
    across = pi / 2 * area * (R**3 + 3 / 4 * R * r**2)
    second = np.diag([across, across - volume * y**2, volume * r**2 / 4])
    return Moments(volume, np.array([0.0, y, 0.0]), second)


def _polyhedron(shape: Shape) -> Moments:
    return tetrahedra(polyhedron_facets(shape))


def _polygon_prism(shape: Shape) -> Moments:
    """Moments of a prism over a polygon, summed over triangles between the mean of the corners and the sides,
    with sign."""
    polygon = corners(shape)
    origin = polygon.mean(axis=0)
    a = polygon - origin
    b = np.roll(a, -1, axis=0)
    parts = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    area = float(parts.sum())
    arm = parts @ (a + b) / (3 * area)
    total = a + b
    second = ((parts * total.T) @ total + (parts * a.T) @ a + (parts * b.T) @ b) / 12
    return prism(area, origin + arm, second - area * np.outer(arm, arm), shape.parameters[-1][1])


_MOMENTS: Mapping[str, Callable[[Shape], Moments]] = {
    "box": _box,
    "cylinder": _cylinder,
    "tube": _tube,
    "frustum": _frustum,
    "capsule": _capsule,
    "dome": _dome,
    "half_torus": _half_torus,
    "polyhedron": _polyhedron,
    "extrusion": _polygon_prism,
}
