"""Impacts: Newton's restitution, momentum, and several at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, rotations, solid, times

NO_GRAVITY = [0.0, 0.0, 0.0]


@pytest.mark.parametrize("restitution", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("ratio", [1.0, 3.0, 1e6])
def test_two_balls_collide_head_on(restitution: float, ratio: float) -> None:
    bodies = [
        ball("a", [0, 0, 0], velocity=[1, 0, 0]),
        ball("b", [5, 0, 0], mass=ratio, velocity=[-0.5, 0, 0]),
    ]
    contact = [{"between": ["a", "b"], "restitution": restitution}]
    path = ran(bodies, 8.0, contact, gravity=NO_GRAVITY)
    mean = (1 - 0.5 * ratio) / (1 + ratio)
    after = mean - restitution * 1.5 * np.array([ratio, -1]) / (1 + ratio)
    assert np.abs(path.v[-1, :, 0] - after).max() < 1e-12
    assert path.events[0].t == pytest.approx(3.2, abs=1e-12)
    momentum = path.v[:, 0] + ratio * path.v[:, 1]
    assert np.ptp(momentum, axis=0).max() < 1e-13 * (1 + ratio)
    assert imbalance(path) < 1e-12 * (1 + ratio)


@pytest.mark.parametrize("offset", [0.0, 0.05, 0.15, 0.199, 0.1999999])
def test_fast_balls_do_not_pass_through_each_other(offset: float) -> None:
    bodies = [ball("a", [0, 0, 0], velocity=[10, 0, 0]), ball("b", [5, offset, 0])]
    path = ran(bodies, 100.0, [{"between": ["a", "b"], "restitution": 1.0}], gravity=NO_GRAVITY)
    assert times(path, "impact") == pytest.approx([(5 - np.sqrt(0.04 - offset**2)) / 10], abs=1e-10)
    sine = offset / 0.2
    away = 10 * (1 - sine**2)
    assert np.abs(path.v[-1, 1, :2] - [away, away * sine / np.sqrt(1 - sine**2)]).max() < 1e-8


def test_balls_that_just_miss_do_not_touch() -> None:
    bodies = [ball("a", [0, 0, 0], velocity=[10, 0, 0]), ball("b", [5, 0.2000001, 0])]
    path = ran(bodies, 100.0, [{"between": ["a", "b"], "restitution": 1.0}], gravity=NO_GRAVITY)
    assert not path.events


def test_a_ball_thrown_up_from_beside_a_ball_comes_down_on_it() -> None:
    path = ran(
        [make.fixed("post", make.sphere(0.1)), ball("b", [0.12, 0, 0.3], velocity=[0, 0, 5.0])],
        2.0,
        [{"between": ["b", "post"], "restitution": 0.5}],
    )
    height = np.sqrt(0.04 - 0.12**2)
    exact = (5 + np.sqrt(25 + 2 * G * (0.3 - height))) / G
    assert times(path, "impact")[0] == pytest.approx(exact, abs=1e-10)


def test_a_row_of_touching_balls_shares_a_blow() -> None:
    # all contacts are struck at once: 0 <= P, 0 <= d_dot_after + e d_dot_before, complementary; three equal
    # balls part with (-1/3, 2/3, 2/3) of the speed; energy and momentum are kept
    bodies = [ball(name, [0.2 * i, 0, 0]) for i, name in enumerate("abc")]
    bodies[0] = ball("a", [-1.0, 0, 0], velocity=[1.0, 0, 0])
    contact = [{"between": pair, "restitution": 1.0} for pair in (["a", "b"], ["b", "c"])]
    path = ran(bodies, 3.0, contact, gravity=NO_GRAVITY)
    assert np.abs(path.v[-1, :, 0] - [-1 / 3, 2 / 3, 2 / 3]).max() < 1e-12
    assert imbalance(path) < 1e-14


def test_a_row_with_gaps_hands_the_blow_on() -> None:
    bodies = [
        ball("a", [-1.0, 0, 0], velocity=[1.0, 0, 0]),
        *(ball(n, [0.2001 * i, 0, 0]) for i, n in ((1, "b"), (2, "c"))),
    ]
    contact = [{"between": pair, "restitution": 1.0} for pair in (["a", "b"], ["b", "c"])]
    path = ran(bodies, 3.0, contact, gravity=NO_GRAVITY)
    assert np.abs(path.v[-1, :, 0] - [0, 0, 1]).max() < 1e-12


@pytest.mark.parametrize("restitution", [0.0, 0.4, 1.0])
def test_a_ball_strikes_a_free_ellipsoid_off_its_centre(restitution: float) -> None:
    axes, turn = np.array([0.3, 0.2, 0.15]), Rotation.from_rotvec([0.3, -0.5, 0.8])
    inertia = (
        2.0
        / 5
        * np.array([axes[1] ** 2 + axes[2] ** 2, axes[0] ** 2 + axes[2] ** 2, axes[0] ** 2 + axes[1] ** 2])
    )
    n = np.array([0.5, 0.3, 0.8]) / np.linalg.norm([0.5, 0.3, 0.8])  # exterior normal at the blow, body axes
    at = axes**2 * n / np.linalg.norm(axes * n)
    normal, arm = turn.apply(n), turn.apply(at)
    spin = np.array([0.4, -0.2, 0.3])
    velocity = -2.0 * normal + [0.3, 0.1, -0.2]
    stone = solid(
        "stone",
        axes.tolist(),
        2.0,
        quaternion=turn.as_quat()[[3, 0, 1, 2]].tolist(),
        angular_velocity=spin.tolist(),
    )
    start = arm + normal * (0.05 + 1e-12)
    pellet = ball("pellet", start.tolist(), radius=0.05, mass=0.3, velocity=velocity.tolist())
    contact = [{"between": ["pellet", "stone"], "restitution": restitution}]
    path = ran([stone, pellet], 1e-6, contact, gravity=NO_GRAVITY)
    # impulse P = -(1 + e) d_dot / (1/m + 1/M + lever^T I^-1 lever)
    lever = np.cross(at, n)
    rate = normal @ (velocity - np.cross(spin, arm))
    P = -(1 + restitution) * rate / (1 / 0.3 + 1 / 2.0 + lever @ (lever / inertia))
    assert np.abs(path.v[-1, 1] - velocity - P / 0.3 * normal).max() < 1e-6
    assert np.abs(path.v[-1, 0] + P / 2.0 * normal).max() < 1e-6
    assert np.abs(path.w[-1, 0] - spin + turn.apply(P * lever / inertia)).max() < 1e-5


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_collisions_in_free_space_keep_momentum_and_angular_momentum(restitution: float) -> None:
    stone = solid("stone", (0.3, 0.2, 0.15), 2.0, velocity=[0.5, 0, 0], angular_velocity=[1.0, 2.0, 0.5])
    other = solid(
        "other", (0.1, 0.2, 0.25), 1.5, position=[1.0, 0.1, 0.05], angular_velocity=[0.5, -3.0, 1.0]
    )
    bodies = [stone, other, ball("pellet", [-0.6, 0.1, 0.0], velocity=[3.0, 0, 0])]
    contact = [
        {"between": pair, "restitution": restitution}
        for pair in (["stone", "other"], ["pellet", "stone"], ["other", "pellet"])
    ]
    path = ran(bodies, 3.0, contact, gravity=NO_GRAVITY, samples=60)
    masses = np.array([2.0, 1.5, 1.0])
    momentum = np.einsum("b,nbi->ni", masses, path.v)
    spin = np.einsum("b,nbi->ni", masses, np.cross(path.p, path.v))
    for body, axes in ((0, (0.3, 0.2, 0.15)), (1, (0.1, 0.2, 0.25))):
        a, b, c = np.square(axes)
        moments = masses[body] / 5 * np.array([b + c, a + c, a + b])
        R = rotations(path, body)
        spin += np.einsum("nij,j,nkj,nk->ni", R, moments, R, path.w[:, body])
    assert len(path.events) >= 2
    assert np.ptp(momentum, axis=0).max() < 1e-12
    assert np.ptp(spin, axis=0).max() < 1e-10
    assert imbalance(path) < 1e-11
    if restitution == 1:
        assert np.ptp(path.energy) < 1e-11 * path.energy[0]


def test_an_ellipsoid_dropped_without_bounce_slides_on() -> None:
    egg = solid(
        "egg", (0.12, 0.09, 0.07), position=[0, 0, 0.3], rpy=[0.3, 0.2, 0.1], angular_velocity=[2.0, 1.0, 0.0]
    )
    path = ran([TABLE, egg], 3.0, [{"between": ["egg", "table"]}], samples=100)
    landed = path.t > times(path, "touch-down")[-1]
    still = landed & (path.t > (times(path, "lift-off") or [0.0])[-1])
    assert still.any()
    assert np.abs(path.gap[still]).max() < 1e-12
    assert imbalance(path) < 1e-10
    assert path.work[-1] < -0.5


@pytest.mark.parametrize("ratio", [1e-6, 1e6])
def test_a_ball_rests_on_another_of_any_weight(ratio: float) -> None:
    lower, upper = ball("lower", [0, 0, 0.1]), ball("upper", [0, 0, 0.3], mass=ratio)
    contact = [{"between": ["lower", "table"]}, {"between": ["lower", "upper"]}]
    path = ran([TABLE, lower, upper], 2.0, contact)
    assert np.abs(path.force - G * np.array([1 + ratio, ratio])).max() < 1e-9 * G * (1 + ratio)
    assert np.ptp(path.p, axis=0).max() < 1e-9
