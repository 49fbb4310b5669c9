"""A mesh that is not convex stands as its hull: the scene says so, and its runs are not trusted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from modelgen import import_scene, simulate
from modelgen.importing.import_formats import Imported
from modelgen.importing.mujoco_shapes import unlike_its_hull
from modelgen.scene.read import read_text
from tests.running import library_of

pytest.importorskip("mujoco")

CORNERS = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)
"""Triangles of a cube, with outward normals."""


def dented(depth: float) -> tuple[np.ndarray, np.ndarray]:
    """The cube with a pyramid cut into its upper face."""
    centre = len(CORNERS)
    sides = [[a, b, centre] for a, b in ((1, 5), (5, 7), (7, 3), (3, 1))]
    return np.vstack([CORNERS, [0.0, 0.0, 0.1 - depth]]), np.array([*FACES[:10].tolist(), *sides])


def imported(points: np.ndarray, faces: np.ndarray, tmp_path: Path, contacts: str = "") -> Imported:
    written = (" ".join(f"{each:.17g}" for each in array.ravel()) for array in (points, faces))
    vertices, triangles = written
    path = tmp_path / "mesh.xml"
    path.write_text(
        f"""<mujoco><asset><mesh name="block" vertex="{vertices}" face="{triangles}"/></asset><worldbody>
        <geom type="plane" size="1 1 1"/>
        <body name="falling" pos="0 0 0.3"><freejoint/><geom type="mesh" mesh="block" {contacts}/></body>
        </worldbody></mujoco>"""
    )
    return import_scene(path)


def test_a_mesh_with_a_dent_says_that_it_stands_as_its_hull(tmp_path: Path) -> None:
    found = imported(*dented(0.15), tmp_path)
    shape = next(body for body in found.scene.bodies if body.name == "falling").shapes[0]
    assert shape.stands_for == "a mesh that fills 75 % of its hull"
    again = read_text(found.text, "again.toml")  # as it is written to a file and read from it
    path = simulate(library_of(again), until=0.05, samples=1)
    assert not path.is_trusted
    assert "stand-in" in path.doubt_kinds
    assert any("fills 75 % of its hull" in doubt for doubt in path.doubts)
    assert any("contacts are with this shape" in warning for warning in path.warnings)


def test_a_convex_mesh_is_its_hull(tmp_path: Path) -> None:
    found = imported(CORNERS, FACES, tmp_path)
    assert "stands_for" not in found.text
    path = simulate(library_of(found.scene), until=0.05, samples=1)
    assert path.is_trusted


def test_a_mesh_that_touches_nothing_is_no_doubt(tmp_path: Path) -> None:
    found = imported(*dented(0.15), tmp_path, 'contype="0" conaffinity="0"')
    path = simulate(library_of(found.scene), until=0.05, samples=1)
    assert path.is_trusted


@pytest.mark.parametrize("seed", range(20))
def test_what_a_mesh_leaves_of_its_hull_is_told(seed: int) -> None:
    """Random convex meshes, with and without a dent of a known volume, and with a face left out."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(12, 3))
    hull = ConvexHull(points)
    outward = [
        face if np.cross(*(points[face[1:]] - points[face[0]])) @ normal > 0 else face[::-1]
        for face, normal in zip(hull.simplices, hull.equations[:, :3], strict=True)
    ]
    faces = np.array(outward)
    assert unlike_its_hull(points, faces) == ""
    assert unlike_its_hull(points, faces[:-1]) == "a mesh that is not closed"
    a, b, c = faces[0]
    inner = points.mean(axis=0)
    lost = abs(np.linalg.det(points[faces[0]] - inner)) / 6
    cut = np.vstack([faces[1:], [[a, b, len(points)], [b, c, len(points)], [c, a, len(points)]]])
    share = 100 * (1 - lost / hull.volume)
    assert unlike_its_hull(np.vstack([points, inner]), cut) == f"a mesh that fills {share:.3g} % of its hull"
