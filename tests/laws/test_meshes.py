"""Triangles for drawing lie on the shape and cover it, within what was allowed."""

from __future__ import annotations

from math import isfinite

import casadi as ca
import numpy as np
import pytest
from scipy.spatial import cKDTree

from modelgen.geometry.body_meshes import Mesh, body_mesh
from modelgen.geometry.coordinate_domains import domain_of
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.face_meshes import FaceMesh, face_mesh
from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.shape_features import features_of
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Body, Shape
from tests.laws.shapes import SPECIMENS, Specimen

TOLERANCE = 3e-2  # of the size
REACH = 0.8  # m, of what has no end
DENSE = 60  # points along a coordinate of the independent chart
PARTS = 4  # of an edge of a triangle
INNER = np.array([(a, b, PARTS - a - b) for a in range(PARTS + 1) for b in range(PARTS + 1 - a)]) / PARTS
ROUNDING = 1e-9  # m


def shape_of(specimen: Specimen) -> Shape:
    kind = specimen.kind
    numbers = tuple(zip(kind.parameter_names, specimen.parameters, strict=True))
    return Shape(kind.kind, numbers, cavity=kind.cavity, chart=kind.chart)


def inside(mesh: FaceMesh | Mesh) -> np.ndarray:
    """Points of all triangles, their corners included, (n, 3)."""
    return np.einsum("kb,mbx->mkx", INNER, mesh.vertices[mesh.triangles]).reshape(-1, 3)


class Chart:
    """The independent chart of a specimen, over the coordinates that the mesh covers."""

    def __init__(self, specimen: Specimen, ends: list[tuple[float, float]]) -> None:
        at = ca.SX.sym("uv", 2)
        x = ca.vertcat(*specimen.chart(ca, at[0], at[1], specimen.parameters))
        self.function = ca.Function("x", [at], [ca.densify(x), ca.densify(ca.jacobian(x, at))])
        self.low, self.high = np.array(ends).T
        lines = [np.linspace(*each, DENSE) for each in ends]
        self.uv = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        self.points = self(self.uv)[0]

    def __call__(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, jacobian = self.function(uv.T)
        columns = np.asarray(jacobian).reshape(3, len(uv), 2)
        return np.asarray(x).T, columns.transpose(1, 0, 2)

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Distances of points from the surface, by steps of Gauss and Newton from the nearest sample."""
        uv = self.uv[cKDTree(self.points).query(points)[1]]
        best = np.full(len(points), np.inf)
        for _ in range(5):
            x, jacobian = self(uv)
            off = points - x
            best = np.minimum(best, np.linalg.norm(off, axis=1))
            square = np.einsum("nxi,nxj->nij", jacobian, jacobian) + 1e-12 * np.eye(2)
            step = np.linalg.solve(square, np.einsum("nxi,nx->ni", jacobian, off)[..., None])[..., 0]
            uv = np.clip(uv + step, self.low, self.high)
        return best


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", SPECIMENS)
def test_faces_lie_on_their_surface_and_cover_it(name: str) -> None:
    specimen = SPECIMENS[name]
    shape = shape_of(specimen)
    face = features_of(shape).features[0]
    radius = bounding_radius(shape)
    size = radius if isfinite(radius) else REACH
    allowed = TOLERANCE * size
    mesh = face_mesh(face, size, allowed)
    assert mesh.deviation <= allowed
    chart = Chart(specimen, _ends(shape, size))
    points = inside(mesh)
    assert chart.distances(points).max() <= allowed + ROUNDING
    corners = mesh.vertices[mesh.triangles]
    spacing = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() / PARTS
    assert cKDTree(points).query(chart.points)[0].max() <= allowed + spacing
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((flat * mesh.normals[mesh.triangles].sum(axis=1)).sum(axis=1) > 0).all()


def _ends(shape: Shape, size: float) -> list[tuple[float, float]]:
    return [(a if isfinite(a) else -size, b if isfinite(b) else size) for a, b in domain_of(shape)]


SOLIDS = {
    "sphere": 'kind = "sphere", radius = 0.3',
    "ellipsoid": 'kind = "ellipsoid", semi_axes = [0.3, 0.2, 0.1]',
    "superellipsoid": 'kind = "superellipsoid", semi_axes = [0.3, 0.2, 0.1], exponents = [8.0, 12.0]',
    "torus": 'kind = "torus", major = 0.3, minor = 0.1',
    "box": 'kind = "box", size = [0.1, 0.2, 0.3]',
    "rod": 'kind = "cylinder", radius = 0.01, length = 1.0',
    "plate": 'kind = "cylinder", radius = 1.0, length = 0.01',
    "capsule": 'kind = "capsule", radius = 0.1, length = 0.4',
    "tube": 'kind = "tube", radius = 0.3, bore = 0.2, length = 1.0',
    "frustum": 'kind = "frustum", radius_bottom = 0.3, radius_top = 0.1, length = 0.4',
    "dome": 'kind = "dome", radius = 1.0, length = 0.1',
    "half_torus": 'kind = "half_torus", major = 0.07, minor = 0.03',
    "polyhedron": 'kind = "polyhedron", vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]',
    "wedge": 'kind = "extrusion", points = [[0, 0], [1, 0], [0, 1]], length = 0.2',
    "oval": 'kind = "extrusion", x = "0.04*cos(t)", y = "0.025*sin(t)", domain = [0, "2*pi"], length = 0.02',
    "bean": 'kind = "revolution", r = "0.2*sin(t)", z = "-0.3*cos(t)", domain = [0.0, "pi"]',
}


def body_of(shape: str) -> Body:
    return read_text(f'[[body]]\nname = "b"\nmotion = "fixed"\nshape = {{ {shape} }}\n').bodies[0]


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", SOLIDS)
def test_solids_have_their_volume(name: str) -> None:
    """What lies between the triangles and the surface is at most area times distance."""
    body = body_of(SOLIDS[name])
    (shape,) = body.shapes
    mesh = body_mesh(body, (0.0, 0.0, 0.0), REACH, TOLERANCE)
    allowed = TOLERANCE * bounding_radius(shape)
    assert mesh.deviation <= allowed
    corners = mesh.vertices[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    volume, area = float((corners.mean(axis=1) * flat).sum() / 3), float(np.linalg.norm(flat, axis=1).sum())
    assert abs(volume - mass_properties(shape, 1.0)[0]) <= area * mesh.deviation + 1e-9 * area * allowed
    outward = np.linalg.norm(flat.sum(axis=0)) / area
    assert outward <= 2 * mesh.deviation / bounding_radius(shape) + 1e-9  # nothing is missing


def test_edges_lie_on_the_faces_that_meet_there() -> None:
    mesh = body_mesh(body_of(SOLIDS["tube"]), (0.0, 0.0, 0.0), REACH, TOLERANCE)
    radii = np.hypot(*mesh.lines.reshape(-1, 3)[:, :2].T)
    assert np.minimum(np.abs(radii - 0.3), np.abs(radii - 0.2)).max() < 1e-12
    assert np.abs(np.abs(mesh.lines[..., 2]) - 0.5).max() < 1e-12
