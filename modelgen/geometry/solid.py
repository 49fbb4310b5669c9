"""Volume, centre and inertia of a closed surface by the divergence theorem over its chart.

With dA = c_u x c_v du dv exterior: 3 V = int x.dA, 2 int x_i dV = int x_i^2 dA_i,
3 int x_i^2 dV = int x_i^3 dA_i and 2 int x_i x_j dV = int x_i^2 x_j dA_i.
"""

from __future__ import annotations

import sys
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np

from modelgen.errors import SceneError
from modelgen.geometry.catalogue import exterior_sign, surface_of
from modelgen.geometry.frames import cross
from modelgen.scene.types import Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

PANELS = 4  # per direction; the shapes of the catalogue lose smoothness at panel ends only
NODES = (16, 32, 64, 128)  # Gauss-Legendre nodes of a panel, tried in this order
ROUNDING = 512 * sys.float_info.epsilon  # relative change of the moments that ends the refinement
GAP = 1e-6  # |int dA| / area above which the surface is open


def mass_properties(shape: Shape, density: float) -> tuple[float, Array, Array]:
    """Mass kg, centre (3) m and inertia (3,3) kg m^2 about the centre, in the shape's axes.

    Raises SceneError for a surface that does not bound a finite volume on its inner side.
    """
    if not all(isfinite(end) for ends in surface_of(shape).domain for end in ends):
        raise _unbounded(shape, f"a {shape.kind} has no finite volume")
    area_vector = _area_vector(shape)
    moments = _moments(shape, area_vector, NODES[0])
    for nodes in NODES[1:]:
        finer = _moments(shape, area_vector, nodes)
        settled = np.all(np.abs(finer - moments) <= ROUNDING * _scales(finer))
        moments = finer
        if settled:
            break
    volume = moments[0]
    if volume <= 0:
        raise _unbounded(
            shape, f"its material lies outside of it (volume {volume:.6g} m^3)", "swap u and v, or the cavity"
        )
    centre = moments[1:4] / volume
    second = moments[4:].reshape(3, 3) - volume * np.outer(centre, centre)
    return density * volume, centre, density * (np.trace(second) * np.eye(3) - second)


def _unbounded(shape: Shape, found: str, remedy: str = "give mass and inertia") -> SceneError:
    allowed = "a density needs a closed surface around material"
    return SceneError(f"shape {shape.name!r}", found, allowed, remedy)


def _area_vector(shape: Shape) -> ca.Function:
    """uv (2) -> point (3) and exterior area vector c_u x c_v (3)."""
    uv = ca.SX.sym("uv", 2)
    jet = surface_of(shape).jet(uv, ca.SX(ca.DM([value for _, value in shape.parameters])))
    area = exterior_sign(shape) * cross(jet.first[:, 0], jet.first[:, 1])
    return ca.Function("area_vector", [uv], [ca.densify(jet.x), ca.densify(area)])


def _moments(shape: Shape, area_vector: ca.Function, nodes: int) -> Array:
    """Volume (1), first moments (3) and second moments (9) of the volume inside."""
    (u, wu), (v, wv) = (_composite(ends, nodes) for ends in surface_of(shape).domain)
    uv = np.array([entry.ravel() for entry in np.meshgrid(u, v, indexing="ij")])
    points, areas = (np.asarray(value) for value in area_vector(uv))
    dA = areas * np.outer(wu, wv).ravel()
    if np.linalg.norm(dA.sum(axis=1)) > GAP * np.linalg.norm(dA, axis=0).sum():
        raise _unbounded(shape, "the surface is not closed")
    first = np.sum(points**2 * dA, axis=1) / 2
    mixed = (points**2 * dA) @ points.T / 2
    second = np.where(np.eye(3, dtype=bool), mixed * 2 / 3, (mixed + mixed.T) / 2)
    return np.concatenate(([np.sum(points * dA) / 3], first, second.ravel()))


def _scales(moments: Array) -> Array:
    """The size (13,) that each moment is measured against: its own order's, of one unit."""
    second = np.abs(moments[4:]).max()
    return np.repeat([abs(moments[0]), np.sqrt(abs(moments[0]) * second), second], (1, 3, 9))


def _composite(ends: tuple[float, float], nodes: int) -> tuple[Array, Array]:
    """Composite Gauss-Legendre nodes and weights between two ends."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    edges = np.linspace(*ends, PANELS + 1)
    middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * w).ravel()
