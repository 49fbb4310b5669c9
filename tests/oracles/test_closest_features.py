"""Contacts at the start of a run are the closest points of the shapes, found by geometry without features."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar, nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.running import library_of

RADIUS = 0.03  # of the ball, m
POSES = 40
POINTS = np.random.default_rng(5).normal(size=(9, 3))
GEM = 0.05 * POINTS / np.linalg.norm(POINTS, axis=1)[:, None]
CORNERS = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.03, 0.03) for z in (-0.02, 0.02)])


def to_segment(x: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """The distance of x to the segment from a to b."""
    share = np.clip((x - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return float(np.linalg.norm(x - a - share * (b - a)))


def turned_profile(profile: Sequence[tuple[float, float]]) -> Callable[[np.ndarray], float]:
    """The distance of an outer point to a solid of revolution whose profile (r, z) is an open polygon."""
    corners = np.array(profile)

    def distance(x: np.ndarray) -> float:
        at = np.array([np.hypot(x[0], x[1]), x[2]])
        return min(to_segment(at, a, b) for a, b in pairwise(corners))

    return distance


def to_torus(x: np.ndarray) -> float:
    return float(np.hypot(np.hypot(x[0], x[1]) - 0.06, x[2])) - 0.02


def to_dome(radius: float, height: float) -> Callable[[np.ndarray], float]:
    """The distance to the part of a ball about (0, 0, height - radius) above z = 0."""
    rim, centre = np.sqrt(height * (2 * radius - height)), height - radius

    def distance(x: np.ndarray) -> float:
        r, z = np.hypot(x[0], x[1]), x[2]
        from_centre = np.hypot(r, z - centre)
        candidates = [np.hypot(r - rim, z)]
        candidates += [abs(from_centre - radius)] if centre + (z - centre) * radius / from_centre >= 0 else []
        candidates += [abs(z)] if r <= rim else []
        return float(min(candidates)) * (-1 if z >= 0 and from_centre <= radius else 1)

    return distance


def to_hull(points: np.ndarray) -> Callable[[np.ndarray], float]:
    """The distance to a convex hull, by Lawson and Hanson's reduction of the projection to nnls."""
    planes = np.unique(ConvexHull(points).equations.round(12), axis=0)

    def distance(x: np.ndarray) -> float:
        E = np.vstack([-planes[:, :3].T, planes[:, :3] @ x + planes[:, 3]])
        f = np.array([0.0, 0.0, 0.0, 1.0])
        residual = E @ nnls(E, f)[0] - f
        return float(np.linalg.norm(residual[:3] / residual[3]))

    return distance


SOLIDS: dict[str, tuple[Callable[[], Shape], Callable[[np.ndarray], float]]] = {
    "box": (lambda: make.box(0.1, 0.06, 0.04), to_hull(CORNERS)),
    "cylinder": (
        lambda: make.cylinder(0.03, 0.09),
        turned_profile(((0, 0.045), (0.03, 0.045), (0.03, -0.045), (0, -0.045))),
    ),
    "tube": (
        lambda: make.tube(0.06, 0.04, 0.09),
        turned_profile(((0.04, 0.045), (0.06, 0.045), (0.06, -0.045), (0.04, -0.045), (0.04, 0.045))),
    ),
    "frustum": (
        lambda: make.frustum(0.05, 0.02, 0.08),
        turned_profile(((0, 0.04), (0.02, 0.04), (0.05, -0.04), (0, -0.04))),
    ),
    "hemisphere": (lambda: make.dome(0.06, 0.06), to_dome(0.06, 0.06)),
    "low_dome": (lambda: make.dome(0.08, 0.03), to_dome(0.08, 0.03)),
    "high_dome": (lambda: make.dome(0.05, 0.08), to_dome(0.05, 0.08)),
    "disc": (lambda: make.disc(0.04), turned_profile(((0, 0), (0.04, 0)))),
    "gem": (lambda: make.polyhedron(GEM.tolist()), to_hull(GEM)),
    "torus": (lambda: make.torus(0.06, 0.02), to_torus),
}


@cache
def pair(name: str, other: str) -> Library:
    shapes = {"ball": lambda: make.sphere(RADIUS), **{key: each[0] for key, each in SOLIDS.items()}}
    bodies = [
        make.dynamic(each, shapes[kind](), mass=1.0, inertia=[1e-3] * 3, position=[0.0, 0.0, z])
        for each, kind, z in (("a", name, 0.0), ("b", other, 1.0))
    ]
    contact = [{"between": ["a", "b"]}]
    return library_of(make.scene(f"{name}_{other}", bodies, contact=contact, gravity=[0.0, 0.0, 0.0]))


def gaps_at(library: Library, poses: list[tuple[np.ndarray, Rotation]]) -> list[float]:
    """The gaps of the contacts at the start with the bodies at these poses, least first."""
    session = Session(library, Accuracy.balanced())
    for body, (p, turn) in zip(session.instance["bodies"], poses, strict=True):
        session.x[body["q"] : body["q"] + 3] = p
        if body["motion"] == "free":
            session.x[body["q"] + 3 : body["q"] + 7] = np.roll(turn.as_quat(), 1)
    begin(session)
    return sorted(
        float(session.settle(i)["d"]) for i in range(session.n_contact) if session.feature_pair[i] >= 0
    )


@pytest.mark.cases(3)
@pytest.mark.parametrize("name", SOLIDS)
def test_a_ball_touches_the_closest_point_of_a_solid(name: str) -> None:
    library, distance = pair(name, "ball"), SOLIDS[name][1]
    rng, n = np.random.default_rng(11), 0
    while n < POSES:
        centre = rng.uniform(-0.13, 0.13, 3)
        gap = distance(centre) - RADIUS
        if gap < 1e-6 or (name == "torus" and np.hypot(*centre[:2]) < 0.01):
            continue
        n += 1
        p, turn = rng.normal(size=3), Rotation.random(random_state=rng)
        found = gaps_at(library, [(p, turn), (p + turn.apply(centre), Rotation.identity())])
        assert found[:1] == pytest.approx([gap], abs=2e-9), centre


@pytest.mark.slow
def test_polyhedra_touch_no_nearer_than_they_are() -> None:
    """The distance is that of 0 to the Minkowski difference; between two vertices no contact is followed."""
    library = pair("gem", "box")
    rng, followed = np.random.default_rng(12), 0
    for _ in range(POSES):
        turns = Rotation.random(2, random_state=rng)
        away = rng.normal(size=3)
        p = 0.14 * away / np.linalg.norm(away)
        difference = (turns[0].apply(GEM)[:, None] - (p + turns[1].apply(CORNERS))[None]).reshape(-1, 3)
        distance = to_hull(difference)(np.zeros(3))
        found = gaps_at(library, [(np.zeros(3), turns[0]), (p, turns[1])])
        assert not found or found[0] > distance - 2e-9
        followed += bool(found) and found[0] == pytest.approx(distance, abs=2e-9)
    assert followed > POSES / 3


def between_tori(p: np.ndarray, turn: Rotation) -> float:
    """The distance of the torus at the origin to its like, from that of a circle's points to a circle."""

    def at(angle: float) -> float:
        centre = p + turn.apply([0.06 * np.cos(angle), 0.06 * np.sin(angle), 0.0])
        return to_torus(centre) - 0.02

    angles = np.linspace(0, 2 * np.pi, 721)
    best = angles[np.argmin([at(angle) for angle in angles])]
    step = angles[1]
    polished = minimize_scalar(
        at, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9}
    )
    return float(polished.fun)


def test_tori_touch_where_a_dense_sampling_finds_them_closest() -> None:
    """Their distance has several minima, linked or not, so that what is found depends on the starts."""
    library = pair("torus", "torus")
    rng, n = np.random.default_rng(13), 0
    while n < POSES:
        turns, p = Rotation.random(2, random_state=rng), rng.uniform(-0.15, 0.15, 3)
        gap = between_tori(turns[0].inv().apply(p), turns[0].inv() * turns[1])
        if gap < 1e-6:
            continue
        n += 1
        found = gaps_at(library, [(np.zeros(3), turns[0]), (p, turns[1])])
        assert found[:1] == pytest.approx([gap], abs=2e-9), (p, turns.as_quat())
