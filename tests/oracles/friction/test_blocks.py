"""Blocks on four corners that stick and slip along a line, and the box pushed from under its balls."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.oracles.friction.sphere import PushedBox
from tests.oracles.friction.stick_slip import BeltOscillator, Motion, PulledToAndFro, thrown_up_incline
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran


def block(**keys: object) -> Body:
    """Of 1 kg, its centre of mass in the plane of its face, which is pressed alike all over."""
    shape = make.shape("box", size=[0.2, 0.2, 0.05], position=[0, 0, 0.025])
    return make.dynamic("block", shape, mass=1.0, inertia=[0.01, 0.01, 0.02], **keys)


def follows(path: Trajectory, body: int, motion: Motion, off: float) -> None:
    found = [(e.kind, e.t) for e in path.events if e.kind != "face-contact"]
    wanted = [event for event in motion.events if event[0] < path.t_end]
    assert len(found) == len(wanted)
    modes = {"slip-start": "slip", "slip-reversal": "slip", "slip-stop": "stick"}
    assert [modes[kind] for kind, _ in found] == [mode for _, mode in wanted]
    assert [t for _, t in found] == pytest.approx([t for t, _ in wanted], abs=10 * off)
    assert path.p[:, body, 0] == pytest.approx([motion.at(float(t))[0] for t in path.t], abs=off)
    assert imbalance(path) < 100 * off


@pytest.mark.parametrize(("accuracy", "off"), [(Accuracy.balanced(), 1e-10), (Accuracy.tight(), 1e-12)])
def test_a_block_on_a_belt_sticks_and_slips(accuracy: Accuracy, off: float) -> None:
    belt = make.driven("belt", make.plane(), path={"position": ["0.2*t", 0.0, 0.0]})
    friction = {"static": 0.4, "kinetic": 0.3}
    path = ran(
        [belt, block(velocity=[0.2, 0, 0]), make.fixed("wall")], 5.0,
        [{"between": ["block", "belt"], "friction": friction}], accuracy,
        spring=[{"between": ["block", "wall"], "stiffness": 100.0}],
    )  # fmt: skip
    follows(path, 1, BeltOscillator().motion(0.0, 0.2, 5.0), off)


@pytest.mark.cases(2)
@pytest.mark.parametrize("pull", [2.5, 5.0, 12.0])
def test_a_block_that_is_pulled_to_and_fro_stops_in_every_half_period(pull: float) -> None:
    contact = [{"between": ["block", "table"], "friction": 0.3}]
    force = [{"body": "block", "force": [f"{pull}*sin(4*t)", 0.0, 0.0]}]
    path = ran([block(), TABLE], 6.0, contact, force=force)
    follows(path, 0, PulledToAndFro(pull=pull).motion(6.0), 1e-11)


@pytest.mark.parametrize("static", [0.7, 0.5])
def test_a_block_thrown_up_an_incline_stays_or_returns(static: float) -> None:
    contact = [{"between": ["block", "table"], "friction": {"static": static, "kinetic": 0.4}}]
    gravity = [-G * np.sin(0.5), 0.0, -G * np.cos(0.5)]
    path = ran([block(velocity=[2.0, 0.0, 0.0]), TABLE], 1.0, contact, gravity=gravity)
    follows(path, 0, thrown_up_incline(0.5, 2.0, static, 0.4), 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("direction", [(0.5, 0.866025403784), (0.0, 1.0), (-1.0, 0.0)])
def test_a_box_pushed_in_any_direction_moves_as_its_closed_form(direction: tuple[float, float]) -> None:
    d = np.array(direction) / np.hypot(*direction)
    box = make.dynamic(
        "box", make.shape("box", size=[20, 20, 1], name="body"), make.plane(position=[0, 0, 0.5], name="top"),
        mass=10.0, inertia=[10 / 12 * 401, 10 / 12 * 401, 10 / 12 * 800], position=[0, 0, 0.5],
    )  # fmt: skip
    places = [(3.0 * i, 3.0 * j) for i in range(-2, 3) for j in range(-2, 3)]
    balls = [ball(f"ball{k}", [*place, 1.5], radius=0.5) for k, place in enumerate(places)]
    contact = [{"between": ["box/body", "table"], "friction": 0.4}]
    contact += [{"between": ["box/top", each.name], "friction": 0.8} for each in balls]
    push = [{"body": "box", "force": [*(150 * d).tolist(), 0.0]}]
    path = ran([TABLE, box, *balls], 4.0, contact, Accuracy.balanced(), force=push)
    a_box, a_ball, _ = PushedBox().accelerations
    wrong = [path.v[:, 1, :2] - np.outer(a_box * path.t, d), path.v[:, 2, :2] - np.outer(a_ball * path.t, d)]
    assert [event.kind for event in path.events] == ["face-contact"]
    assert sum(float((error**2).sum(axis=1).mean()) for error in wrong) < 1e-14  # SimBenchmark's measure
