"""The material of shapes with flat faces as convex cells, and how far features reach out of a cell."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Any

import numpy as np

from modelgen.geometry.composites.convex_pieces import convex_pieces
from modelgen.geometry.composites.extrusions import corners
from modelgen.geometry.composites.facets import Facets, normal_of
from modelgen.geometry.composites.polyhedra import box_facets, polyhedron_facets
from modelgen.geometry.coordinate_domains import domain_of
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Feature, Pose, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

RULED = ("plane", "cylinder", "conical_side")  # faces that lie in the convex hull of their edges


@dataclass(frozen=True, slots=True)
class Cell:
    """The points x with normals x <= offsets; one piece of a shape's material."""

    normals: Array  # (n, 3) unit, outward
    offsets: Array  # (n,) m

    def placed(self, pose: Pose) -> Cell:
        """The same cell in the frame in which `pose` is given."""
        normals = self.normals @ rotation_of(pose.quaternion).T
        return Cell(normals, self.offsets + normals @ np.array(pose.position))

    def heights(self, x: Array) -> Array:
        """(..., n) m: how far points (..., 3) are outside of each plane."""
        return np.asarray(x @ self.normals.T - self.offsets)


@lru_cache(maxsize=512)
def cells_of(shape: Shape) -> tuple[Cell, ...]:
    """The material of a plane, box, polyhedron or prism in its own axes; nothing of other shapes."""
    if shape.cavity or (shape.kind == "extrusion" and shape.profile is not None):
        return ()
    if shape.kind == "plane":
        return (Cell(np.array([[0.0, 0.0, 1.0]]), np.zeros(1)),)
    if shape.kind in ("box", "polyhedron"):
        return (_of_facets(box_facets(shape) if shape.kind == "box" else polyhedron_facets(shape)),)
    if shape.kind == "extrusion":
        polygon, half = corners(shape), shape.parameters[-1][1] / 2
        return tuple(_prism(polygon[piece], half) for piece in convex_pieces(polygon))
    return ()


def _of_facets(facets: Facets) -> Cell:
    normals = np.array([normal_of(facets.points, loop) for loop in facets.loops])
    centres = np.array([facets.points[list(loop)].mean(axis=0) for loop in facets.loops])
    return Cell(normals, (normals * centres).sum(axis=1))


def _prism(polygon: Array, half: float) -> Cell:
    side = np.roll(polygon, -1, axis=0) - polygon
    outward = np.column_stack([side[:, 1], -side[:, 0], np.zeros(len(side))])
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    normals = np.vstack([outward, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    return Cell(normals, np.append((outward[:, :2] * polygon).sum(axis=1), [half, half]))


def range_of(edge: Feature) -> tuple[float, float]:
    """Curve parameters at which an edge begins and ends."""
    low, high = domain_of(edge.shape)[0]
    for condition in edge.conditions:
        if condition.kind == "parameter":
            _, sign, bound = condition.numbers
            low, high = (max(low, bound), high) if sign > 0 else (low, min(high, bound))
    return low, high


def ends_of(edge: Feature) -> Array:
    """(2, 3) m: both ends of a straight edge in the axes of its shape."""
    pose = edge.shape.pose
    along = rotation_of(pose.quaternion)[:, 0]
    return np.asarray(np.array(pose.position) + np.outer(range_of(edge), along))


def highest(feature: Feature, cell: Cell, others: dict[str, Feature]) -> Array | None:
    """(n,) m: how far an edge or face reaches out of each plane of a cell, at most; None where it is unknown.

    `others`: the features of the shape by name, among them the edges of a face.
    """
    shape = feature.shape
    if shape.kind == "edge":
        return np.asarray(cell.heights(ends_of(feature)).max(axis=0))
    if shape.kind == "circle":
        axis = rotation_of(shape.pose.quaternion)[:, 2]
        across = np.sqrt(np.maximum(1 - (cell.normals @ axis) ** 2, 0.0))
        return np.asarray(cell.heights(np.array(shape.pose.position)) + shape.parameters[0][1] * across)
    if feature.dimension == 2 and shape.kind in RULED and feature.conditions:
        edges = [others.get(each.next or "") for each in feature.conditions]
        if any(each is None or each.dimension != 1 for each in edges):
            return None
        bounds = [highest(each, cell, others) for each in edges if each is not None]
        known = [each for each in bounds if each is not None]
        return np.asarray(np.max(known, axis=0)) if len(known) == len(edges) else None
    return None


def is_bounded(edge: Feature) -> bool:
    """Whether a straight edge has two ends."""
    return all(map(isfinite, range_of(edge)))
