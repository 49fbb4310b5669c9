"""Bodies on prescribed paths under and against free ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from tests.oracles.pieces import G, ball, imbalance, ran, solid, times

AMPLITUDE, RATE = 0.05, 20.0


def shaker(path: str = f"{AMPLITUDE}*sin({RATE}*t)"):
    return make.driven("shaker", make.plane(), path={"position": ["0.0", "0.0", path]})


def test_a_ball_leaves_a_shaker_whose_acceleration_exceeds_gravity() -> None:
    path = ran([shaker(), ball("b", [0, 0, 0.1])], 0.6, [{"between": ["b", "shaker"]}], samples=60)
    lift = np.arcsin(G / (AMPLITUDE * RATE**2)) / RATE
    assert times(path, "lift-off")[0] == pytest.approx(lift, abs=1e-11)
    height, speed = AMPLITUDE * np.sin(RATE * lift), AMPLITUDE * RATE * np.cos(RATE * lift)
    gap = lambda t: height + speed * (t - lift) - G / 2 * (t - lift) ** 2 - AMPLITUDE * np.sin(RATE * t)  # noqa: E731
    landing = brentq(gap, lift + 0.05, lift + 0.3, xtol=1e-15)
    assert times(path, "touch-down")[0] == 0.0  # the shaker takes the ball along
    assert times(path, "touch-down")[1] == pytest.approx(landing, abs=1e-10)
    assert imbalance(path) < 1e-10


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_work_counts_what_a_shaker_does_in_impacts(restitution: float) -> None:
    contact = [{"between": ["b", "shaker"], "restitution": restitution}]
    path = ran([shaker(), ball("b", [0.02, 0, 0.5])], 1.5, contact)
    assert len(path.events) > 1
    assert imbalance(path) < 1e-11
    assert path.energy_drift < 1e-11
    # closed form of the first bounce
    hit = brentq(lambda t: 0.4 - G / 2 * t * t - AMPLITUDE * np.sin(RATE * t), 0.2, 0.35, xtol=1e-15)
    floor = AMPLITUDE * RATE * np.cos(RATE * hit)
    first = path.events[0]
    assert first.t == pytest.approx(hit, abs=1e-11)
    assert first.speed == pytest.approx(G * hit + floor, rel=1e-10)


def test_a_driven_bowl_carries_a_ball_like_a_pendulum_on_a_moving_pivot() -> None:
    bowl = make.driven(
        "bowl", make.sphere(0.5, cavity=True), path={"position": ["0.1*sin(3*t)", "0.0", "0.05*cos(4*t)"]}
    )
    start = np.array([0.0, 0.0, 0.05]) + 0.4 * np.array([np.sin(0.3), 0, -np.cos(0.3)])
    path = ran([bowl, ball("b", start.tolist(), velocity=[0.3, 0, 0])], 2.0, [{"between": ["b", "bowl"]}])
    length = 0.4

    def swing(t: float, s: np.ndarray) -> list[float]:
        x2, z2 = -0.9 * np.sin(3 * t), -0.8 * np.cos(4 * t)
        return [s[1], -((G + z2) * np.sin(s[0]) + x2 * np.cos(s[0])) / length]

    other = solve_ivp(swing, (0, 2), [0.3, 0.0], method="DOP853", rtol=1e-13, atol=1e-14, t_eval=path.t)
    # the given velocity is that of the pivot: the pendulum starts at rest relative to it
    x = 0.1 * np.sin(3 * path.t) + length * np.sin(other.y[0])
    z = 0.05 * np.cos(4 * path.t) - length * np.cos(other.y[0])
    assert not path.events or path.events[0].speed < 1
    assert np.abs(path.p[:, 1, 0] - x).max() < 1e-10
    assert np.abs(path.p[:, 1, 2] - z).max() < 1e-10
    assert imbalance(path) < 1e-11


def test_a_turning_ellipsoid_pushes_a_ball_as_on_a_second_route() -> None:
    # plane motion: the ellipse's offset curve in its own frame, r = normal form with the normal's angle
    a, b, radius = 0.3, 0.2, 0.1
    spin = "2*t**2"
    paddle = make.driven("paddle", make.ellipsoid(a, b, 0.25), path={"rotation_vector": ["0.0", "0.0", spin]})

    def reach(u: float) -> tuple[np.ndarray, float]:
        """The ball's centre in the paddle's frame where the normal has the angle u, and its speed over u."""
        h = np.hypot(a * np.cos(u), b * np.sin(u))
        h1 = (b * b - a * a) * np.sin(u) * np.cos(u) / h
        h2 = ((b * b - a * a) * np.cos(2 * u) - h1 * h1) / h
        n, t = np.array([np.cos(u), np.sin(u)]), np.array([-np.sin(u), np.cos(u)])
        return (h + radius) * n + h1 * t, h + radius + h2

    def slope(t: float, s: np.ndarray) -> list[float]:
        u, rate = s
        angle1, angle2 = 4 * t, 4.0
        c, curvature = reach(u)
        e = 1e-4
        bend = (reach(u + e)[1] - reach(u - e)[1]) / (2 * e)
        tangent = np.array([-np.sin(u), np.cos(u)])
        # no friction, no gravity: the tangential component of the acceleration is zero (Coriolis's is normal)
        other = angle2 * np.array([-c[1], c[0]]) @ tangent - angle1**2 * c @ tangent
        return [rate, (-other - bend * rate**2) / curvature]

    u0 = np.deg2rad(60.0)
    pebble = ball("b", [*reach(u0)[0].tolist(), 0.0])
    path = ran([paddle, pebble], 0.5, [{"between": ["b", "paddle"]}], gravity=[0, 0, 0])
    end = times(path, "lift-off")[0] if times(path, "lift-off") else 0.5
    kept = path.t < end
    assert kept.sum() > 3
    other = solve_ivp(
        slope, (0, 0.5), [u0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, t_eval=path.t[kept]
    )
    angle = 2 * path.t[kept] ** 2
    local = np.array([reach(u)[0] for u in other.y[0]])
    world = Rotation.from_rotvec(angle[:, None] * [0, 0, 1]).apply(np.column_stack([local, 0 * angle]))
    assert np.abs(path.p[kept, 1] - world).max() < 1e-8
    assert imbalance(path) < 1e-11


def test_a_tumbling_path_is_the_exponential_of_its_rotation_vector() -> None:
    path = {"position": ["0.0", "0.1*t", "0.0"], "rotation_vector": ["sin(t)", "0.3*t**2", "0.7*t"]}
    hand = make.driven(
        "hand", make.ellipsoid(0.3, 0.2, 0.15), path=path, rpy=[0.3, 0.2, 0.1], position=[1, 0, 0]
    )
    stone = solid("stone", (0.05, 0.05, 0.06), position=[5, 5, 5])
    seen = ran([hand, stone], 3.0, [{"between": ["stone", "hand"]}], samples=30, gravity=[0, 0, 0])
    start = Rotation.from_euler("xyz", [0.3, 0.2, 0.1])

    def turn(t: float) -> Rotation:
        return Rotation.from_rotvec([np.sin(t), 0.3 * t * t, 0.7 * t]) * start

    e = 1e-4
    for k, t in enumerate(seen.t):
        have = Rotation.from_quat(np.roll(seen.quaternion[k, 0], -1))
        assert (have * turn(t).inv()).magnitude() < 1e-12
        spin = (turn(t + e) * turn(t - e).inv()).as_rotvec() / (2 * e)
        assert np.abs(seen.w[k, 0] - spin).max() < 1e-6


def test_a_driven_body_that_stays_put_is_a_fixed_one() -> None:
    keys = {"position": [0.1, 0.0, -0.2], "rpy": [0.1, -0.2, 0.4]}
    egg = solid("egg", (0.12, 0.09, 0.07), position=[0, 0, 0.05], angular_velocity=[1.0, 2.0, 3.0])
    contact = [{"between": ["egg", "rock"], "restitution": 0.4}]
    shape = make.ellipsoid(0.4, 0.3, 0.15)
    fixed = ran([make.fixed("rock", shape, **keys), egg], 0.6, contact, gravity=[0, 0.3, -9.81])
    rock = make.driven("rock", shape, path={"position": ["0.0", "0.0", "0.0"]}, **keys)
    driven = ran([rock, egg], 0.6, contact, gravity=[0, 0.3, -9.81])
    assert [e.kind for e in fixed.events] == [e.kind for e in driven.events] != []
    assert np.abs(fixed.p[:, 1] - driven.p[:, 1]).max() < 1e-9
    assert np.abs(fixed.force - driven.force).max() < 1e-6
