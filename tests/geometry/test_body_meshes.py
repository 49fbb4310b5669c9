"""Meshes of bodies lie on their shapes, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.geometry.body_meshes import Mesh, body_mesh
from modelgen.scene.read import read_text

TOLERANCE = 4e-3


def meshed(shape: str, tolerance: float = TOLERANCE) -> Mesh:
    scene = read_text(f'[[body]]\nname = "b"\nmotion = "fixed"\nshape = {shape}\n', "scene.toml")
    return body_mesh(scene.bodies[0], (0.0, 0.0, 0.0), 2.0, tolerance)


def middles(mesh: Mesh) -> np.ndarray:
    return mesh.vertices[mesh.triangles].mean(axis=1)


ROUND = {
    '{ kind = "sphere", radius = 0.5 }': lambda x: np.linalg.norm(x, axis=1) - 0.5,
    '{ kind = "ellipsoid", semi_axes = [0.3, 0.4, 0.5] }': lambda x: (
        0.5 * (np.sqrt((x**2 / np.array([0.09, 0.16, 0.25])).sum(axis=1)) - 1)
    ),
    '{ kind = "torus", major = 0.4, minor = 0.1 }': lambda x: (
        np.hypot(np.hypot(x[:, 0], x[:, 1]) - 0.4, x[:, 2]) - 0.1
    ),
}


@pytest.mark.cases(1)
@pytest.mark.parametrize("shape", ROUND)
def test_triangles_of_smooth_shapes_stay_within_the_tolerance(shape: str) -> None:
    mesh = meshed(shape)
    assert np.abs(ROUND[shape](mesh.vertices)).max() < 1e-12
    assert np.abs(ROUND[shape](middles(mesh))).max() < 2 * TOLERANCE * 0.5
    corners = mesh.vertices[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    large = np.linalg.norm(flat, axis=1) > 1e-12
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    outward = (np.abs(flat[large]) > 0).any(axis=1)
    assert outward.all()
    finer = meshed(shape, TOLERANCE / 16)
    assert len(finer.triangles) > 4 * len(mesh.triangles)


def area(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(flat, axis=1).sum() / 2)


def test_a_box_has_its_faces_and_edges() -> None:
    mesh = meshed('{ kind = "box", size = [0.2, 0.4, 0.6] }')
    assert area(mesh) == pytest.approx(2 * (0.2 * 0.4 + 0.4 * 0.6 + 0.6 * 0.2), rel=1e-9)
    lengths = np.linalg.norm(mesh.lines[:, 1] - mesh.lines[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(4 * (0.2 + 0.4 + 0.6), rel=1e-9)
    assert np.abs(mesh.vertices).max(axis=0) == pytest.approx([0.1, 0.2, 0.3])


def test_a_solid_cylinder_ends_at_its_rims() -> None:
    mesh = meshed('{ kind = "cylinder", radius = 0.3, length = 0.8 }', 1e-3)
    exact = 2 * np.pi * 0.3 * (0.3 + 0.8)
    assert area(mesh) == pytest.approx(exact, rel=5e-3)
    assert np.abs(mesh.vertices[:, 2]).max() == pytest.approx(0.4, rel=1e-9)
    assert np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1]).max() == pytest.approx(0.3, rel=1e-9)


def test_a_plane_is_cut_at_the_reach() -> None:
    mesh = meshed('{ kind = "plane" }')
    assert np.abs(mesh.vertices).max(axis=0) == pytest.approx([2.0, 2.0, 0.0])
    assert np.allclose(mesh.normals, [0, 0, 1])


def test_a_curve_is_lines() -> None:
    mesh = meshed('{ kind = "circle", radius = 0.5 }')
    assert not len(mesh.triangles)
    assert np.allclose(np.linalg.norm(mesh.lines, axis=-1), 0.5)
