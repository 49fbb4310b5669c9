"""The shipped glass, from its slide across the table to its rim, against coordinates of its own."""

from __future__ import annotations

from math import hypot

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from tests.oracles.glass_reference import G, Glass, harmonics, motion
from tests.running import run

MASS, RADIUS, HEIGHT, ABOVE, INERTIA = 0.3, 0.04, 0.05, 0.03, (3.7e-4, 3.7e-4, 2.4e-4)
PUSH, TIP, TURN = 2.0, 0.01, 0.0005  # N/s along x; N m/s about x; N m about z
EDGE = MASS * G * RADIUS / hypot(ABOVE * PUSH, TIP)  # s; when the pressure reaches the edge
BOUNDS = {"tight": (1e-12, 1e-10), "balanced": (1e-11, 1e-8)}  # m; rotation


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", BOUNDS)
def test_the_shipped_glass_slides_and_rolls_as_the_reference_does(accuracy: str) -> None:
    spin, yaw = TURN / INERTIA[2] * EDGE, TURN / INERTIA[2] * EDGE**2 / 2
    torque = ((TIP * EDGE, TIP), (0.0,), (TURN,))
    velocity = (PUSH * EDGE**2 / (2 * MASS), 0.0)
    glass = Glass(
        harmonics(RADIUS), MASS, INERTIA, HEIGHT, ABOVE, ((PUSH * EDGE, PUSH), (0.0,)), torque, velocity, spin
    )
    path = run("glass_on_table", Accuracy.named(accuracy), until=2.15, samples=215)
    rolling = path.t > EDGE + 0.004
    expected = motion(glass, path.t[rolling].astype(float) - EDGE, 0.004)
    p = expected.p + np.array([PUSH * EDGE**3 / (6 * MASS), 0.0, 0.0])
    rotation = expected.rotation @ Rotation.from_rotvec([0.0, 0.0, yaw]).as_matrix()
    found = Rotation.from_quat(np.roll(path.quaternion[rolling, 1].astype(float), -1, axis=-1)).as_matrix()
    position, turn = BOUNDS[accuracy]
    assert abs(path.p[rolling, 1] - p).max() < position
    assert abs(found - rotation).max() < turn
    assert np.ptp(path.energy - path.work) < 1e-11


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
def test_the_shipped_glass_tips_on_time_however_long_its_steps(tolerance: float) -> None:
    """It turns by 2 rad before, in three steps, at whose ends quaternions are not of unit length."""
    path = run("glass_on_table", Accuracy.of(tolerance), until=2.15, samples=1)
    (tip,) = (event.t for event in path.events if event.kind == "tipping")
    assert tip == pytest.approx(EDGE, abs=1e-10)


def test_a_finer_tolerance_does_not_make_the_shipped_glass_err_by_more_than_twice_as_much() -> None:
    def turned(tolerance: float) -> np.ndarray:
        path = run("glass_on_table", Accuracy.of(tolerance), until=2.15, samples=100)
        return np.asarray(path.quaternion[:, 1], dtype=float)

    true = turned(1e-13)
    errors = [abs(turned(10.0**-k) - true).max() for k in range(2, 12)]
    least = np.minimum.accumulate(errors)
    assert (np.array(errors[1:]) < 2 * least[:-1]).all()
