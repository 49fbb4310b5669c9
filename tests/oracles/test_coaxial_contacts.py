"""Bodies that touch along a whole circle at once: coaxial, and almost so by decades."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.pieces import G, ball, ran
from tests.running import library_of

BALL, RING, TUBE, ANGLE = 0.05, 0.03, 0.004, 0.6  # m, m, m, rad
WITHIN = 1e-10  # m
OFFSETS = [0.0, 1e-12, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3]  # m
FALL = 0.02  # m


@dataclass(frozen=True)
class Seat:
    """A shape about z that carries a body, and the height at which it does, by geometry, m."""

    shape: Shape
    height: float
    turned: bool = False  # upside down

    def body(self, **keys: object) -> Body:
        return make.fixed("seat", self.shape, **({"rpy": [pi, 0.0, 0.0]} if self.turned else {}), **keys)


def in_ellipsoid(a: float, c: float) -> float:
    """The inward normal at the latitude v meets the axis at c sin(v) (1 - a^2/c^2); there it has the length
    sqrt(a^2 - a^2 sin^2(v) (1 - a^2/c^2)), which is the radius of the ball."""
    part = 1 - (a / c) ** 2
    return -c * part * sqrt((a * a - BALL * BALL) / (a * a * part))


SEATS = {
    "circle": Seat(make.circle(RING), sqrt(BALL**2 - RING**2)),
    "torus": Seat(make.torus(RING, TUBE), sqrt((BALL + TUBE) ** 2 - RING**2)),
    "tube": Seat(make.tube(0.036, RING, 0.08), 0.04 + sqrt(BALL**2 - RING**2)),
    "cone": Seat(make.shape("cone", half_angle=ANGLE, cavity=True), BALL / sin(ANGLE), turned=True),
    "paraboloid": Seat(make.paraboloid(RING, RING), (BALL**2 - RING**2) / (2 * RING) + RING),
    "ellipsoid": Seat(make.ellipsoid(0.06, 0.06, 0.2, cavity=True), in_ellipsoid(0.06, 0.2)),
    "revolution": Seat(
        make.revolution("0.01 + t", "t", domain=(0.0, 0.1), cavity=True), BALL * sqrt(2) - 0.01
    ),
}


def fallen(name: str, offset: float, until: float = 0.4, **terms: object) -> Trajectory:
    """A ball that falls onto a seat from an offset off its axis."""
    seat = SEATS[name]
    start = [offset * cos(1.0), offset * sin(1.0), seat.height + FALL]
    return ran([seat.body(), ball("ball", start, BALL)], until, [{"between": ["ball", "seat"], **terms}])


@pytest.mark.cases(9)
@pytest.mark.parametrize("name", SEATS)
@pytest.mark.parametrize("offset", OFFSETS)
def test_a_ball_comes_to_rest_all_around(name: str, offset: float) -> None:
    path = fallen(name, offset)
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < WITHIN
    assert path.unfollowed_minima == 0
    np.testing.assert_allclose(path.p[-1, 1], [0, 0, SEATS[name].height], atol=WITHIN)
    assert np.linalg.norm(path.v[-1, 1]) < 1e-9
    rest = path.force[-1]
    rise = (path.p[-1, 1] - path.points_o[-1])[:, 2] / BALL
    np.testing.assert_allclose(np.nansum(rest * np.abs(rise)), G, rtol=1e-9)


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", ["circle", "torus"])
@pytest.mark.parametrize("terms", [{}, {"restitution": 0.5}, {"friction": 0.3}], ids=["", "bounce", "rough"])
@pytest.mark.parametrize("seed", range(4))
def test_a_ball_never_enters_a_ring_that_leans(name: str, terms: dict[str, float], seed: int) -> None:
    """The ball falls along the axis of the ring, from an offset by decades; judged by its distance from the
    circle."""
    rng = np.random.default_rng(seed)
    azimuth, offset = rng.uniform(-pi, pi), 10.0 ** -(3 + 2 * seed)
    lean = Rotation.from_rotvec([0.1 * seed * cos(azimuth), 0.1 * seed * sin(azimuth), 0.0])
    start = lean.apply([offset * cos(2.0), offset * sin(2.0), 0.06])
    seat = make.fixed("seat", SEATS[name].shape, rpy=[float(a) for a in lean.as_euler("xyz")])
    path = ran([seat, ball("ball", start, BALL)], 0.3, [{"between": ["ball", "seat"], **terms}], samples=200)
    x = lean.inv().apply(path.p[:, 1].astype(float))
    apart = np.hypot(np.hypot(x[:, 0], x[:, 1]) - RING, x[:, 2]) - (TUBE if name == "torus" else 0.0)
    assert path.outcome is Outcome.DONE
    assert BALL - apart.min() < WITHIN
    assert path.incomplete_searches == 0


BOWL = make.sphere(0.1, cavity=True)
RESTING = {  # a seat, a body, and the height of its centre at rest, m
    "torus_in_bowl": (Seat(BOWL, -sqrt(0.09**2 - 0.04**2)), make.torus(0.04, 0.01)),
    "cylinder_in_bowl": (Seat(BOWL, 0.015 - sqrt(0.1**2 - 0.05**2)), make.cylinder(0.05, 0.03)),
    "capsule_on_circle": (Seat(make.circle(RING), 0.025 + sqrt(BALL**2 - RING**2)), make.capsule(BALL, 0.05)),
    "ellipsoid_on_circle": (Seat(make.circle(RING), 0.07 * 0.8), make.ellipsoid(BALL, BALL, 0.07)),
    "torus_on_torus": (Seat(make.torus(RING, TUBE), 2 * TUBE), make.torus(RING, TUBE)),
    "torus_in_cone": (
        Seat(SEATS["cone"].shape, (RING + TUBE / cos(ANGLE)) / np.tan(ANGLE), turned=True),
        make.torus(RING, TUBE),
    ),
    "cylinder_in_cone": (
        Seat(SEATS["cone"].shape, 0.03 + RING / np.tan(ANGLE), turned=True), make.cylinder(RING, 0.06),
    ),
}  # fmt: skip


@pytest.mark.cases(6)
@pytest.mark.parametrize("name", RESTING)
@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-9])
def test_a_coaxial_body_comes_to_rest_all_around(name: str, tilt: float) -> None:
    seat, shape = RESTING[name]
    body = make.dynamic(
        "body", shape, density=1000.0, position=[0.0, 0.0, seat.height + 1e-3], rpy=[0.0, tilt, 0.0]
    )
    path = ran([seat.body(), body], 0.1, [{"between": ["body", "seat"]}])
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < WITHIN
    np.testing.assert_allclose(path.p[-1, 1, 2], seat.height, atol=1e-9)


def bounced(t: float, fall: float, restitution: float) -> float:
    """Height above its seat of a body that falls from rest and bounces along the axis, m."""
    landing = sqrt(2 * fall / G)
    if t < landing:
        return fall - G * t * t / 2
    t, speed = t - landing, restitution * G * landing
    while t > 2 * speed / G and speed > WITHIN:
        t, speed = t - 2 * speed / G, restitution * speed
    return speed * t - G * t * t / 2 if speed > WITHIN else 0.0


BLOWS = {
    "": {},
    "bounce": {"restitution": 0.5},
    "elastic": {"restitution": 1.0},
    "rough": {"friction": 0.15},
    "rough_bounce": {"friction": 0.15, "restitution": 0.5},
    "rough_elastic": {"friction": 0.15, "restitution": 1.0},
}


@pytest.mark.cases(24)
@pytest.mark.parametrize("name", [*SEATS, *RESTING])
@pytest.mark.parametrize("terms", BLOWS.values(), ids=BLOWS)
@pytest.mark.parametrize("spin", [0.0, 10.0])
@pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
def test_a_circle_is_struck_as_one_contact(
    name: str, terms: dict[str, float], spin: float, accuracy: str
) -> None:
    """All supports of the circle are struck at the same time, whatever distance the body falls from: it stays
    on the axis, its height follows from its velocity alone, and nothing about the order is uncertain. Whether
    friction stops a spin in the last bounces or after them is not certain where these end early."""
    ends_early = accuracy == "fast" and spin > 0 and terms == BLOWS["rough_bounce"]
    if name in SEATS:
        seat = SEATS[name]
        body = ball("body", [0.0, 0.0, seat.height + FALL], BALL, angular_velocity=[0.0, 0.0, spin])
    else:
        seat, shape = RESTING[name]
        body = make.dynamic(
            "body",
            shape,
            density=1000.0,
            position=[0.0, 0.0, seat.height + FALL],
            angular_velocity=[0.0, 0.0, spin],
        )
    scene = make.scene("oracle", [seat.body(), body], contact=[{"between": ["body", "seat"], **terms}])
    path = simulate(library_of(scene), until=0.4, accuracy=Accuracy.named(accuracy), samples=50)
    assert path.estimate is not None
    assert path.is_trusted or ends_early, path.doubts
    assert "comes first" not in path.estimate.statement
    closed = [bounced(t, FALL, terms.get("restitution", 0.0)) for t in path.t]
    error = np.linalg.norm(path.p[:, 1] - [[0.0, 0.0, seat.height + height] for height in closed], axis=-1)
    assert (error <= path.estimate.position + WITHIN).all()
    np.testing.assert_allclose(path.w[:, 1, :2], 0.0, atol=1e-6)
    struck = Counter(event.t for event in path.events if event.kind in ("impact", "touch-down"))
    assert set(struck.values()) == {3}


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", ["circle", "torus", "tube"])
def test_a_spinning_ball_rests_all_around_with_friction_until_it_stops(name: str) -> None:
    """About the axis of the ring all of the circle resists: the torque is mu F r with F the sum of the normal
    forces, so that the spin falls linearly."""
    seat = SEATS[name]
    mu, spin, radius = 0.2, 30.0, RING if name != "torus" else RING * BALL / (BALL + TUBE)
    rise = sqrt(BALL**2 - radius**2) / BALL
    body = ball("ball", [0.0, 0.0, seat.height], BALL, angular_velocity=[0.0, 0.0, spin])
    path = ran([seat.body(), body], 0.05, [{"between": ["ball", "seat"], "friction": mu}])
    expected = spin - mu * G / rise * radius / (0.4 * BALL**2) * 0.05
    np.testing.assert_allclose(path.w[-1, 1, 2], expected, rtol=1e-6)
