"""Gravity, or a speed, that is too faint to change a run does not set the time by which events are told."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.running import library_of

GRAVITY = [10.0**-k for k in range(3, 17)]  # m/s^2
END = 0.4  # s


def rod_on_two_balls(gravity: float) -> Trajectory:
    """A rod that comes down on two balls, on one of them 0.7 ns later."""
    balls = [
        make.fixed("left", make.sphere(0.03), position=[-0.12, 0, 0]),
        make.fixed("right", make.sphere(0.03), position=[0.07, 0, -6.9e-10]),
    ]
    rod = make.dynamic(
        "rod", make.capsule(0.02, 0.3), density=800.0, position=[0, 0, 0.1], rpy=[0, np.pi / 2, 0],
        velocity=[0, 0, -1.0],
    )  # fmt: skip
    contact = [{"between": [ball.name, "rod"], "friction": 0.3} for ball in balls]
    scene = make.scene("falls", [*balls, rod], contact=contact, gravity=[0, 0, -gravity])
    return simulate(library_of(scene), until=END, samples=8)


@pytest.mark.parametrize("gravity", GRAVITY)
def test_faint_gravity_changes_no_more_than_it_accelerates(gravity: float) -> None:
    still, path = rod_on_two_balls(0.0), rod_on_two_balls(gravity)
    assert path.is_trusted
    blows = [[event.t for event in run.events if event.speed > 0.1] for run in (still, path)]
    assert len(blows[1]) == len(blows[0])
    for one, other in zip(*blows, strict=True):
        assert abs(one - other) < 10 * gravity * END**2 + 1e-12
    errors = still.position_error[-1] + path.position_error[-1]
    assert np.abs(path.p - still.p).max() < errors + 10 * gravity * END**2 + 1e-12


@pytest.mark.parametrize("speed", [0.0, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize("gravity", [0.0, 1e-15, 1e-9])
def test_a_spring_sets_the_time_of_a_ball_that_hardly_moves(speed: float, gravity: float) -> None:
    ball = make.dynamic(
        "ball", make.sphere(0.05), mass=1.0, inertia=[1e-3] * 3, position=[0, 0, 0.1], velocity=[0, speed, 0]
    )
    spring = {
        "between": ["floor", "ball"], "anchors": [[0, 0, 0.3], [0, 0, 0]], "stiffness": 100.0,
        "rest_length": 0.1,
    }  # fmt: skip
    scene = make.scene(
        "hangs", [make.fixed("floor", make.plane()), ball], contact=[{"between": ["floor", "ball"]}],
        spring=[spring], gravity=[0, 0, -gravity],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.2, samples=6)
    assert path.is_trusted
    height = 0.2 - 0.1 * np.cos(10 * path.t)
    assert np.abs(path.p[:, 1, 2] - height).max() < path.position_error[-1] + gravity + 2 * speed**2 + 1e-9
