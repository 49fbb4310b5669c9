"""A uniform rod slides down a smooth wall and floor and leaves the wall at two thirds of its height.

Source: classical; with phi from the vertical, (4/3) L^2 phi_ddot = g L sin phi of half length L while both
ends touch, and the wall lets go where cos phi = (2/3) cos phi_0; the time by quadrature.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, G
from tests.running import library_of

HALF, START, MASS = 1.0, np.pi / 6, 3.0


@cache
def ladder() -> Library:
    wall = make.fixed("wall", make.plane(), axis_angle={"axis": [0, 1, 0], "angle": "pi/2"})
    ends = [make.point(0, 0, z, name=name) for name, z in (("foot", -HALF), ("top", HALF))]
    across = MASS * HALF**2 / 3
    rod = make.dynamic(
        "rod", *ends, mass=MASS, inertia=[across, across, 0.01 * across],
        position=[HALF * np.sin(START), 0, HALF * np.cos(START)],
        axis_angle={"axis": [0, 1, 0], "angle": -START},
    )  # fmt: skip
    pairs = [{"between": ["rod/foot", "table"]}, {"between": ["rod/top", "wall"]}]
    return library_of(make.scene("ladder", [TABLE, wall, rod], contact=pairs))


def falling_rate(phi: float) -> float:
    return float(np.sqrt(1.5 * G / HALF * (np.cos(START) - np.cos(phi))))


def test_the_wall_lets_go_at_two_thirds_of_the_height() -> None:
    path = simulate(ladder(), until=0.5, accuracy=Accuracy.tight(), estimate=False)
    (event,) = path.events
    assert (event.kind, event.contact) == ("lift-off", "rod-wall")
    phi = np.arccos(2 / 3 * np.cos(START))
    # phi = start + s^2 takes the root out of the integrand
    time = quad(
        lambda s: 2 * s / falling_rate(START + s * s), 0, np.sqrt(phi - START), epsabs=1e-13, epsrel=1e-13
    )[0]
    assert time == pytest.approx(0.459662826377, abs=1e-11)
    assert event.t == pytest.approx(time, abs=1e-9)


def test_angle_and_speed_at_the_wall_are_those_of_the_closed_form_and_stay() -> None:
    (event,) = simulate(ladder(), until=0.5, accuracy=Accuracy.tight(), estimate=False).events
    path = simulate(ladder(), until=event.t, accuracy=Accuracy.tight(), estimate=False)
    rod = path.body_names.index("rod")
    phi = np.arctan2(path.p[-1, rod, 0], path.p[-1, rod, 2])
    assert phi == pytest.approx(0.955316618125, abs=1e-9)
    assert path.w[-1, rod] == pytest.approx([0, -falling_rate(phi), 0], abs=1e-9)
    assert falling_rate(phi) == pytest.approx(2.06103241255, abs=1e-8)
    assert 2 * path.p[-1, rod, 2] == pytest.approx(1.15470053838, abs=1e-8)
    after = simulate(ladder(), until=0.6, accuracy=Accuracy.tight(), estimate=False)
    speed = after.v[after.t > event.t, rod, 0]
    assert speed == pytest.approx(np.full(len(speed), 1.18993761819), abs=1e-8)
    assert after.energy_drift < 1e-12


def test_the_forces_of_wall_and_floor_are_those_of_the_closed_form() -> None:
    path = simulate(ladder(), until=0.45, accuracy=Accuracy.tight(), estimate=False)
    rod = path.body_names.index("rod")
    phi = np.arctan2(path.p[:, rod, 0], path.p[:, rod, 2])
    wall = 0.75 * MASS * G * np.sin(phi) * (3 * np.cos(phi) - 2 * np.cos(START))
    floor = 0.25 * MASS * G * (1 + 9 * np.cos(phi) ** 2 - 6 * np.cos(phi) * np.cos(START))
    for name, expected in (("rod-wall", wall), ("rod-table", floor)):
        force = path.force[:, path.contact_names.index(name)]
        assert np.abs(force - expected).max() < 1e-8 * MASS * G
