"""The centre of pressure and the regions of faces, against routes of their own."""

from __future__ import annotations

from functools import cache
from math import cos, sin

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, HalfspaceIntersection

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import rotations
from tests.planar.overlaps import patch_overlap
from tests.planar.scenes import HEIGHT, MASS, TIGHT, G, events, pushed, resting
from tests.running import library_of

L_SHAPE = [[-0.02 + 0.01 * x, -0.02 + 0.01 * y] for x, y in ((0, 0), (6, 0), (6, 2), (2, 2), (2, 6), (0, 6))]


def reach_of_hull(points: np.ndarray, direction: np.ndarray) -> float:
    """How far a ray from the origin goes in the convex hull of points (n, 2)."""
    equations = ConvexHull(points).equations
    slopes = equations[:, :2] @ direction
    ahead = slopes > 0
    return float((-equations[ahead, 2] / slopes[ahead]).min())


@pytest.mark.parametrize(
    "angle",
    [0.3, pytest.param(1.1, marks=pytest.mark.slow), 2.0, pytest.param(3.5, marks=pytest.mark.slow), 5.0],
)
def test_an_l_shape_tips_where_the_ray_of_its_pressure_leaves_its_convex_hull(angle: float) -> None:
    """Over the notch the hull's edge is no edge of the face: its ends are two corners."""
    direction = np.array([np.cos(angle), np.sin(angle)])
    reach = reach_of_hull(np.array(L_SHAPE), direction)
    time = reach * MASS * G / (2.0 * 0.03)
    force = [f"{2 * float(direction[0])!r}*t", f"{2 * float(direction[1])!r}*t", "0"]
    path = pushed(make.extrusion(HEIGHT, points=L_SHAPE), force, [0, 0, 0.03], time + 0.01, 4)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(time, abs=1e-9)


@pytest.mark.cases(1)
@pytest.mark.parametrize(
    "angle", [0.0, 0.4, pytest.param(1.0, marks=pytest.mark.slow), pytest.param(2.5, marks=pytest.mark.slow)]
)
def test_an_elliptic_base_tips_where_the_ray_of_its_pressure_leaves_the_ellipse(angle: float) -> None:
    a, b = 0.04, 0.03
    reach = 1 / np.hypot(np.cos(angle) / a, np.sin(angle) / b)
    time = reach * MASS * G / (2.0 * 0.03)
    outline = {"x": "a*cos(t)", "y": "b*sin(t)", "domain": ["-pi", "pi"], "parameters": {"a": a, "b": b}}
    shape = make.extrusion(HEIGHT, **outline)
    force = [f"{2 * cos(angle)!r}*t", f"{2 * sin(angle)!r}*t", "0"]
    path = pushed(shape, force, [0, 0, 0.03], time + 1e-4, 4)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(time, abs=1e-9)


@pytest.mark.slow
@given(
    corners=st.integers(3, 7),
    seed=st.integers(0, 10**6),
    push=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-1.0, 1.0)),
    spin=st.floats(-3, 3),
)
@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
def test_the_centre_of_pressure_is_that_of_the_balance_of_momentum(
    corners: int, seed: int, push: tuple[float, float, float], spin: float
) -> None:
    """Newton and Euler about the centre of mass with the accelerations of the run: N = m (g + a_z) - F_z and
    (x - p) x N = dL/dt - (arm x F), whatever the base; the run knows neither moment nor arm."""
    rng = np.random.default_rng(seed)
    base = rng.normal(size=(corners + 6, 2)) * 0.03
    hull = base[ConvexHull(base).vertices] + 0.01
    arm = rng.normal(size=3) * 0.02
    force = np.array(push)
    path = pushed(
        make.extrusion(HEIGHT, points=hull.tolist()), [repr(x) for x in push], arm.tolist(), 0.2, 20,
        angular_velocity=[0, 0, spin],
    )  # fmt: skip
    rests = resting(path)
    turned = np.einsum("nij,j->ni", rotations(path, 1), arm)[rests]
    momentum_rate = np.zeros((len(rests), 3))  # the inertia is round about z, the spin along z
    N = MASS * G - force[2]
    moment = momentum_rate - np.cross(turned, force)
    lever = np.column_stack([-moment[:, 1], moment[:, 0]]) / N
    found = path.patch_point[rests, 0, :2] - path.p[rests, 1, :2]
    assert path.patch_force[rests, 0] == pytest.approx(np.full(len(rests), N), rel=1e-11)
    assert found == pytest.approx(lever, abs=1e-11)


@cache
def bricks() -> tuple[Library, Trajectory]:
    """A brick that slides and turns on a brick, its corners passing over edges."""
    low = make.fixed("low", make.box(0.3, 0.2, 0.1, position=[0, 0, -0.05]))
    up = make.dynamic(
        "up", make.box(0.2, 0.16, 0.05), density=1000.0, position=[-0.05, -0.03, 0.025],
        axis_angle={"axis": [0, 0, 1], "angle": 0.3}, velocity=[0.2, 0.1, 0], angular_velocity=[0, 0, 2.0],
    )  # fmt: skip
    library = library_of(make.scene("bricks", [low, up], contact=[{"between": ["low", "up"]}]))
    return library, simulate(library, until=0.7, samples=100, accuracy=TIGHT)


def test_a_brick_slides_across_the_corners_of_another_on_one_planar_contact() -> None:
    _, path = bricks()
    assert [event.kind for event in path.events] == ["face-contact"]
    weight = 1000.0 * 0.2 * 0.16 * 0.05 * G
    assert path.patch_force[:, 0] == pytest.approx(weight, rel=1e-10)
    assert path.patch_point[:, 0, :2] == pytest.approx(path.p[:, 1, :2], abs=1e-10)
    straight = np.array([-0.05, -0.03]) + np.outer(path.t, [0.2, 0.1])
    assert path.p[:, 1, :2] == pytest.approx(straight, abs=1e-12)


def test_the_force_between_two_bricks_does_not_jump_where_the_polygon_of_their_patch_changes() -> None:
    """At neighbouring samples: what bears the weight knows nothing of the polygon."""
    _, path = bricks()
    corners = [len(polygon_of_patch(path, sample)) for sample in range(len(path.t))]
    changes = np.flatnonzero(np.diff(corners))
    assert len(set(corners)) > 2
    assert len(changes) > 3
    force, at = path.patch_force[:, 0], path.patch_point[:, 0, :2] - path.p[:, 1, :2]
    assert np.abs(np.diff(force)[changes]).max() < 1e-12 * force[0]
    assert np.abs(np.diff(at, axis=0)[changes]).max() < 1e-12


def polygon_of_patch(path: Trajectory, sample: int) -> np.ndarray:
    """The lower brick's rectangle cut by the upper one's four half-planes, one after the other."""
    (x, y), (a, b) = (0.15, 0.1), (0.1, 0.08)
    polygon = [np.array(corner) for corner in ((x, y), (-x, y), (-x, -y), (x, -y))]
    R, p = rotations(path, 1)[sample][:2, :2], path.p[sample, 1, :2]
    for normal, reach in ((R[:, 0], a), (-R[:, 0], a), (R[:, 1], b), (-R[:, 1], b)):
        inside = [reach - normal @ (corner - p) for corner in polygon]
        kept = []
        for k, corner in enumerate(polygon):
            if inside[k - 1] * inside[k] < 0:
                share = inside[k - 1] / (inside[k - 1] - inside[k])
                kept.append(polygon[k - 1] + share * (corner - polygon[k - 1]))
            if inside[k] >= 0:
                kept.append(corner)
        polygon = kept
    return np.array(polygon)


def test_the_corners_of_the_patch_of_two_bricks_are_those_of_a_clipped_rectangle() -> None:
    """At a hundred sampled times, whichever corner comes first."""
    library, path = bricks()
    for sample in range(len(path.t)):
        known = polygon_of_patch(path, sample)
        found = patch_overlap(library, path, sample, int(path.patch[sample, 0]))
        assert len(found.hull) == len(known)
        away = np.linalg.norm(np.asarray(found.hull)[:, None] - known[None], axis=2)
        assert away.min(axis=0).max() < 1e-12
        assert away.min(axis=1).max() < 1e-12


def test_the_region_of_two_bricks_is_the_intersection_of_their_rectangles() -> None:
    """At a hundred sampled times, by half-planes: the area of the outline, and the margin of the pressure."""
    library, path = bricks()
    halves = (np.array([0.15, 0.1]), np.array([0.1, 0.08]))
    for sample in range(len(path.t)):
        p = path.p[sample, 1, :2]
        planes = [
            [*(sign * R[:, axis]), -(half[axis] + sign * R[:, axis] @ at)]
            for half, R, at in (
                (halves[0], np.eye(2), np.zeros(2)),
                (halves[1], rotations(path, 1)[sample][:2, :2], p),
            )
            for axis in range(2)
            for sign in (1, -1)
        ]
        known = ConvexHull(HalfspaceIntersection(np.array(planes), p / 2).intersections)
        found = patch_overlap(library, path, sample, int(path.patch[sample, 0]))
        assert ConvexHull(found.hull).volume == pytest.approx(known.volume, rel=1e-10)
        margin = -float((known.equations[:, :2] @ p + known.equations[:, 2]).max())
        assert found.margin[0] == pytest.approx(margin, abs=1e-12)
