"""Slip of a foot on rails in a plane: they hold it across, so that friction never turns it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from modelgen import simulate
from modelgen.runtime.accuracy import Accuracy
from modelgen.scene.read import read_text
from tests.running import library_of

FOOT, CART, G, MU = 2.0, 1.0, 9.81, 0.5  # kg, kg, m/s^2
SWING, BELOW, RATE = 0.01, 0.005, 10.0  # the push is MU N (1 - BELOW + SWING sin(RATE t))
PUSH = MU * FOOT * G
SCENE = f"""
gravity = [0.0, 0.0, {-G}]
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "cart"
position = [0.0, 0.0, 0.1]
mass = {CART}
inertia = [0.01, 0.01, 0.01]
[[body]]
name = "foot"
position = [0.0, 0.0, 0.1]
mass = {FOOT}
inertia = [0.01, 0.01, 0.01]
shape = {{ kind = "sphere", radius = 0.1 }}
[[joint]]
name = "along"
kind = "prismatic"
between = ["world", "cart"]
rpy = [0.0, {np.pi / 2}, 0.0]
[[joint]]
name = "up"
kind = "prismatic"
between = ["cart", "foot"]
[[force]]
body = "foot"
force = ["{PUSH}*(1 - {BELOW} + {SWING}*sin({RATE}*t))", 0.0, 0.0]
[[contact]]
between = ["floor", "foot"]
friction = {MU}
"""


def speed(t: float, start: float) -> float:
    """m/s, of slip that starts at a time."""
    gained = SWING * (np.cos(RATE * start) - np.cos(RATE * t)) / RATE - BELOW * (t - start)
    return float(PUSH * gained / (FOOT + CART))


@pytest.mark.parametrize(
    "accuracy", [Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()], ids=lambda each: each.name
)
def test_slip_that_rails_hold_across_starts_and_stops_in_few_steps(accuracy: Accuracy) -> None:
    path = simulate(library_of(read_text(SCENE, "foot.toml")), until=0.5, samples=1, accuracy=accuracy)
    assert [event.kind for event in path.events] == ["slip-start", "slip-stop"]
    start = np.arcsin(BELOW / SWING) / RATE
    stop = brentq(lambda t: speed(t, start), start + 0.1, start + 0.4)
    assert abs(path.events[0].t - start) < 1e-6
    assert abs(path.events[1].t - stop) < 1e-4
    assert path.rhs_evals < 600
