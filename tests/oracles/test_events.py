"""When contacts open and close, on every scale of length, time and mass."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, rotations, solid, times

AXES = (0.12, 0.09, 0.07)
THROWS = [  # start, velocity, centre of the post
    ([-0.4284, 0, 0], [0.584, 0, 3.9186], [-0.1137, 0, -0.3472]),
    ([-0.2208, 0, 0], [0.5709, 0, 3.8769], [0.418, 0, 0.0407]),
    ([-0.8299, 0, 0], [1.3104, 0, 3.869], [0.7218, 0, -1.2407]),
]


@pytest.mark.parametrize("depth", [1e-3, 1e-8, -1e-8])
def test_a_grazing_ball_touches_if_it_comes_low_enough(depth: float) -> None:
    grazing = ball("b", [0, 0, 1.1 - depth], velocity=[1.0, 0, -2.0])  # gap (t - 1)^2 - depth
    path = ran(
        [TABLE, grazing],
        50.0,
        [{"between": ["b", "table"], "restitution": 1.0}],
        force=[{"body": "b", "force": ["0.0", "0.0", "2.0"]}],
        gravity=[0, 0, 0],
    )
    expected = [1 - np.sqrt(depth)] if depth > 0 else []
    assert times(path, "impact") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("accuracy", [Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()])
@pytest.mark.parametrize("later", [1e-3, 5e-3, 2e-2])
def test_a_ball_grazes_a_post_a_moment_before_another_lands(accuracy: Accuracy, later: float) -> None:
    """The landing ends the step, and is no reason to look for nothing else in it."""
    fall = 0.2 + later
    bodies = [
        TABLE,
        make.fixed("post", make.sphere(0.05), position=[0, 0, 1]),
        ball("a", [3, 0, 0.05 + G * fall**2 / 2], radius=0.05),
        ball("b", [-1, 0.0999, 1], radius=0.05, velocity=[5, 0, 0]),
    ]
    contact = [{"between": ["a", "table"]}, {"between": ["b", "post"], "restitution": 0.5}]
    aloft = [{"body": "b", "force": [0.0, 0.0, G]}]
    path = ran(bodies, 0.3, contact, accuracy, force=aloft)
    assert times(path, "impact")[0] == pytest.approx((1 - np.sqrt(0.1**2 - 0.0999**2)) / 5, abs=1e-9)


@pytest.mark.cases(1)
@pytest.mark.parametrize(("start", "velocity", "post"), THROWS)
def test_a_thrown_ball_passes_a_post_that_it_first_rises_from(
    start: list[float], velocity: list[float], post: list[float]
) -> None:
    """The gap grows, shrinks and grows again within one step, and is closed for a moment."""
    fall = np.array([0, 0, -G / 2])

    def gap(t: float) -> float:
        return float(np.linalg.norm(start + np.array(velocity) * t + fall * t * t - post) - 0.2)

    sampled = np.linspace(0, 2, 200_001)
    first = next(t for t in sampled if gap(t) < 0)
    path = ran(
        [make.fixed("post", make.sphere(0.1), position=post), ball("b", start, velocity=velocity)],
        2.0,
        [{"between": ["b", "post"], "restitution": 0.5}],
        Accuracy.fast(),
    )
    assert times(path, "impact")[0] == pytest.approx(brentq(gap, first - 1e-5, first), abs=1e-7)


def test_a_thrown_ellipsoid_flies_freely_and_lands_where_it_must() -> None:
    turn, spin = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]), np.array([9.0, -4.0, 6.0])
    height = float(np.linalg.norm(np.array(AXES) * turn.as_matrix()[2]))
    egg = solid(
        "egg",
        AXES,
        position=[0, 0, height],
        rpy=[0.3, -0.2, 0.5],
        velocity=[0.3, 0, 4.0],
        angular_velocity=spin.tolist(),
    )
    path = ran([TABLE, egg], 1.2, [{"between": ["egg", "table"], "restitution": 0.3}], samples=60)
    moments = (
        np.array([AXES[1] ** 2 + AXES[2] ** 2, AXES[0] ** 2 + AXES[2] ** 2, AXES[0] ** 2 + AXES[1] ** 2]) / 5
    )
    momentum = turn.as_matrix() @ (moments * turn.inv().apply(spin))

    def slope(t: float, s: np.ndarray) -> np.ndarray:
        R = s.reshape(3, 3)
        w = R @ ((R.T @ momentum) / moments)
        return np.cross(w, R.T).T.ravel()

    flight = solve_ivp(
        slope, (0, 1.2), turn.as_matrix().ravel(), method="DOP853", rtol=1e-13, atol=1e-14, dense_output=True
    )

    def gap(t: float) -> float:
        return (
            height
            + 4 * t
            - G / 2 * t * t
            - float(np.linalg.norm(np.array(AXES) * flight.sol(t).reshape(3, 3)[2]))
        )

    landing = brentq(gap, 0.5, 1.0, xtol=1e-14)
    assert path.events[0].kind == "impact"
    assert path.events[0].t == pytest.approx(landing, abs=1e-10)
    flying = path.t < landing
    assert np.abs(rotations(path, 1)[flying].reshape(-1, 9) - flight.sol(path.t[flying]).T).max() < 1e-10
    assert np.abs(path.p[flying, 1, 2] - (height + 4 * path.t - G / 2 * path.t**2)[flying]).max() < 1e-12
    assert imbalance(path) < 1e-10


def test_a_disc_spinning_a_thousand_radians_a_second_stays_in_phase() -> None:
    disc = solid("disc", (0.1, 0.1, 0.05), position=[0, 0, 0.05], angular_velocity=[0, 0, 1e3])
    path = ran([TABLE, disc], 2.0, [{"between": ["disc", "table"]}])
    phase = Rotation.from_matrix(rotations(path, 1)) * Rotation.from_rotvec(np.outer(path.t, [0, 0, -1e3]))
    assert phase.magnitude().max() < 1e-8
    assert np.abs(path.force - G).max() < 1e-6
    assert not path.events


def test_a_body_tumbling_a_thousand_radians_a_second_keeps_its_angular_momentum() -> None:
    spin = np.array([600.0, 640.0, 480.0])
    path = ran([solid("egg", AXES, angular_velocity=spin.tolist())], 1.0)
    moments = (
        np.array([AXES[1] ** 2 + AXES[2] ** 2, AXES[0] ** 2 + AXES[2] ** 2, AXES[0] ** 2 + AXES[1] ** 2]) / 5
    )
    R = rotations(path, 0)
    momentum = np.einsum("nij,j,nkj,nk->ni", R, moments, R, path.w[:, 0])
    assert np.abs(momentum - moments * spin).max() < 1e-10 * np.linalg.norm(moments * spin)
    assert imbalance(path) < 1e-11 * path.energy[0]


def bounced(size: float, weight: float) -> Trajectory:
    """An ellipsoid bounces on another until it rests; lengths times `size`, masses times `weight`."""
    inertia = [weight * size**2 * value for value in (0.00312, 0.004632, 0.0054)]
    egg = make.dynamic(
        "egg",
        make.ellipsoid(*(size * a for a in AXES)),
        mass=weight * 1.2,
        inertia=inertia,
        position=[0.02 * size, 0.01 * size, 0.3 * size],
        rpy=[0.3, -0.2, 0.5],
        angular_velocity=[1.0, 3.0, -2.0],
    )
    rock = make.fixed("rock", make.ellipsoid(0.5 * size, 0.4 * size, 0.15 * size))
    contact = [{"between": ["egg", "rock"], "restitution": 0.5}]
    return ran([rock, egg], 0.6, contact, gravity=[0, 0, -9.81 * size])


@pytest.mark.parametrize(("size", "weight"), [(2.0**-20, 2.0**-40), (2.0**10, 2.0**30), (1.0, 2.0**-31)])
def test_units_that_are_powers_of_two_change_no_bit(size: float, weight: float) -> None:
    """Scaling by powers of two rounds nothing, so that any difference is a constant that has a unit."""
    small, plain = bounced(size, weight), bounced(1.0, 1.0)
    assert [(e.kind, e.t) for e in small.events] == [(e.kind, e.t) for e in plain.events] != []
    assert np.array_equal(small.p / size, plain.p)
    assert np.array_equal(small.energy / (size**2 * weight), plain.energy)


@pytest.mark.parametrize(("size", "weight"), [(1e-6, 1e-12), (1e3, 1e9), (1.0, 1e-9)])
def test_units_do_not_matter(size: float, weight: float) -> None:
    """But for rounding: a gap wrong by r roundings of the length L, at approach speed v, moves the time of an
    event by r eps L / v. The speed halves from bounce to bounce, so that the last times are worst."""
    small, plain = bounced(size, weight), bounced(1.0, 1.0)
    assert [e.kind for e in small.events] == [e.kind for e in plain.events] != []
    roundings, length = 256, 0.5  # 50 are seen
    bound = [roundings * np.finfo(float).eps * length / e.speed for e in plain.events]
    assert (np.abs(np.subtract([e.t for e in small.events], [e.t for e in plain.events])) < bound).all()
    assert np.abs(small.p / size - plain.p).max() < 1e-12
    assert np.abs(small.energy / (size**2 * weight) - plain.energy).max() < 1e-12


@pytest.mark.parametrize(
    "accuracy", [Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()], ids=lambda a: a.name
)
def test_ten_thousand_seconds_at_rest_do_not_creep(accuracy: Accuracy) -> None:
    egg = solid("egg", AXES, position=[0, 0, 0.07])
    bowl = make.fixed("bowl", make.sphere(1.0, cavity=True), position=[0, 5.0, 1.0])
    contact = [{"between": ["egg", "table"]}, {"between": ["b", "bowl"]}]
    path = ran([TABLE, bowl, egg, ball("b", [0, 5.0, 0.1])], 1e4, contact, accuracy)
    assert path.outcome.succeeded
    assert not path.events
    assert np.abs(path.p - path.p[0]).max() < 1e-11
    assert np.abs(rotations(path, 2) - np.eye(3)).max() < 1e-10
    assert np.abs(path.force - G).max() < 1e-8


@pytest.mark.parametrize(
    "accuracy", [Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()], ids=lambda a: a.name
)
def test_bounces_that_die_out_end_on_the_table(accuracy: Accuracy) -> None:
    path = ran(
        [TABLE, ball("b", [0, 0, 1.1])],
        6.0,
        [{"between": ["b", "table"], "restitution": 0.5}],
        accuracy,
    )
    fall = np.sqrt(2 / G)
    assert times(path, "touch-down") == pytest.approx([3 * fall], abs=1e-5)
    assert path.p[-1, 1, 2] == pytest.approx(0.1, abs=1e-12)
    assert imbalance(path) < 1e-5 * G
