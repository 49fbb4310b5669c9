"""Driven bodies whose speed jumps strike what rests on them, carry it along, or leave it: closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

BODIES = """
[[body]]
name = "plane"
motion = "driven"
shape = {{ kind = "plane" }}
path = {{ position = {position} }}

[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = 1.0
inertia = [4e-3, 4e-3, 4e-3]
position = [0.0, 0.0, 0.1]

[[contact]]
between = ["ball", "plane"]
{contact}
"""
G, START, SPEED = 9.81, 0.3, 0.5
DRIFT = 0.02  # of the kinetic energy; a jerk that is missed loses all of it
LEVELS = pytest.mark.parametrize(("accuracy", "off"), [("fast", 1e-8), ("balanced", 1e-12), ("tight", 1e-13)])


def ran(position: str, contact: str, accuracy: str) -> Trajectory:
    scene = read_text(BODIES.format(position=position, contact=contact), "jerk.toml")
    path = simulate(library_of(scene), until=1.0, accuracy=accuracy, samples=80)
    assert path.energy_drift < DRIFT
    assert path.estimate is not None
    return path


@LEVELS
def test_a_plane_that_starts_upward_strikes_what_lies_on_it(accuracy: str, off: float) -> None:
    path = ran(f'["0.0", "0.0", "{SPEED}*max(0, t - {START})"]', "restitution = 0.5", accuracy)
    z, begins, u = np.full(len(path.t), 0.1), START, SPEED / 2
    after = path.t > START
    z[after] += SPEED * (path.t[after] - START)
    while u > 1e-7:
        lasts = 2 * u / G
        flies = (path.t > begins) & (path.t < begins + lasts)
        z[flies] += (u - G / 2 * (path.t[flies] - begins)) * (path.t[flies] - begins)
        begins, u = begins + lasts, u / 2
    assert np.abs(path.p[:, 1, 2] - z).max() < off
    assert path.events[0].t == pytest.approx(START, abs=1e-9)
    assert path.events[0].speed == pytest.approx(SPEED)


@LEVELS
def test_a_plane_that_starts_downward_leaves_what_lies_on_it(accuracy: str, off: float) -> None:
    path = ran(f'["0.0", "0.0", "-{SPEED}*max(0, t - {START})"]', "", accuracy)
    lands = START + 2 * SPEED / G
    z = np.where(path.t < START, 0.1, 0.1 - G / 2 * (path.t - START) ** 2)
    z = np.where(path.t > lands, 0.1 - SPEED * (path.t - START), z)
    assert [event.kind for event in path.events] == ["lift-off", "touch-down"]
    assert np.abs(path.p[:, 1, 2] - z).max() < off


@LEVELS
def test_a_belt_that_starts_slips_under_a_ball_until_it_rolls(accuracy: str, off: float) -> None:
    path = ran(f'["2.0*max(0, t - {START})", "0.0", "0.0"]', "friction = 0.2", accuracy)
    a = 0.2 * G
    rolls = START + 2.0 / (a * (1 + 0.1**2 / 4e-3))
    slides, then = a / 2 * (path.t - START) ** 2, a * (rolls - START) * (path.t - (START + rolls) / 2)
    x = np.where(path.t < START, 0, np.where(path.t < rolls, slides, then))
    assert [event.kind for event in path.events] == ["slip-start", "slip-stop"]
    assert np.abs(path.p[:, 1, 0] - x).max() < off


@LEVELS
def test_a_path_that_turns_fast_but_smoothly_strikes_nothing(accuracy: str, off: float) -> None:
    path = ran('["0.0", "0.0", "1e-4*(1 - cos(200*t))"]', "", accuracy)
    assert path.events == ()
    assert np.abs(path.p[:, 1, 2] - 0.1 - 1e-4 * (1 - np.cos(200 * path.t))).max() < 100 * off


@pytest.mark.cases(12)
@pytest.mark.parametrize("start", [0.0, 0.25, 0.3, 0.7])
@pytest.mark.parametrize("after", [0.0, 1e-3, 0.04])
@pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
def test_a_blow_is_whole_wherever_samples_and_ends_of_runs_fall(
    start: float, after: float, accuracy: str
) -> None:
    scene = read_text(
        BODIES.format(position=f'["0.0", "0.0", "{SPEED}*max(0, t - {start})"]', contact="restitution = 0.5"),
        "jerk.toml",
    )
    until = start + after or 1e-3
    path = simulate(library_of(scene), until=until, accuracy=accuracy, samples=5, estimate=False)
    assert [event.kind for event in path.events if event.t < start + 1e-6] == ["impact"]
    assert path.v[-1, 1, 2] == pytest.approx(1.5 * SPEED - G * (until - start), abs=1e-8)
    assert path.t_end == pytest.approx(until, abs=1e-8)
