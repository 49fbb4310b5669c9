"""Scenes that roll without slip, against their references."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.friction.disc import rolls_straight_above, spins_upright_above
from tests.oracles.friction.rolling_ellipsoid import reference
from tests.oracles.friction.sphere import Turntable
from tests.oracles.pieces import TABLE, ran, rotations
from tests.running import run


def total_force(path: Trajectory) -> np.ndarray:
    """(n, 3) N on the second body of the first contact."""
    return path.force[:, :1] * path.normals[:, 0] + path.friction[:, 0]


@pytest.mark.slow
@pytest.mark.parametrize(("accuracy", "drift", "off"), [("balanced", 1e-9, 1e-11), ("tight", 1e-12, 1e-13)])
def test_a_passive_ellipsoid_rolls_as_its_reference(accuracy: str, drift: float, off: float) -> None:
    path = run("rolling_ellipsoid", Accuracy.named(accuracy), samples=10)
    exact = reference(path.t)
    assert not path.events
    assert np.abs(path.energy - path.energy[0]).max() < drift * float(exact.kinetic[0])
    assert np.abs(path.p[:5, 1] - exact.p[:5]).max() < off  # up to 2 s
    assert np.abs(total_force(path) - exact.force).max() < 1e3 * off
    assert np.abs(path.slip).max() < 1e3 * off
    assert (path.work == 0).all()


def test_a_ball_on_a_turntable_goes_round_a_circle_of_its_own() -> None:
    path = run("turntable", Accuracy.tight())
    table = Turntable(3.0, np.array([0.2, 0, 0.05]), np.array([0, 0.4, 0]))
    assert not path.events
    assert np.abs(path.p[:, 1] - table.path(path.t)).max() < 1e-10
    # the table drives the ball: energy comes and goes as work
    assert np.ptp(path.energy) > 0.1
    assert np.abs(path.energy - path.energy[0] - path.work).max() < 1e-11


@pytest.mark.parametrize("straight", [True, False])
def test_an_upright_disc_wobbles_below_its_critical_speed_only(straight: bool) -> None:
    critical = rolls_straight_above(0.1) if straight else spins_upright_above(0.1)
    lean, largest = 1e-6, {}
    for factor in (0.999, 1.001):
        spin = factor * float(critical)
        disc = make.dynamic(
            "disc", make.circle(0.1), mass=1.0, inertia=[0.0025, 0.0025, 0.005],
            position=[0.1 * np.sin(lean), 0, 0.1 * np.cos(lean)], rpy=[0, np.pi / 2 + lean, 0],
            velocity=[0.0, -0.1 * spin * straight, 0.0],
            angular_velocity=[spin, 0, 0] if straight else [0, 0, spin],
        )  # fmt: skip
        contact = [{"between": ["disc", "table"], "friction": 5.0}]
        path = ran([disc, TABLE], 20.0, contact, Accuracy.balanced(), samples=400)
        largest[factor] = np.abs(rotations(path, 0)[:, 2, 2]).max()
    assert largest[0.999] > 0.03
    assert largest[1.001] < 2e-3


def test_a_coin_rolls_as_published() -> None:
    path = run("rolling_disc", Accuracy.tight())
    assert not path.events
    assert path.p[-1, 1] == pytest.approx([8.27529183556e-05, 0.00158178190055, 0.00976087384263], abs=1e-11)
    assert path.points_o[-1, 0, :2] == pytest.approx([0.00200494702065, 0.00259692310364], abs=1e-11)
    force = [-0.807813489485, -0.634913784517, 9.83551980688]
    assert total_force(path)[-1] == pytest.approx(force, abs=1e-8)
