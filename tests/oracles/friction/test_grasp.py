"""The references of the egg between two fingers, against linear programming and the balance of forces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from tests.oracles.friction.grasp import RolledBetween, chord, least_mu, least_squeeze

AXES = np.array([0.03, 0.022, 0.022])


def inward(point: np.ndarray) -> np.ndarray:
    normal = -point / AXES**2
    return np.asarray(normal / np.linalg.norm(normal))


def balanced(points: list[np.ndarray], normals: list[np.ndarray], mu: float, facets: int = 720) -> bool:
    """Whether forces in the (finely faceted, circumscribed) cones, one of normal force 1, balance."""
    columns = []
    for point, normal in zip(points, normals, strict=True):
        t1 = np.linalg.svd(normal[None])[2][1]
        t2 = np.cross(normal, t1)
        for angle in np.linspace(0, 2 * np.pi, facets, endpoint=False):
            push = normal + mu * (np.cos(angle) * t1 + np.sin(angle) * t2)
            columns.append([*push, *np.cross(point, push)])
    rows = np.array(columns).T * np.array([1, 1, 1, 30, 30, 30])[:, None]
    one = np.repeat([1.0, 0.0], facets)
    found = linprog(np.zeros(2 * facets), A_eq=np.vstack([rows, one]), b_eq=[0] * 6 + [1.0], method="highs")
    return bool(found.status == 0)


@pytest.mark.parametrize("slant", [0.0, 0.2, 0.5])
def test_two_fingers_hold_from_the_least_mu_on(slant: float) -> None:
    first = AXES * np.array([np.sin(0.2), -np.cos(0.2), 0.0])
    second = chord(AXES, first, np.array([np.sin(slant), np.cos(slant), 0.1]))
    assert ((second / AXES) ** 2).sum() == pytest.approx(1, abs=1e-14)
    normals = [inward(first), inward(second)]
    least = least_mu(first, normals[0], second, normals[1])
    assert balanced([first, second], normals, least * 1.01)
    assert not balanced([first, second], normals, least * 0.99)


def test_opposite_poles_need_no_friction() -> None:
    pole = np.array([0, 0.022, 0])
    assert least_mu(-pole, inward(-pole), pole, inward(pole)) == pytest.approx(0, abs=1e-15)


def test_an_egg_between_plates_turns_without_slip_and_its_friction_balances() -> None:
    egg = RolledBetween(0.022, 0.06, 1.1e-5, 2.0)
    for y, plate in ((0.022, 0.3), (-0.022, -0.3)):
        surface = np.cross([0, 0, egg.spin(0.3)], [0, y, 0])
        assert surface == pytest.approx([plate, 0, 0])
    accel = 4.0  # of the plates: friction +-turn along x, weight / 2 up, at levers +-b
    turn = -egg.inertia * egg.spin(accel) / (2 * 0.022)
    torque = np.cross([0, 0.022, 0], [turn, 0, 0]) + np.cross([0, -0.022, 0], [-turn, 0, 0])
    assert torque[2] == pytest.approx(egg.inertia * egg.spin(accel))
    assert egg.needed_mu(accel) == pytest.approx(np.hypot(turn, 0.06 * 9.81 / 2) / 2.0)
    assert egg.needed_mu() == pytest.approx(0.06 * 9.81 / (2 * 2.0))
    assert least_squeeze(0.06 * 9.81, egg.needed_mu()) == pytest.approx(2.0)
