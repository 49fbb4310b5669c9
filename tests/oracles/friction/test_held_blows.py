"""Blows in turn on bodies that joints hold: along what they lock nothing slips, and no friction is spent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.friction.impact import Planar
from tests.oracles.pieces import TABLE, imbalance, ran

HALF, MASS, ABOUT = np.array([0.25, 0.2]), np.array([1.0, 0.6]), np.array([0.02, 0.01])
BARE = replace(Accuracy.tight(), fallback=False)
UNTIL = 1e-10  # s


def arms_of(angles: np.ndarray) -> np.ndarray:
    """(2, 2) x and z from the upper end of each link to its centre."""
    return HALF[:, None] * np.stack([np.cos(angles), -np.sin(angles)], axis=1)


def rates_over(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Over the rates of the links: velocities (x, z) of their centres (2, 2, 2), and of the tip (2, 2)."""
    arms = arms_of(angles)
    across = np.stack([arms[:, 1], -arms[:, 0]], axis=1)
    none = np.zeros(2)
    upper, lower = np.stack([across[0], none], axis=1), np.stack([2 * across[0], across[1]], axis=1)
    return np.stack([upper, lower]), lower + np.stack([none, across[1]], axis=1)


def quaternion(turn: Rotation) -> list[float]:
    """Its scalar first."""
    return [float(x) for x in turn.as_quat()[[3, 0, 1, 2]]]


def tip_struck(law: str, mu: float, angles: np.ndarray, rates: np.ndarray, heading: float) -> Trajectory:
    """The tip of a double pendulum meets the table at t = 0, in a plane at an angle to the table's axes."""
    about = Rotation.from_euler("z", heading)
    arms = arms_of(angles)
    high = -2 * arms[:, 1].sum()
    ends = np.array([[0.0, high], [2 * arms[0, 0], high + 2 * arms[0, 1]]])
    speeds = rates_over(angles)[0] @ rates

    def placed(at: np.ndarray) -> list[float]:
        return [float(x) for x in about.apply([at[0], 0.0, at[1]])]

    links = [
        make.dynamic(
            name, *shapes, mass=MASS[k], inertia=[ABOUT[k]] * 3, position=placed(ends[k] + arms[k]),
            velocity=placed(speeds[k]), quaternion=quaternion(about * Rotation.from_euler("y", angles[k])),
            angular_velocity=[float(x) for x in about.apply([0.0, rates[k], 0.0])],
        )
        for k, (name, shapes) in enumerate((("upper", ()), ("lower", (make.point(HALF[1], 0.0, 0.0),))))
    ]  # fmt: skip
    axis = quaternion(about * Rotation.from_euler("x", -np.pi / 2))
    joints = [
        {"name": name, "kind": "revolute", "between": pair, "position": placed(ends[k]), "quaternion": axis}
        for k, (name, pair) in enumerate((("hook", ["world", "upper"]), ("elbow", ["upper", "lower"])))
    ]
    contact = {"between": ["lower", "table"], "friction": mu, "restitution": {"law": law, "value": 0.5}}
    return ran([*links, TABLE], UNTIL, [contact], BARE, samples=1, joint=joints, gravity=[0, 0, 0])


@pytest.mark.cases(12)
@pytest.mark.parametrize("heading", [0.0, 0.7])
@pytest.mark.parametrize("mu", [0.2, 0.9, 1.5, 3.0])
@pytest.mark.parametrize("law", ["poisson", "stronge"])
@pytest.mark.parametrize("seed", range(6))
def test_a_tip_is_struck_as_in_the_plane_that_its_joints_leave(
    law: str, mu: float, heading: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    angles, speed = rng.uniform(0.2, 1.2, 2), 10.0 ** rng.uniform(-3, 0)
    centres, tip = rates_over(angles)
    rates = np.linalg.solve(tip, speed * np.array([rng.uniform(-2, 2), -1.0]))
    inertia = sum(MASS[k] * centres[k].T @ centres[k] for k in range(2)) + np.diag(ABOUT)
    G = tip @ np.linalg.solve(inertia, tip.T)
    blow = Planar(G[0, 0], G[0, 1], G[1, 1], mu, *(tip @ rates))
    normal = getattr(blow, law)(0.5)
    wanted = rates + np.linalg.solve(inertia, tip.T @ [blow.at(normal)[0], normal])
    path = tip_struck(law, mu, angles, rates, heading)
    assert path.t_end == UNTIL
    across, fast = Rotation.from_euler("z", heading).as_matrix()[:, 1], float(np.abs(wanted).max())
    on = 20 * UNTIL * fast  # what they have turned on since
    assert path.w[-1, :2] @ across == pytest.approx(wanted, abs=fast * (1e-12 + on))
    assert imbalance(path) < 1e-12 * speed**2
