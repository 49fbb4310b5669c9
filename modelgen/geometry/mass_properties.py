"""Volume, centre and inertia of composite solids, and of closed surfaces by the divergence theorem.

With dA = c_u x c_v du dv exterior: 3 V = int x.dA, 2 int x_i dV = int x_i^2 dA_i,
3 int x_i^2 dV = int x_i^3 dA_i and 2 int x_i x_j dV = int x_i^2 x_j dA_i.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import lru_cache
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np

from modelgen.errors import SceneError
from modelgen.geometry.closed_form_moments import surface_moments
from modelgen.geometry.composites.moments import Moments, moments_of, prism
from modelgen.geometry.composites.outline_features import outline_moments
from modelgen.geometry.expression_translation import lower
from modelgen.geometry.frames import cross
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import SURFACES, exterior_sign, surface_of
from modelgen.scene.expression_algebra import knots_along
from modelgen.scene.scene_types import Profile, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

PANELS = 4  # per direction; the shapes of the catalogue lose smoothness at panel ends only
NODES = (16, 32, 64, 128)  # Gauss-Legendre nodes of a panel, tried in this order
ROUNDING = 512 * sys.float_info.epsilon  # relative change of the moments that ends the refinement
GAP = 1e-6  # |int dA| / area above which the surface is open


def mass_properties(shape: Shape, density: float) -> tuple[float, Array, Array]:
    """Mass kg, centre (3) m and inertia (3,3) kg m^2 about the centre, in the shape's axes.

    Raises SceneError for a surface that does not bound a finite volume on its inner side.
    """
    parts = _volume_moments(shape)
    return density * parts.volume, parts.centre, density * _inertia(parts.second)


@lru_cache(maxsize=256)
def _volume_moments(shape: Shape) -> Moments:
    """Volume m^3, centre (3) m and second moments (3,3) m^5 about the centre; equal shapes once."""
    parts = _of_composite(shape)
    if parts is None:
        parts = surface_moments(shape)
    return moments_by_quadrature(shape) if parts is None else parts


def moments_by_quadrature(shape: Shape) -> Moments:
    """The moments of the volume inside a closed surface of charts; raises SceneError where there is none."""
    cells = _cells(shape)
    moments = _moments(shape, cells, NODES[0])
    for nodes in NODES[1:]:
        finer = _moments(shape, cells, nodes)
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
    return Moments(volume, centre, moments[4:].reshape(3, 3) - volume * np.outer(centre, centre))


def _inertia(second: Array) -> Array:
    """trace(second) I - second (3,3), in which nothing cancels on the diagonal."""
    diagonal = np.diag(second)
    others = np.array([diagonal[1] + diagonal[2], diagonal[2] + diagonal[0], diagonal[0] + diagonal[1]])
    return np.asarray(np.where(np.eye(3, dtype=bool), others, -second))


def _of_composite(shape: Shape) -> Moments | None:
    """The moments of a composite solid; None for a surface with one chart."""
    parts: Moments | None
    if shape.profile is not None:
        parts = _of_outline(shape, shape.profile)
    elif shape.kind == "outline_wall":
        parts = outline_moments(shape)
    else:
        parts = moments_of(shape)
    if parts is not None and shape.cavity:
        raise _unbounded(shape, "its material lies outside of it", "give mass and inertia, or remove cavity")
    return parts


def _cells(shape: Shape) -> list[Shape]:
    """The shapes of one kind whose charts cover the surface: itself, or the cells of a spline."""
    cells = [feature.shape for feature in features_of(shape).features] if shape.spline else [shape]
    if any(cell.kind not in SURFACES and cell.chart is None for cell in cells):
        raise _unbounded(shape, f"a {shape.kind} has no finite volume")
    if not all(isfinite(end) for ends in surface_of(cells[0]).domain for end in ends):
        raise _unbounded(shape, f"a {shape.kind} has no finite volume")
    return cells


def _of_outline(shape: Shape, profile: Profile) -> Moments:
    """A prism over a smooth outline."""
    (_, length), *parameters = shape.parameters
    t, values = ca.SX.sym("t"), {name: ca.SX(value) for name, value in parameters}
    x = ca.vertcat(*(lower(each, {"t": t} | values) for each in profile.components))
    outline = ca.Function("outline", [t], [ca.densify(x), ca.densify(ca.jacobian(x, t))])
    edges = _edges(profile.domain, knots_along(profile.components, "t", dict(parameters)))
    found = _area_moments(outline, edges, NODES[0])
    for nodes in NODES[1:]:
        finer = _area_moments(outline, edges, nodes)
        scales = finer[0] ** np.array([1.0, 0.5, 0.5, 2.0, 2.0, 2.0])
        settled = np.all(np.abs(finer - found) <= ROUNDING * scales)
        found = finer
        if settled:
            break
    area, centre, (xx, xy, yy) = found[0], found[1:3], found[3:]
    return prism(area, centre, np.array([[xx, xy], [xy, yy]]), length)


def _area_moments(outline: ca.Function, edges: Array, nodes: int) -> Array:
    """Area, centroid (2) and the second moments xx, xy, yy about it, by Green's theorem.

    2 A = int r x dr, 3 int r_i dA = int r_i (r x dr) and 4 int r_i r_j dA = int r_i r_j (r x dr).
    """
    t, weights = _composite(edges, nodes)
    points, slopes = (np.asarray(value) for value in outline(t.reshape(1, -1)))
    origin = points.mean(axis=1)
    r = points - origin[:, None]
    swept = (r[0] * slopes[1] - r[1] * slopes[0]) * weights
    area = swept.sum() / 2
    arm = r @ swept / (3 * area)
    second = (r * swept) @ r.T / 4 - area * np.outer(arm, arm)
    return np.array([area, *(origin + arm), second[0, 0], second[0, 1], second[1, 1]])


def _unbounded(shape: Shape, found: str, remedy: str = "give mass and inertia") -> SceneError:
    allowed = "a density needs a closed surface around material"
    return SceneError(f"shape {shape.name!r}", found, allowed, remedy)


def _area_vector(shape: Shape) -> ca.Function:
    """uv (2), parameters -> point (3) and exterior area vector c_u x c_v (3)."""
    uv, parameters = ca.SX.sym("uv", 2), ca.SX.sym("parameters", len(shape.parameters))
    jet = surface_of(shape).jet(uv, parameters)
    area = exterior_sign(shape) * cross(jet.first[:, 0], jet.first[:, 1])
    return ca.Function("area_vector", [uv, parameters], [ca.densify(jet.x), ca.densify(area)])


def _moments(shape: Shape, cells: list[Shape], nodes: int) -> Array:
    """Volume (1), first moments (3) and second moments (9) of the volume inside."""
    points, dA = _swept(cells, nodes)
    if np.linalg.norm(dA.sum(axis=1)) > GAP * np.linalg.norm(dA, axis=0).sum():
        raise _unbounded(shape, "the surface is not closed")
    first = np.sum(points**2 * dA, axis=1) / 2
    mixed = (points**2 * dA) @ points.T / 2
    second = np.where(np.eye(3, dtype=bool), mixed * 2 / 3, (mixed + mixed.T) / 2)
    return np.concatenate(([np.sum(points * dA) / 3], first, second.ravel()))


def _swept(cells: list[Shape], nodes: int) -> tuple[Array, Array]:
    """Points (3,n) of the surface and the exterior area vectors (3,n) that they stand for."""
    panels = PANELS if len(cells) == 1 else 1  # cells are polynomials
    chart, values = cells[0].chart, dict(cells[0].parameters)
    (u, wu), (v, wv) = (
        _composite(_edges(ends, knots_along(chart.components, name, values) if chart else [], panels), nodes)
        for name, ends in zip("uv", surface_of(cells[0]).domain, strict=True)
    )
    uv = np.array([entry.ravel() for entry in np.meshgrid(u, v, indexing="ij")])
    weights = np.outer(wu, wv).ravel()
    area_vector = _area_vector(cells[0])
    parts = [area_vector(uv, np.array([value for _, value in cell.parameters])) for cell in cells]
    points, areas = (
        np.hstack([np.asarray(value) for value in column]) for column in zip(*parts, strict=True)
    )
    return points, areas * np.tile(weights, len(cells))


def _scales(moments: Array) -> Array:
    """The size (13,) that each moment is measured against: its own order's, of one unit."""
    second = np.abs(moments[4:]).max()
    return np.repeat([abs(moments[0]), np.sqrt(abs(moments[0]) * second), second], (1, 3, 9))


def _edges(ends: tuple[float, float], knots: Sequence[float], panels: int = PANELS) -> Array:
    """Ends of panels, on which the integrand is smooth: between the knots where there are any."""
    inside = [knot for knot in knots if ends[0] < knot < ends[1]]
    return np.array([ends[0], *inside, ends[1]]) if inside else np.linspace(*ends, panels + 1)


def _composite(edges: Array, nodes: int) -> tuple[Array, Array]:
    """Composite Gauss-Legendre nodes and weights of panels."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    middle, half = (edges[1:] + edges[:-1]) / 2, (edges[1:] - edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * w).ravel()
