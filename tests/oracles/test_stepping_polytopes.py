"""Boxes, prisms and polyhedra fast on each other: none is in another without being told."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.running import library_of

SIZE, SOLIDS = 0.05, 5  # m
CHORD = 1e-4  # m: samples within steps lie on chords
STEPS = (0.002, 0.003, 0.005)  # s


def corners_of(rng: np.random.Generator, kind: str) -> np.ndarray:
    """(n, 3) m: the corners of a random solid, in axes through its centre."""
    if kind == "box":
        corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T * rng.uniform(0.4, 1.0, 3)
    elif kind == "prism":
        angles = np.arange(n := int(rng.integers(3, 7))) * 2 * np.pi / n
        base = np.column_stack([np.cos(angles), np.sin(angles)])
        height = rng.uniform(0.4, 1.0)
        corners = np.vstack([np.column_stack([base, np.full(n, z)]) for z in (-height, height)])
    else:
        corners = rng.normal(size=(int(rng.integers(5, 9)), 3))
        corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    corners = SIZE * corners[ConvexHull(corners).vertices]
    return corners - centroid(corners)


def centroid(corners: np.ndarray) -> np.ndarray:
    """(3,) m: the centre of mass of the convex hull, of tetrahedra from a point in it to its faces."""
    hull, inner = ConvexHull(corners), corners.mean(axis=0)
    triangles = corners[hull.simplices]
    volumes = np.abs(np.linalg.det(triangles - inner))
    found: np.ndarray = np.average((triangles.sum(axis=1) + inner) / 4, axis=0, weights=volumes)
    return found


@cache
def solids(seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    return tuple(corners_of(rng, ("box", "prism", "polyhedron")[(seed + i) % 3]) for i in range(SOLIDS))


@cache
def scene(seed: int) -> Library:
    bodies = [
        make.dynamic(
            f"s{i}", make.polyhedron(corners.tolist()), density=1000.0, position=[0.0, 0.0, 0.13 * i]
        )
        for i, corners in enumerate(solids(seed))
    ]
    return library_of(make.scene("solids", bodies, contacts={"between": "all", "friction": 0.4}))


def thrown(seed: int, throw: int) -> Library:
    """The solids at random orientations, thrown at each other."""
    rng, library = np.random.default_rng([seed, throw]), scene(seed)
    x, u = (np.array(library.manifest.instance[key], dtype=float) for key in ("initial_q", "initial_u"))
    for i in range(SOLIDS):
        x[7 * i : 7 * i + 2] = rng.uniform(-0.02, 0.02, 2)
        x[7 * i + 3 : 7 * i + 7] = Rotation.random(rng=rng).as_quat(scalar_first=True)
        u[6 * i : 6 * i + 6] = [
            *rng.uniform(-0.5, 0.5, 2),
            (2 - i) * rng.uniform(0.3, 1.5),
            *rng.normal(0, 6, 3),
        ]
    return library.with_instance(
        library.manifest.instance | {"initial_q": x.tolist(), "initial_u": u.tolist()}
    )


@cache
def axes_of(seed: int, solid: int) -> tuple[np.ndarray, np.ndarray]:
    """Normals of the faces and directions of the edges of a solid, in its axes."""
    corners = solids(seed)[solid]
    hull = ConvexHull(corners)
    edges = np.vstack([corners[face[[1, 2, 0]]] - corners[face] for face in hull.simplices])
    return hull.equations[:, :3], edges / np.linalg.norm(edges, axis=1, keepdims=True)


def depth(seed: int, i: int, j: int, p: np.ndarray, R: list[np.ndarray]) -> float:
    """m: by how much two solids overlap along the axis along which they do so least; negative where apart."""
    (faces_i, edges_i), (faces_j, edges_j) = axes_of(seed, i), axes_of(seed, j)
    crossed = np.cross((edges_i @ R[i].T)[:, None], (edges_j @ R[j].T)[None]).reshape(-1, 3)
    size = np.linalg.norm(crossed, axis=1)
    axes = np.vstack([faces_i @ R[i].T, faces_j @ R[j].T, crossed[size > 1e-6] / size[size > 1e-6, None]])
    along_i, along_j = (axes @ (solids(seed)[k] @ R[k].T + p[k]).T for k in (i, j))
    ahead, behind = along_i.max(axis=1) - along_j.min(axis=1), along_j.max(axis=1) - along_i.min(axis=1)
    return float(np.minimum(ahead, behind).min())


def deepest(path: Trajectory, seed: int, sample: int) -> float:
    """m: the deepest penetration at a sample."""
    p, R = path.p[sample], list(Rotation.from_quat(path.quaternion[sample], scalar_first=True).as_matrix())
    near = [(i, j) for i, j in combinations(range(SOLIDS), 2) if np.linalg.norm(p[i] - p[j]) < 3.5 * SIZE]
    return max((depth(seed, i, j, p, R) for i, j in near), default=-1.0)


@pytest.mark.cases(4)
@pytest.mark.parametrize("throw", range(12))
@pytest.mark.parametrize("seed", [1, 0])
def test_a_run_tells_what_is_in_another(seed: int, throw: int) -> None:
    step = STEPS[throw % len(STEPS)]
    path = simulate(
        thrown(seed, throw),
        until=0.3,
        method="time-stepping",
        step=step,
        accuracy="fast",
        samples=round(0.3 / step),
        estimate=False,
    )
    found = np.array([deepest(path, seed, k) for k in range(len(path.t))])
    assert found[-1] < path.penetration_max + 1e-9
    assert found.max() < path.penetration_max + CHORD


@pytest.mark.cases(4)
@pytest.mark.parametrize("throw", range(12))
@pytest.mark.parametrize("seed", [2, 0])
def test_an_event_driven_run_tells_it_too(seed: int, throw: int) -> None:
    path = simulate(
        thrown(seed, throw), until=0.3, accuracy="fast", samples=100, estimate=False, fallback=False
    )
    found = [deepest(path, seed, k) for k in range(len(path.t))]
    assert path.t_end > 0.05  # some end where a search comes too late, and say so
    assert path.events
    assert max(found) < path.penetration_max + 1e-8
