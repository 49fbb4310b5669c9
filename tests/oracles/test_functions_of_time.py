"""Loads, driven bodies and given motions of a moment are not stepped over, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

LEVELS = pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
BALL = """
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = 1.0
inertia = [4e-3, 4e-3, 4e-3]
position = [0.0, 0.0, {height}]
"""
PLANE = """
[[body]]
name = "plane"
shape = {{ kind = "plane" }}
motion = "{motion}"
{path}

[[contact]]
between = ["ball", "plane"]
{contact}
"""
PUSH = '[[force]]\nbody = "ball"\nforce = ["{force}", 0.0, "{lift}"]\n'
WEIGHT = 9.81


def ran(text: str, accuracy: str, until: float = 1.0, samples: int = 50) -> Trajectory:
    return simulate(
        library_of(read_text(text, "moment.toml")), until=until, accuracy=accuracy, samples=samples
    )


@LEVELS
@pytest.mark.parametrize("width", [4e-3, 1e-2, 0.1])
def test_a_short_push_moves_a_free_ball(accuracy: str, width: float) -> None:
    text = BALL.format(height=0.1) + PUSH.format(
        force=f"{4 / width}*exp(-((t - 0.5)/{width})**2)", lift=WEIGHT
    )
    path = ran(text, accuracy)
    after = path.t > 0.5 + 6 * width
    x = np.zeros((after.sum(), 3))
    x[:, 0], x[:, 2] = 4 * np.sqrt(np.pi) * (path.t[after] - 0.5), 0.1
    assert path.estimate is not None
    error = np.abs(path.p[after, path.body_names.index("ball")] - x).max(initial=0.0)
    assert error < 5 * path.position_error[-1] + 1e-12
    assert error < 1e-4


@LEVELS
@pytest.mark.parametrize("width", [0.01, 0.05])
def test_a_short_push_moves_a_ball_that_sticks(accuracy: str, width: float) -> None:
    """It slips while the push exceeds 3.5 times friction, until its surface has caught up."""
    text = BALL.format(height=0.1) + PUSH.format(force=f"20*max(0, 1 - abs(t - 0.418)/{width})", lift=0.0)
    path = ran(text + PLANE.format(motion="fixed", path="", contact="friction = 0.3"), accuracy)
    slips = [event for event in path.events if event.kind != "load-switch"]  # whose kinks are events too
    assert [event.kind for event in slips] == ["slip-start", "slip-stop"]
    begins = 0.418 - width * (1 - 0.3 * WEIGHT * 3.5 / 20)
    assert slips[0].t == pytest.approx(begins, abs=1e-6)
    kinks = [event.t for event in path.events if event.kind == "load-switch"]
    assert kinks == pytest.approx([0.418 - width, 0.418, 0.418 + width], abs=1e-6)
    momentum = 20 * width * 0.1 / (0.1 + 4e-3 / 0.1)  # about the contact, over its arm
    assert path.v[-1, path.body_names.index("ball"), 0] == pytest.approx(momentum, rel=1e-4)


@LEVELS
def test_a_plane_that_comes_for_a_moment_strikes(accuracy: str) -> None:
    """It passes z = 0.05 upward at 0.437 - w sqrt(ln 2), and the ball leaves it at 1.5 times its speed."""
    width = 4e-3
    path = f'path = {{ position = ["0.0", "0.0", "0.1*exp(-((t - 0.437)/{width})**2)"] }}'
    scene = BALL.format(height=0.15) + PLANE.format(motion="driven", path=path, contact="restitution = 0.5")
    found = ran(scene + f'[[force]]\nbody = "ball"\nforce = [0.0, 0.0, {WEIGHT}]\n', accuracy)
    late = np.sqrt(np.log(2))
    assert [event.t for event in found.events] == pytest.approx([0.437 - width * late], abs=1e-8)
    assert found.v[-1, found.body_names.index("ball"), 2] == pytest.approx(1.5 * 0.1 * late / width, rel=1e-6)


@LEVELS
@pytest.mark.parametrize("frequency", [20.0, 200.0])
def test_a_ball_stays_above_a_plate_that_shakes(accuracy: str, frequency: float) -> None:
    path = f'path = {{ position = ["0.0", "0.0", "0.02/{frequency}*sin(2*pi*{frequency}*t)"] }}'
    scene = BALL.format(height=0.2) + PLANE.format(motion="driven", path=path, contact="restitution = 0.5")
    found = ran(scene, accuracy, samples=2000)
    horizon = found.estimate.horizon if found.estimate else None
    assert found.gap[found.t <= (horizon or np.inf)].min() > -1e-5


@LEVELS
def test_a_joint_follows_a_motion_of_a_moment(accuracy: str) -> None:
    turn = '[[joint]]\nname = "hinge"\nkind = "revolute"\nbetween = ["world", "ball"]\n'
    path = ran(
        BALL.format(height=0.0) + turn + 'motion = "0.2*exp(-((t - 0.437)/4e-3)**2)"\n',
        accuracy,
        samples=1000,
    )
    turned = 2 * np.arcsin(path.quaternion[:, path.body_names.index("ball"), 3])
    assert np.abs(turned - 0.2 * np.exp(-(((path.t - 0.437) / 4e-3) ** 2))).max() < 1e-6
