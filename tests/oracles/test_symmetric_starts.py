"""Bodies that start where all points of a curve are nearest to them: their first strike in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.running import library_of

ACROSS = [float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0]  # a quarter turn about x
STARTS = {  # what stands, what moves along `way`, whence, how it is turned; and how far until it strikes (m)
    "ring on a post": (make.cylinder(0.5), make.torus(1.0, 0.3), "x", {}, 0.2),
    "link in a link": (
        make.torus(1.0, 0.3), make.torus(1.0, 0.65), "y", {"position": [1, 0, 0], "quaternion": ACROSS}, 0.05,
    ),
    "ring in a ring": (make.torus(2.0, 0.5, cavity=True), make.torus(2.0, 0.45), "x", {}, 0.05),
    "ball in a bore": (make.cylinder(1.0, cavity=True), make.sphere(0.9), "x", {}, 0.1),
    "ball in a ring": (
        make.torus(2.0, 0.5, cavity=True), make.sphere(0.4), "x", {"position": [2, 0, 0]}, 0.1,
    ),
    "spheroid in a bore": (make.cylinder(1.0, cavity=True), make.ellipsoid(0.9, 0.9, 1.5), "x", {}, 0.1),
    "spheroid in a spheroid": (
        make.ellipsoid(1.0, 1.0, 1.4, cavity=True), make.ellipsoid(0.9, 0.9, 1.1), "x", {}, 0.1,
    ),
}  # fmt: skip


def moved(stands: Shape, moves: Shape, way: str, pose: dict[str, object], gap: float) -> Trajectory:
    """A run for twice the time that the gap takes."""
    velocity = [0.1 * (axis == way) for axis in "xyz"]
    body = make.dynamic("body", moves, mass=1.0, inertia=[0.4, 0.4, 0.4], velocity=velocity, **pose)
    scene = make.scene(
        "symmetric", [make.fixed("world", stands), body], gravity=[0, 0, 0],
        contact=[{"between": ["body", "world"], "restitution": 0.5}],
    )  # fmt: skip
    return simulate(library_of(scene), until=20 * gap, samples=20)


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", STARTS)
def test_a_body_on_an_axis_of_symmetry_strikes_when_it_has_crossed_the_gap(name: str) -> None:
    stands, moves, way, pose, gap = STARTS[name]
    path = moved(stands, moves, way, pose, gap)
    assert path.outcome is Outcome.DONE
    assert not path.doubts
    struck = [event.t for event in path.events if event.kind == "impact"]
    assert struck[0] == pytest.approx(10 * gap, abs=1e-9)


HOLLOWS: dict[
    str, tuple[Shape, float]
] = {  # of half a metre about a point or a curve, and the radius of that (m)
    "ball": (make.sphere(0.5, cavity=True), 0.0),
    "bore": (make.cylinder(0.5, cavity=True), 0.0),
    "ring": (make.torus(2.0, 0.5, cavity=True), 2.0),
}


@pytest.mark.cases(12)
@pytest.mark.parametrize("part", [0.0, 1e-14, 1e-10, 1e-6, 1e-3, 0.1])
@pytest.mark.parametrize("clearance", [0.1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("hollow", HOLLOWS)
def test_a_ball_near_the_middle_of_a_hollow_strikes_where_it_has_crossed_the_clearance(
    hollow: str, clearance: float, part: float
) -> None:
    """It starts off the middle by a part of the clearance and moves straight on, across the curve there."""
    shape, radius = HOLLOWS[hollow]
    draw = np.random.default_rng(round(1 / clearance))
    azimuth, side, course = draw.uniform(0, 2 * np.pi, 3)
    outwards, across = np.array([np.cos(azimuth), np.sin(azimuth), 0]), np.array([0, 0, 1.0])
    if hollow == "bore":
        across = np.cross(across, outwards)
    offset = part * clearance * np.array([np.cos(side), np.sin(side)])
    way = np.array([np.cos(course), np.sin(course)])
    ball = make.dynamic(
        "body", make.sphere(0.5 - clearance), mass=1.0, inertia=[0.1, 0.1, 0.1],
        position=list((radius + offset[0]) * outwards + offset[1] * across),
        velocity=list(0.1 * (way[0] * outwards + way[1] * across)),
    )  # fmt: skip
    scene = make.scene(
        "hollow", [make.fixed("world", shape), ball], gravity=[0, 0, 0],
        contact=[{"between": ["body", "world"], "restitution": 0.5}],
    )  # fmt: skip
    along = float(offset @ way)
    strike = 10 * float(np.sqrt(along**2 + clearance**2 - offset @ offset) - along)
    path = simulate(library_of(scene), until=1.5 * strike, samples=20)
    assert path.outcome is Outcome.DONE
    assert not path.doubts
    struck = [event.t for event in path.events if event.kind == "impact"]
    assert struck[0] == pytest.approx(strike, abs=1e-9)


def test_a_ring_on_too_thick_a_post_is_refused() -> None:
    with pytest.raises(SimulationError):
        moved(make.cylinder(0.71), make.torus(1.0, 0.3), "x", {}, 0.1)


def apart(path: Trajectory, link: tuple[float, float], other: tuple[float, float]) -> float:
    """Least distance over the samples (m) of a torus at rest from one that moves; both by their radii (m)."""
    t = np.linspace(0, 2 * np.pi, 4001)
    circle = other[0] * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    least = np.inf
    for p, q in zip(path.p[:, 1], path.quaternion[:, 1], strict=True):
        x, y, z = (p + circle @ rotation_of(tuple(map(float, q))).T).T
        least = min(least, np.hypot(np.hypot(x, y) - link[0], z).min() - link[1] - other[1])
    return float(least)


@pytest.mark.cases(1)
@pytest.mark.parametrize("clearance", [1e-1, 3e-2, 1e-2])
def test_a_link_that_swings_from_the_middle_of_a_link_stays_outside_it(clearance: float) -> None:
    """Its closest point runs around the other link each time it passes the middle."""
    link, other = (1.0, 0.3), (1.0, 0.7 - clearance)
    body = make.dynamic(
        "body", make.torus(*other), mass=1.0, inertia=[0.4, 0.4, 0.4], position=[1, 0, 0], quaternion=ACROSS,
        angular_velocity=[0.1, 0.05, 1.0],
    )  # fmt: skip
    scene = make.scene(
        "links", [make.fixed("world", make.torus(*link)), body], gravity=[0, 0, 0],
        contact=[{"between": ["body", "world"], "restitution": 0.5}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.5, samples=100, estimate=False)
    assert path.outcome is Outcome.DONE
    assert any(event.kind == "impact" for event in path.events)
    assert apart(path, link, other) > -1e-8


def test_a_ring_of_half_a_millimetre_strikes_the_wall_of_a_duct_of_ten_metres() -> None:
    wall = make.torus(6.4, 3.2, cavity=True)
    path = moved(wall, make.torus(4e-4, 1.5e-4), "x", {"position": [9.6 - 5.5e-4 - 1e-3, 0, 0]}, 1e-3)
    assert path.outcome is Outcome.DONE
    struck = [event.t for event in path.events if event.kind == "impact"]
    assert struck[0] == pytest.approx(1e-2, abs=1e-9)
