"""No contact is missed: small clearances, hollows, profiles that are not convex; judged by dense points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.benchmarks.cliff_scenes import links_and_dust
from tests.benchmarks.non_convex_scenes import judge
from tests.oracles.pieces import TABLE, ball, ran
from tests.running import library_of

Array = np.ndarray[Any, Any]

RADIUS, HALF, TUBE = 0.02, 0.03, 0.1  # m: of the peg, half its length, half the length of the tube
STRIKE = 0.0175  # s
CAVE, STONE = np.array([7.45, 9.75, 8.69]), np.array([0.81, 2.01, 1.36])  # m, semi-axes
TURN = np.linspace(0, 2 * np.pi, 721)


def peg_in_tube(
    clearance: float, until: float, accuracy: Accuracy, restitution: float = 0.0, **keys: object
) -> Trajectory:
    tube = make.fixed("tube", make.tube(RADIUS + clearance + 0.01, RADIUS + clearance, 2 * TUBE))
    peg = make.dynamic("peg", make.cylinder(RADIUS, 2 * HALF), density=1000.0, **keys)
    contact = [{"between": ["peg", "tube"], "restitution": restitution}]
    return ran([tube, peg], until, contact, accuracy, samples=100)


def rim_depth(path: Trajectory, bore: float) -> float:
    """Deepest penetration of points of both rims into the bore, m."""
    deepest = -np.inf
    circle = RADIUS * np.stack([np.cos(TURN), np.sin(TURN), 0 * TURN], axis=1)
    for p, quaternion in zip(path.p[:, 1], path.quaternion[:, 1], strict=True):
        for end in (-HALF, HALF):
            x = p + (circle + np.array([0, 0, end])) @ rotation_of(tuple(map(float, quaternion))).T
            inside = np.abs(x[:, 2]) < TUBE
            deepest = max(deepest, np.max(np.hypot(x[:, 0], x[:, 1])[inside] - bore, initial=-np.inf))
    return float(deepest)


@pytest.mark.cases(1)
@pytest.mark.parametrize("clearance", [5e-3, 5e-4, 5e-5, 5e-6])
def test_an_upright_peg_strikes_the_bore_when_it_has_crossed_the_clearance(clearance: float) -> None:
    path = peg_in_tube(clearance, 0.03, Accuracy.tight(), velocity=[clearance / STRIKE, 0, 0])
    struck = [event.t for event in path.events if event.kind == "touch-down"]
    assert struck[0] == pytest.approx(STRIKE, abs=1e-9)
    assert rim_depth(path, RADIUS + clearance) < 1e-9


@pytest.mark.cases(2)
@pytest.mark.parametrize("clearance", [5e-3, 5e-4, 5e-5, 5e-6])
@pytest.mark.parametrize("seed", range(5))
def test_a_leaning_peg_stays_in_its_bore(clearance: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    lean, azimuth = rng.uniform(0.1, 0.4) * clearance / HALF, rng.uniform(0, 2 * np.pi)
    path = peg_in_tube(
        clearance, 0.05, Accuracy.balanced(),
        axis_angle={"axis": [float(np.cos(azimuth)), float(np.sin(azimuth)), 0.0], "angle": float(lean)},
        velocity=[*map(float, rng.normal(size=2) * clearance / STRIKE), 0],
    )  # fmt: skip
    assert path.outcome is Outcome.DONE
    assert rim_depth(path, RADIUS + clearance) < 1e-9


@pytest.mark.cases(1)
@pytest.mark.parametrize("clearance", [5e-3, 5e-4, 5e-5, 5e-6])
@pytest.mark.parametrize("seed", range(5))
def test_a_peg_that_tumbles_for_two_seconds_stays_in_its_bore(clearance: float, seed: int) -> None:
    """It leans, turns about all axes and bounces; it slides out of no end in this time."""
    rng = np.random.default_rng(100 + seed)
    lean, azimuth = rng.uniform(0.1, 0.4) * clearance / HALF, rng.uniform(0, 2 * np.pi)
    rate = clearance / STRIKE
    path = peg_in_tube(
        clearance, 2.0, Accuracy.balanced(), 0.8,
        axis_angle={"axis": [float(np.cos(azimuth)), float(np.sin(azimuth)), 0.0], "angle": float(lean)},
        velocity=[*map(float, rng.normal(size=2) * rate), 0.01],
        angular_velocity=[*map(float, rng.normal(size=2) * rate / HALF), float(rng.normal())],
    )  # fmt: skip
    assert path.outcome is Outcome.DONE
    assert rim_depth(path, RADIUS + clearance) < 1e-9


TURNED = Rotation.from_rotvec([0.7, -1.1, 0.4])  # of the whole world


@dataclass(frozen=True)
class Launch:
    """Where a stone starts in a hollow, and how the hollow stands."""

    p: Array  # m
    v: Array  # m/s
    w: Array  # rad/s, axes of the world
    attitude: Rotation
    hollow: Rotation

    def image(self, which: str) -> Launch:
        """Itself, mirrored in x, or turned as the whole world."""
        if which == "mirrored":
            attitude = Rotation.from_quat(self.attitude.as_quat() * [1, -1, -1, 1])
            return Launch(self.p * FLIP, self.v * FLIP, self.w * -FLIP, attitude, self.hollow)
        if which == "turned":
            p, v, w = TURNED.apply([self.p, self.v, self.w])
            return Launch(p, v, w, TURNED * self.attitude, TURNED * self.hollow)
        return self

    def stone(self, axes: Array) -> Body:
        """The body of an ellipsoid with these semi-axes, m."""
        return make.dynamic(
            "stone", make.ellipsoid(*map(float, axes)), density=10.0, position=[*map(float, self.p)],
            quaternion=_wxyz(self.attitude), velocity=[*map(float, self.v)],
            angular_velocity=[*map(float, self.w)],
        )  # fmt: skip


FLIP = np.array([-1.0, 1.0, 1.0])


def back(path: Trajectory, which: str) -> Array:
    """(n, 3) m: positions of the stone, the image undone."""
    p = path.p[:, 1]
    return TURNED.inv().apply(p) if which == "turned" else p * FLIP if which == "mirrored" else p


def flight(seed: int, image: str = "") -> Trajectory:
    """A stone that flies in a cave from a random start; or that flight mirrored in x, or turned."""
    rng = np.random.default_rng(seed)
    p, v, w = rng.uniform(-3, 3, 3), 8 * rng.normal(size=3), 4 * rng.normal(size=3)
    attitude = Rotation.from_quat(np.roll(rng.normal(size=4), -1))
    start = Launch(p, v, w, attitude, Rotation.identity()).image(image)
    cave = make.fixed("cave", make.ellipsoid(*map(float, CAVE), cavity=True), quaternion=_wxyz(start.hollow))
    contact = [{"between": ["stone", "cave"], "restitution": 0.8}]
    return ran([cave, start.stone(STONE)], 3.0, contact, Accuracy.balanced(), samples=100, gravity=[0, 0, 0])


def _wxyz(attitude: Rotation) -> list[float]:
    return [*map(float, np.roll(attitude.as_quat(), 1))]


def beyond_cave(path: Trajectory) -> float:
    """How far points of the stone are outside the cave at most, over its semi-axes."""
    rng = np.random.default_rng(0)
    sphere = rng.normal(size=(2000, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    poses = zip(path.p[:, 1], path.quaternion[:, 1], strict=True)
    return max(
        float(
            np.linalg.norm((p + (sphere * STONE) @ rotation_of(tuple(map(float, q))).T) / CAVE, axis=1).max()
        )
        - 1
        for p, q in poses
    )


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(100))
def test_a_stone_never_leaves_its_cave_and_flies_as_its_images(seed: int) -> None:
    path, mirrored, turned = flight(seed), flight(seed, "mirrored"), flight(seed, "turned")
    for each in (path, mirrored, turned):
        assert each.outcome is Outcome.DONE
    for each in (path, mirrored):
        assert beyond_cave(each) < 1e-9
    np.testing.assert_allclose(back(mirrored, "mirrored")[-1], path.p[-1, 1], atol=1e-7)
    np.testing.assert_allclose(back(turned, "turned")[-1], path.p[-1, 1], atol=1e-7)


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(500))
def test_a_body_of_revolution_that_is_not_convex_stays_on_the_floor(seed: int) -> None:
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    shape = make.revolution("4.489*sin(t)*(1.2 + 0.5*cos(2*t))", "-5.49*cos(t)", domain=[0.0, float(np.pi)])
    body = make.dynamic(
        "body", shape, density=100.0, position=[0, 0, 9.0], quaternion=[*map(float, quaternion)],
        angular_velocity=[*map(float, rng.normal(size=3))],
    )  # fmt: skip
    contact = [{"between": ["body", "table"], "restitution": 0.3, "friction": 0.3}]
    path = ran([TABLE, body], 3.0, contact, Accuracy.balanced(), samples=100)
    assert path.outcome is Outcome.DONE
    t = np.linspace(0, np.pi, 2001)
    r, z = 4.489 * np.sin(t) * (1.2 + 0.5 * np.cos(2 * t)), -5.49 * np.cos(t)
    _, x, y, _ = path.quaternion[:, 1].T
    axis = 1 - 2 * (x * x + y * y)  # z of the body's axis
    across = np.sqrt(np.maximum(1 - axis * axis, 0))
    lowest = path.p[:, 1, 2] + (axis[:, None] * z - across[:, None] * r).min(axis=1)
    assert lowest.min() > -1e-6


def _waist(z: Array) -> Array:
    """Radius of a body of revolution at -3 z, z = cos t."""
    return 3 * np.sqrt(1 - z * z) * (1.2 + 0.5 * (2 * z * z - 1))


ROOM = np.array([1.0, 1.3, 0.9])  # m, half the edges
CORNERS = [[x * ROOM[0], y * ROOM[1], z * ROOM[2]] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
HOLLOWS = {  # shape, a function that is positive outside it, where the stone starts
    "torus": (
        make.torus(3.0, 1.0, cavity=True),
        lambda x: np.hypot(np.hypot(x[:, 0], x[:, 1]) - 3.0, x[:, 2]) - 1.0,
        [3.0, 0.0, 0.0],
    ),
    "bore": (make.cylinder(1.0, cavity=True), lambda x: np.hypot(x[:, 0], x[:, 1]) - 1.0, [0.0, 0.0, 0.0]),
    "room": (
        make.polyhedron(CORNERS, cavity=True),
        lambda x: (np.abs(x) - ROOM).max(axis=1),
        [0.0, 0.0, 0.0],
    ),
    "revolution": (
        make.revolution("3*sin(t)*(1.2 + 0.5*cos(2*t))", "-3*cos(t)", domain=[0.0, np.pi], cavity=True),
        lambda x: np.hypot(x[:, 0], x[:, 1]) - _waist(np.clip(x[:, 2] / 3, -1, 1)),
        [0.0, 0.0, 0.0],
    ),
    "superellipsoid": (
        make.superellipsoid(1.2, 1.0, 1.5, 2.5, 3.0, cavity=True),
        lambda x: (
            (np.abs(x[:, 0] / 1.2) ** 2.5 + np.abs(x[:, 1]) ** 2.5) ** 1.2 + np.abs(x[:, 2] / 1.5) ** 3 - 1
        ),
        [0.0, 0.0, 0.0],
    ),
}


PEBBLE = np.array([0.3, 0.2, 0.4])  # m, semi-axes


def hollow_flight(name: str, seed: int, image: str) -> Trajectory:
    """A pebble that flies in a hollow from a random start, or an image of that, each with an estimate."""
    shape, _, middle = HOLLOWS[name]
    rng = np.random.default_rng(seed)
    attitude = Rotation.from_quat(np.roll(rng.normal(size=4), -1))
    p, v, w = middle + rng.uniform(-0.2, 0.2, 3), 2 * rng.normal(size=3), 3 * rng.normal(size=3)
    start = Launch(p, v, w, attitude, Rotation.identity()).image(image)
    scene = make.scene(
        "hollow", [make.fixed("hollow", shape, quaternion=_wxyz(start.hollow)), start.stone(PEBBLE)],
        contact=[{"between": ["stone", "hollow"], "restitution": 0.8}], gravity=[0, 0, 0],
    )  # fmt: skip
    return simulate(library_of(scene), until=2.0, samples=60)


@pytest.mark.cases(3)
@pytest.mark.parametrize("name", HOLLOWS)
@pytest.mark.parametrize("seed", range(100))
def test_a_stone_never_leaves_a_hollow_and_flies_as_its_images(name: str, seed: int) -> None:
    """An image differs by no more than the errors of both flights, each as its own flight states it."""
    _, outside, _ = HOLLOWS[name]
    paths = {image: hollow_flight(name, seed, image) for image in ("", "mirrored", "turned")}
    sphere = np.random.default_rng(0).normal(size=(1500, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    for image, path in paths.items():
        assert path.outcome is Outcome.DONE
        for p, q in zip(path.p[:, 1], path.quaternion[:, 1], strict=True):
            R = rotation_of(tuple(map(float, q)))
            assert image == "turned" or outside(p + (sphere * PEBBLE) @ R.T).max() < 1e-9
        estimates = path.estimate, paths[""].estimate
        assert estimates[0] is not None
        assert estimates[1] is not None
        apart = np.linalg.norm(back(path, image) - paths[""].p[:, 1], axis=1)
        known = min(each.predicted for each in estimates if each)
        stated = sum(each.position for each in estimates if each)
        assert (apart <= stated)[:known].all(), image


@pytest.mark.parametrize("decade", range(1, 5))
def test_searches_of_large_bodies_do_not_depend_on_a_small_one(decade: int) -> None:
    """A ball far away, by decades of its radius, sets the characteristic length, but no search of others."""
    alone, beside = (
        simulate(library_of(links_and_dust(radius)), until=1.0, samples=20, estimate=False)
        for radius in (0.0, 0.6 * 10.0**-decade)
    )
    assert beside.outcome is Outcome.DONE
    assert np.abs(beside.p[:, 2] - alone.p[:, 2]).max() < 1e-7
    assert beside.steps < 2 * alone.steps  # one for each 0.05 radii of the ball: 1.7 to 1700 times as many


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(1000))
def test_what_is_trusted_does_not_penetrate(seed: int) -> None:
    """Random solids in flight, in heaps of two, in hollows, tubes and on posts, by decades of clearance."""
    verdict = judge(seed)
    assert not verdict.fails, str(verdict)


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(2, 150, 5))
def test_a_body_that_fits_into_a_hollow_is_followed_all_around(seed: int) -> None:
    """Of what a run cannot know only the friction of contacts that wedge the body is left."""
    verdict = judge(seed)
    assert verdict.outcome == "DONE", str(verdict)
    assert all("friction were not unique" in doubt for doubt in verdict.doubts), str(verdict)
    assert verdict.deepest < 3e-6


def test_a_contact_that_leaves_its_edge_is_not_taken_to_the_far_side() -> None:
    """A star flies at a ring: inside the ring, the plane of its face has its only minimum across the hole."""
    verdict = judge(636)
    assert verdict.outcome == "DONE", str(verdict)
    assert verdict.deepest < 1e-9


@pytest.mark.cases(4)
@pytest.mark.parametrize("semi_axes", [[0.03, 0.04], [0.04, 0.03], [0.03, 0.0301]])
@pytest.mark.parametrize("fall", [0.01, 0.02, 0.05])
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
def test_all_that_touches_at_an_impact_takes_part_in_it(
    semi_axes: list[float], fall: float, restitution: float, accuracy: str
) -> None:
    """A ball falls from rest along the axis of an elliptical ring, whose two nearest points are farther away
    than a search follows: both are struck at once, and the ball stays on the axis."""
    height = float(np.sqrt(0.05**2 - min(semi_axes) ** 2))
    ring = make.fixed("ring", make.shape("ellipse_curve", semi_axes=semi_axes))
    body = ball("ball", [0.0, 0.0, height + fall], 0.05)
    contact = [{"between": ["ball", "ring"], "restitution": restitution}]
    library = library_of(make.scene("oracle", [ring, body], contact=contact))
    path = simulate(library, until=0.2, accuracy=Accuracy.named(accuracy), samples=20)
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-10
    assert path.estimate is not None
    aside = np.hypot(path.p[:, 1, 0], path.p[:, 1, 1])
    assert (aside <= np.minimum(path.estimate.position, 1e-6)).all()
