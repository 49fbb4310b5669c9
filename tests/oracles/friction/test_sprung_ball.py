"""A sprung ball that rolls and slips in turn along a line, in closed form; and the orders of accuracy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.friction.sprung_ball import SprungBall
from tests.oracles.pieces import TABLE, ball, imbalance, ran

TIGHT = Accuracy.tight()
END = 1.5
SPRING = [{"between": ["ball", "table"], "anchors": [[0, 0, 0], [0, 0, 0.1]], "stiffness": 40.0}]


def swung(start: float, accuracy: Accuracy = TIGHT) -> Trajectory:
    contact = [{"between": ["ball", "table"], "friction": 0.2}]
    bodies = [ball("ball", [start, 0, 0.1]), TABLE]
    return ran(bodies, END, contact, accuracy, samples=1, spring=SPRING)


def error(start: float, accuracy: Accuracy) -> float:
    x, v, _ = SprungBall(start).run(END)
    path = swung(start, accuracy)
    return abs(path.p[-1, 0, 0] - x) + abs(path.v[-1, 0, 0] - v)


@pytest.mark.parametrize("start", [0.18, 0.25, 0.5, 1.0])
def test_a_sprung_ball_rolls_slips_and_turns_round_as_in_closed_form(start: float) -> None:
    x, v, events = SprungBall(start).run(END)
    path = swung(start)
    assert [e.kind for e in path.events] == [kind for kind, _ in events] != []
    assert [e.t for e in path.events] == pytest.approx([t for _, t in events], abs=1e-11)
    assert path.p[-1, 0, 0] == pytest.approx(x, abs=1e-12)
    assert path.v[-1, 0, 0] == pytest.approx(v, abs=1e-11)
    assert imbalance(path) < 1e-13


def test_runge_kutta_keeps_order_four_through_stick_and_slip() -> None:
    steps = END / np.array([60, 100, 160, 250, 400])
    errors = [error(0.25, TIGHT.fixed_step(float(h))) for h in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4, abs=0.4)


def test_dormand_and_prince_keep_order_eight_through_stick_and_slip() -> None:
    tolerances = 10.0 ** -np.arange(4, 12)
    counts = [swung(0.25, replace(TIGHT, tolerance=float(tol))).steps for tol in tolerances]
    errors = [error(0.25, replace(TIGHT, tolerance=float(tol))) for tol in tolerances]
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] < -7.5


def test_slip_that_turns_while_it_dies_costs_no_digits_but_a_fixed_step_its_order() -> None:
    egg = make.dynamic(
        "egg", make.ellipsoid(0.1, 0.07, 0.05), density=1000.0, position=[0, 0, 0.05],
        velocity=[1.0, 0.3, 0.0], angular_velocity=[0, 0, 10.0],
    )  # fmt: skip

    def end(accuracy: Accuracy) -> np.ndarray:
        contact = [{"between": ["egg", "table"], "friction": 0.3}]
        return ran([egg, TABLE], 0.6, contact, accuracy, samples=1).p[-1, 0]

    exact = end(replace(TIGHT, tolerance=1e-16, slip_speed=1e-8))
    tolerances = 10.0 ** -np.arange(5, 14)
    errors = [np.abs(end(replace(TIGHT, tolerance=float(tol))) - exact).max() for tol in tolerances]
    assert (np.array(errors) < 100 * tolerances).all()
    steps = 0.6 / np.array([60, 100, 160, 250, 400, 640, 1000])
    errors = [np.abs(end(TIGHT.fixed_step(float(h))) - exact).max() for h in steps]
    assert 1.3 < np.polyfit(np.log(steps), np.log(errors), 1)[0] < 2.5
