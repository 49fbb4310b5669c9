"""Slip that begins gently or dies in two directions, against series and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.scene import python_scenes as make
from tests.oracles.friction.gentle_slip import GentleSlip
from tests.oracles.friction.incline_slip import InclineSlip
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, times

PULLED = GentleSlip()
PULL = [{"body": "block", "force": ["2*t", "1.5*t**2", 0.0]}]
ACCURACIES = [(Accuracy.fast(), 1e-7), (Accuracy.balanced(), 1e-11), (Accuracy.tight(), 1e-13)]


@pytest.mark.parametrize(("accuracy", "off"), ACCURACIES)
@pytest.mark.parametrize("later", [1e-3, 0.04, 0.5])
def test_a_block_begins_to_slip_as_its_series(accuracy: Accuracy, off: float, later: float) -> None:
    # its centre of mass in the plane: the face is pressed alike all over, and it does not turn
    block = make.dynamic(
        "block", make.shape("box", size=[0.2, 0.2, 0.05], position=[0, 0, 0.025]),
        mass=1.0, inertia=[0.01, 0.01, 0.02],
    )  # fmt: skip
    end, contact = PULLED.begins + later, [{"between": ["block", "table"], "friction": 0.3}]
    path = ran([block, TABLE], end, contact, accuracy, samples=3, force=PULL)
    way, v = PULLED.at(end)
    assert times(path, "slip-start") == [pytest.approx(PULLED.begins, abs=1e-10)]
    assert path.p[-1, 0, :2] == pytest.approx(way, abs=off)
    assert path.v[-1, 0, :2] == pytest.approx(v, abs=off)
    assert path.patch_force[-1, 0] == pytest.approx(G, rel=1e-9)
    assert path.steps < 150


@pytest.mark.parametrize(
    ("angle", "mu", "slip"),
    [(0.3, 0.2, (1.0, 0.5)), (0.3, 0.12, (-0.5, 1.0)), (0.5, 0.2, (1.0, 1.0)), (0.2, 0.5, (-1.0, 0.2))],
)
def test_a_ball_thrown_across_an_incline_comes_to_roll(
    angle: float, mu: float, slip: tuple[float, float]
) -> None:
    v, s = np.array([1.0, 0.3]), np.array(slip)
    across = InclineSlip(angle, mu, v, s)
    spin = [(s[1] - v[1]) / 0.1, (v[0] - s[0]) / 0.1, 0.0]
    thrown = ball("ball", [0, 0, 0.1], velocity=[*v.tolist(), 0.0], angular_velocity=spin)
    gravity = [G * np.sin(angle), 0, -G * np.cos(angle)]
    contact = [{"between": ["ball", "table"], "friction": mu}]
    path = ran([thrown, TABLE], across.end + 0.1, contact, samples=1, gravity=gravity)
    way, after, _ = across.at(across.end + 0.1)
    assert times(path, "slip-stop") == [pytest.approx(across.end, abs=1e-9)]
    assert path.p[-1, 0, :2] == pytest.approx(way, abs=1e-12)
    assert path.v[-1, 0, :2] == pytest.approx(after, abs=1e-11)
    assert imbalance(path) < 1e-12
