"""Rolling and spinning resistance, and friction that is not alike in all directions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.friction.disc import Disc
from tests.oracles.friction.extrapolation import Real, reals
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, times
from tests.running import library_of

I = 0.004  # noqa: E741 of a ball of 1 kg, 0.1 m


def rolled(until: float, gravity: tuple[float, float, float] = (0, 0, -G), **keys: object) -> Trajectory:
    resistances = {"rolling_resistance": 2e-3, "spinning_resistance": 1e-3}
    contact = [{"between": ["ball", "table"], "friction": 0.5, **resistances}]
    return ran([ball("ball", [0, 0, 0.1], **keys), TABLE], until, contact, gravity=list(gravity))


def test_a_spinning_ball_comes_to_rest_when_its_torque_has_used_its_spin_up() -> None:
    path = rolled(3.0, angular_velocity=[0.0, 0.0, 5.0])
    assert times(path, "spin-stop") == [pytest.approx(5.0 * I / (1e-3 * G), abs=1e-12)]
    assert path.contact_torque[0, 0] == pytest.approx([0, 0, -1e-3 * G], rel=1e-12)
    assert np.abs(path.w[-1]).max() < 1e-14
    assert path.work[-1] == pytest.approx(-I * 5.0**2 / 2, rel=1e-12)


def test_a_rolling_ball_rolls_out_straight() -> None:
    path = rolled(9.0, velocity=[1.0, 0.5, 0.0], angular_velocity=[-5.0, 10.0, 0.0])
    speed, brake = np.hypot(1.0, 0.5), 2e-3 * G / (0.1 * 1.4)
    assert times(path, "roll-stop") == [pytest.approx(speed / brake, abs=1e-11)]
    assert path.p[-1, 0, :2] == pytest.approx(speed / (2 * brake) * np.array([1.0, 0.5]), abs=1e-11)
    assert imbalance(path) < 1e-13


def test_resistance_holds_a_ball_on_a_slope_up_to_an_angle() -> None:
    limit = np.arctan(2e-3 / 0.1)
    held, rolling = (
        rolled(1.0, (G * np.sin(a), 0, -G * np.cos(a))) for a in (limit * (1 - 1e-6), limit + 0.01)
    )
    assert np.abs(held.p - held.p[0]).max() < 1e-14
    a = limit + 0.01
    assert rolling.p[-1, 0, 0] == pytest.approx(G * (np.sin(a) - 0.02 * np.cos(a)) / 2.8, rel=1e-10)


@pytest.mark.parametrize("resistance", [(2e-3, 0.0), (1e-3, 5e-4)])
def test_a_disc_with_resistance_follows_its_reference(resistance: tuple[float, float]) -> None:
    disc = Disc(Real("0.1"), Real("0.4"), *reals(resistance))
    first = reals([0, 0, 0.4, 1.0, 0.2, 0.5, 7.0, -4.0])
    moving = [disc.rotation(first), disc.frame(first) @ first[5:], disc.centre(first)]
    R, w, p = (each.astype(float) for each in moving)
    v = np.cross(w, p - disc.contact(first).astype(float))
    coin = make.dynamic(
        "coin", make.circle(0.1), mass=0.4, inertia=[1e-3, 1e-3, 2e-3], position=p.tolist(),
        rotation=R.tolist(), velocity=v.tolist(), angular_velocity=w.tolist(),
    )  # fmt: skip
    keys = {"rolling_resistance": resistance[0], "spinning_resistance": resistance[1]}
    path = ran([coin, TABLE], 1.0, [{"between": ["coin", "table"], "friction": 2.0, **keys}], samples=4)
    exact = disc.run(first, path.t)
    assert not path.events
    assert np.abs(path.p[:, 0] - [disc.centre(x).astype(float) for x in exact]).max() < 1e-10
    assert imbalance(path) < 1e-12


def test_friction_of_two_coefficients_turns_slip_towards_the_slippery_axis() -> None:
    along, mu = np.array([np.cos(0.4), np.sin(0.4)]), np.array([0.3, 0.1])
    axes = np.array([along, [-along[1], along[0]]])

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        slip = axes @ (y[2:4] + 0.1 * np.array([-y[5], y[4]]))
        force = -G * axes.T @ (mu**2 * slip / np.linalg.norm(mu * slip))
        return np.concatenate([y[2:4], force, [0.1 * force[1] / I, -0.1 * force[0] / I]])

    exact = solve_ivp(slope, (0, 0.2), [0, 0, 2, 1, 0, 0], "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    turned = make.fixed("table", make.plane(), axis_angle={"axis": [0, 0, 1], "angle": 0.4})
    thrown = ball("ball", [0, 0, 0.1], velocity=[2.0, 1.0, 0.0])
    for table, direction in ((TABLE, [*along.tolist(), 0.0]), (turned, [1.0, 0.0, 0.0])):
        friction = {"kinetic": mu.tolist(), "direction": direction}
        path = ran([table, thrown], 0.2, [{"between": ["table", "ball"], "friction": friction}])
        assert path.p[-1, 1, :2] == pytest.approx(exact[:2], abs=1e-12)
        assert imbalance(path) < 1e-12


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(40))
def test_the_torque_of_resistance_is_what_turns_the_body_beside_the_contact_force(seed: int) -> None:
    """I dw/dt + w x I w - r x f, whatever the direction of friction and the order of the pair."""
    rng = np.random.default_rng(seed)
    turn = Rotation.from_rotvec(rng.uniform(-2, 2, 3))
    axes, normal = turn.as_matrix(), turn.as_matrix()[:, 2]
    inertia = rng.uniform(3e-3, 5e-3, 3)
    direction = (axes @ [*rng.normal(size=2), rng.normal()]) if seed % 4 else None
    kinetic = {"kinetic": [0.5, 0.4], "direction": direction.tolist()} if seed % 4 else 0.5
    body, plane = "ball/sphere", "ramp/plane"
    scene = make.scene(
        "rolling",
        [
            make.dynamic(
                "ball", make.sphere(0.1), mass=1.0, inertia=inertia.tolist(),
                position=(0.1 * normal).tolist(), velocity=(axes @ [*rng.uniform(-0.5, 0.5, 2), 0]).tolist(),
                angular_velocity=rng.uniform(-6, 6, 3).tolist(),
            ),
            make.fixed("ramp", make.plane(), rotation=axes.tolist()),
        ],
        contact=[
            {
                "between": [plane, body] if seed % 2 else [body, plane], "friction": kinetic,
                "rolling_resistance": float(rng.uniform(1e-3, 5e-3)),
                "spinning_resistance": float(rng.uniform(0, 2e-3)),
            }
        ],
        gravity=(-G * normal).tolist(),
        sensor=[{"name": "turning", "of": "ball.angular_acceleration"}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.3, samples=20, estimate=False)
    R = Rotation.from_quat(path.quaternion[:, 0], scalar_first=True).as_matrix()
    tensor = R @ np.diag(inertia) @ np.swapaxes(R, 1, 2)
    w, side = path.w[:, 0], np.sign(path.normals[:, 0] @ normal)  # 1: on the ball
    turned = np.einsum("nij,nj->ni", tensor, path.sensors) + np.cross(w, np.einsum("nij,nj->ni", tensor, w))
    point = np.where(side[:, None] > 0, path.points_f[:, 0], path.points_o[:, 0])
    force = path.force * normal + side[:, None] * path.friction[:, 0]
    right = turned - np.cross(point - path.p[:, 0], force)
    assert np.abs(right).max() > 1e-3
    assert side[:, None] * path.contact_torque[:, 0] == pytest.approx(right, abs=1e-10)
