"""What friction leaves alone, over ten seconds."""

from __future__ import annotations

import numpy as np

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.friction.tops import TOP_MASS, TOP_RADIUS
from tests.oracles.pieces import TABLE, ran, rotations
from tests.running import run

TEN = 10.0


def spin(path: Trajectory, body: int, inertia: object) -> np.ndarray:
    """(n, 3) angular momentum about the centre of mass, world."""
    R = rotations(path, body)
    return np.einsum("nij,j,nkj,nk->ni", R, np.array(inertia), R, path.w[:, body])


def spread(values: np.ndarray) -> float:
    """The largest change, against the first."""
    return float(np.abs(values - values[0]).max() / np.linalg.norm(values[0]))


def test_a_body_that_rolls_keeps_its_energy() -> None:
    path = run("rolling_ellipsoid", Accuracy.tight(), until=TEN)
    assert not path.events
    assert spread(path.energy) < 1e-11


def test_a_tippe_top_keeps_jelletts_integral_while_it_slides_and_while_it_rolls() -> None:
    path = run("tippe_top", Accuracy.tight(), until=TEN)
    assert [event.kind for event in path.events] == ["slip-stop"]
    scale = TOP_MASS * TOP_RADIUS**2
    momentum = spin(path, 1, [131 / 350 * scale, 131 / 350 * scale, 0.4 * scale])
    arm = path.points_o[:, 0] - path.p[:, 1]
    assert spread(np.einsum("ni,ni->n", momentum, arm)) < 1e-11


def test_a_ball_that_is_heavier_to_turn_about_one_axis_keeps_angular_momentum_about_the_contact() -> None:
    """Chaplygin's ball: its centre of mass is its centre, its moments of inertia are not alike."""
    inertia, w = [0.003, 0.004, 0.0055], np.array([3.0, -4.0, 8.0])
    v = 0.1 * np.array([w[1], -w[0], 0.0])
    ball = make.dynamic(
        "ball", make.sphere(0.1), mass=1.0, inertia=inertia, position=[0, 0, 0.1],
        velocity=v.tolist(), angular_velocity=w.tolist(), rpy=[0.4, 0.3, 0.2],
    )  # fmt: skip
    path = ran([ball, TABLE], TEN, [{"between": ["ball", "table"], "friction": 1.0}], samples=50)
    assert not path.events
    orbital = np.cross([0, 0, 0.1], path.v[:, 0])
    assert spread(spin(path, 0, inertia) + orbital) < 1e-11
    assert spread(path.energy) < 1e-11
    assert np.ptp(path.w[:, 0, 2]) > 0.3  # it does not just spin
