"""A foot of a rimless wheel sticks however small the wheel's inertia is: angle, forces, and the next blow.

Spokes of 1 m and a mass of 1 kg at their centre, on a slope. While one foot sticks, the wheel is a pendulum
upside down, (m r^2 + I) a'' = m g r sin(a + slope), with `a` the angle of the spoke from the normal of the
slope. Its energy gives the rate by the angle, and quadrature the time.
"""

from __future__ import annotations

from functools import cache
from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.scene import python_scenes as make
from tests.running import library_of

SLOPE, START, RATE, G, SPOKES = 0.08, -0.3, 1.3, 9.81, 8


@cache
def wheel(inertia: float) -> Library:
    feet = [
        make.point(sin(2 * pi * k / SPOKES), 0.0, -cos(2 * pi * k / SPOKES), name=f"s{k}")
        for k in range(SPOKES)
    ]
    bodies = [
        make.fixed("slope", make.plane()),
        make.planar(
            "wheel",
            *feet,
            normal=[0.0, 1.0, 0.0],
            mass=1.0,
            inertia=[inertia / 2, inertia, inertia / 2],
            position=[sin(START), 0.0, cos(START)],
            rpy=[0.0, START, 0.0],
            velocity=[RATE * cos(START), 0.0, -RATE * sin(START)],
            angular_velocity=[0.0, RATE, 0.0],
        ),
    ]
    contacts = [{"between": [f"wheel/s{k}", "slope"], "friction": 0.5} for k in range(SPOKES)]
    gravity = [G * sin(SLOPE), 0.0, -G * cos(SLOPE)]
    return library_of(make.scene("light_wheel", bodies, contact=contacts, gravity=gravity))


def rate_at(angle: np.ndarray | float, inertia: float) -> np.ndarray:
    """rad/s, by energy."""
    return np.sqrt(RATE**2 + 2 * G / (1 + inertia) * (cos(START + SLOPE) - np.cos(np.add(angle, SLOPE))))


def time_at(angle: float, inertia: float) -> float:
    """s, by Gauss-Legendre quadrature of da / rate."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    half = (angle - START) / 2
    return float(half * np.sum(weights / rate_at(START + half * (1 + nodes), inertia)))


def forces_at(angle: float, inertia: float) -> tuple[float, float]:
    """N: normal force, and friction along the slope, from m a_c = f + m g."""
    turn, rate = G * sin(angle + SLOPE) / (1 + inertia), float(rate_at(angle, inertia))
    along = turn * cos(angle) - rate**2 * sin(angle) - G * sin(SLOPE)
    normal = -turn * sin(angle) - rate**2 * cos(angle) + G * cos(SLOPE)
    return normal, along


@pytest.mark.parametrize("inertia", [1e-1, 1e-3, 1e-5, 1e-7, 1e-8, 1e-9, 3e-10])
def test_a_light_foot_sticks(inertia: float) -> None:
    path = simulate(wheel(inertia), until=0.05, samples=2, estimate=False)
    assert path.outcome.succeeded, path.outcome
    assert not path.events
    wheel_at = path.body_names.index("wheel")
    for k, t in enumerate(path.t):
        centre = path.p[k, wheel_at]
        angle = float(np.arctan2(centre[0], centre[2]))
        assert time_at(angle, inertia) == pytest.approx(t, abs=2e-9)
        normal, along = forces_at(angle, inertia)
        assert path.force[k, 0] == pytest.approx(normal, rel=1e-6)
        assert path.friction[k, 0, 0] == pytest.approx(along, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("inertia", [1e-3, 1e-9])
def test_the_next_foot_strikes_in_time(inertia: float) -> None:
    end = time_at(pi / SPOKES, inertia)
    path = simulate(wheel(inertia), until=end + 1e-3, samples=1, estimate=False)
    blows = [event for event in path.events if event.kind in ("touch-down", "impact")]
    assert [event.contact for event in blows] == ["wheel/s1-slope/plane"]
    assert blows[0].t == pytest.approx(end, abs=1e-8)
