"""Faces that come down flat and are struck at the edge of what they cover, and what comes down over edges."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.benchmarks.planar_runs import scene_of
from tests.planar.scenes import MASS, events, table
from tests.planar.sinking import deepest
from tests.running import library_of

RADIUS, HEIGHT = 0.04, 0.2  # m; so tall that a blow at the rim turns it round
SPIN = MASS * 0.003  # kg m2, across its axis
FALL, TURN, AZIMUTH = 0.5, 12.0, 0.3  # m/s, rad/s about a horizontal axis, rad
CAN = make.cylinder(RADIUS, HEIGHT)


def landed(e: float, shape: Shape, until: float, turn: float = TURN, **keys: object) -> Trajectory:
    """A body that lies flat on a box at t = 0, and falls and turns, unless keys say otherwise."""
    box = make.fixed("table", make.box(0.5, 0.4, 0.1, position=[0, 0, -0.05]))
    start = {
        "position": [0, 0, HEIGHT / 2],
        "velocity": [0, 0, -FALL],
        "angular_velocity": [-turn * sin(AZIMUTH), turn * cos(AZIMUTH), 0],
    }
    body = make.dynamic("body", shape, mass=MASS, inertia=[SPIN, SPIN, SPIN], **{**start, **keys})
    scene = make.scene("landed", [box, body], contact=[{"between": ["body", "table"], "restitution": e}])
    library = library_of(scene)
    return simulate(library, until=until, accuracy=Accuracy.balanced(), samples=100, estimate=False)


def lowest(path: Trajectory) -> np.ndarray:
    """The height of the lowest point of the can's base."""
    upright = 1 - 2 * (path.quaternion[:, 1, 1] ** 2 + path.quaternion[:, 1, 2] ** 2)
    return path.p[:, 1, 2] - HEIGHT / 2 * upright - RADIUS * np.sqrt(np.maximum(1 - upright**2, 0))


@pytest.mark.cases(1)
@pytest.mark.parametrize("e", [0.0, 0.4])
def test_a_can_is_struck_at_one_point_of_its_rim_where_its_base_cannot_take_the_blow(e: float) -> None:
    """At the point that comes down fastest: P = (1 + e) u / (1/m + R^2/I). The centre of the impulses that
    would stop all of its base, I w/(m v), is beyond the rim."""
    assert SPIN * TURN / (MASS * FALL) > RADIUS
    path = landed(e, CAN, 0.02)
    speed = FALL + TURN * RADIUS
    impulse = (1 + e) * speed / (1 / MASS + RADIUS**2 / SPIN)
    turn = TURN - impulse * RADIUS / SPIN
    assert path.v[0, 1] == pytest.approx([0, 0, impulse / MASS - FALL], abs=1e-12)
    assert path.w[0, 1] == pytest.approx([-turn * sin(AZIMUTH), turn * cos(AZIMUTH), 0], abs=1e-11)
    told = events(path, "touch-down" if e == 0 else "impact")[0]
    assert (told.t, told.features) == (0.0, "bottom-top")
    assert told.speed == pytest.approx(speed, rel=1e-12)
    assert lowest(path).min() > -1e-11
    if e == 0:
        assert np.abs(lowest(path)).max() < 1e-11
    assert path.energy_drift < 1e-12


def test_a_can_whose_base_takes_the_blow_stops_flat() -> None:
    path = landed(0.0, CAN, 0.01, turn=0.9 * RADIUS * MASS * FALL / SPIN)
    assert np.abs(path.w).max() < 1e-12
    assert [event.kind for event in path.events][-1] == "face-contact"


@pytest.mark.slow
def test_every_point_of_a_face_that_is_struck_parts_at_least_as_newtons_law_says() -> None:
    """An ellipse, struck off its axes."""
    e, a, b = 0.4, RADIUS, 0.7 * RADIUS
    numbers = {"a": a, "b": b}
    ellipse = make.extrusion(HEIGHT, x="a*cos(t)", y="b*sin(t)", domain=["-pi", "pi"], parameters=numbers)
    path = landed(e, ellipse, 1e-9)
    angles = np.linspace(-pi, pi, 10001)
    x, y = a * np.cos(angles), b * np.sin(angles)
    before = -FALL + TURN * (-sin(AZIMUTH) * y - cos(AZIMUTH) * x)
    after = path.v[0, 1, 2] + path.w[0, 1, 0] * y - path.w[0, 1, 1] * x
    missed = after + e * np.minimum(before, 0)
    assert missed.min() > -1e-9
    assert missed.min() == pytest.approx(0, abs=1e-6)
    assert after.min() > 0


def test_a_can_that_stands_turns_over_its_rim_where_it_is_struck_high_up() -> None:
    """A ball strikes its side, above the reach of its base; nothing rubs, and nothing restores. The blows J
    on the side and P on the rim ahead leave no speed between ball and side, nor at the point of the rim."""
    rise, speed, ball = 0.08, 1.0, 0.1
    way = np.array([cos(AZIMUTH), sin(AZIMUTH), 0])
    body = make.dynamic("can", CAN, mass=MASS, inertia=[SPIN, SPIN, SPIN], position=[0, 0, HEIGHT / 2])
    thrown = make.dynamic(
        "ball", make.sphere(0.02), mass=ball, inertia=[1.6e-5] * 3, velocity=(speed * way).tolist(),
        position=(-(RADIUS + 0.02) * way + [0, 0, HEIGHT / 2 + rise]).tolist(),
    )  # fmt: skip
    scene = make.scene(
        "struck", [table(), body, thrown],
        contact=[{"between": ["can", "table"]}, {"between": ["can", "ball"]}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.01, samples=50, accuracy="balanced", estimate=False)
    both = -rise * RADIUS / SPIN
    inverse = [[1 / MASS + rise**2 / SPIN + 1 / ball, both], [both, 1 / MASS + RADIUS**2 / SPIN]]
    J, P = np.linalg.solve(inverse, [speed, 0.0])
    turn = (J * rise - P * RADIUS) / SPIN
    assert P > 0
    assert path.v[0, 1] == pytest.approx(J / MASS * way + [0, 0, P / MASS], abs=1e-11)
    assert path.w[0, 1] == pytest.approx([-turn * way[1], turn * way[0], 0], abs=1e-10)
    assert np.abs(lowest(path)).max() < 1e-11
    assert path.energy_drift < 1e-12


def test_a_lying_can_comes_down_on_its_other_rim() -> None:
    """It lands on one rim, turns about it, and then lies on both."""
    lean = 0.05
    height = HEIGHT / 2 * sin(lean) + RADIUS * cos(lean) + 0.01
    turned = {"axis": [0, 1, 0], "angle": lean - pi / 2}
    still = {"velocity": [0, 0, 0], "angular_velocity": [0, 0, 0]}
    path = landed(0.0, CAN, 0.12, position=[0, 0, height], axis_angle=turned, **still)
    slope = np.abs(1 - 2 * (path.quaternion[:, 1, 1] ** 2 + path.quaternion[:, 1, 2] ** 2))
    depth = HEIGHT / 2 * slope + RADIUS * np.sqrt(1 - slope**2) - path.p[:, 1, 2]
    assert depth.max() < 1e-9
    assert slope[-1] < 1e-6


LONGER = [pytest.param(seed, 1.5, marks=pytest.mark.slow) for seed in (6, 14, 64, 77, 129, 151)]


@pytest.mark.parametrize(("seed", "until"), [(49, 0.4), *LONGER])
def test_what_comes_down_over_an_edge_is_seen_before_it_sinks_in(seed: int, until: float) -> None:
    """Bodies that rock on the edge of another, of the random runs: where their edges are says so alone."""
    scene, _ = scene_of(seed)
    path = simulate(library_of(scene), until=until, samples=250, accuracy="balanced", estimate=False)
    assert deepest(scene, path).max() < 1e-9
    assert path.energy_drift < 1e-8
    assert not events(path, "fallback-start")
