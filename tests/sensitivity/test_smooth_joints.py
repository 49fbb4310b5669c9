"""Derivatives of runs over a smooth joint of two surfaces, at which the acceleration jumps."""

from __future__ import annotations

from math import hypot

import numpy as np
import pytest

from modelgen import sensitivity, simulate
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

RADIUS, STEP = 0.1, 1e-4
START, SLOPE = -0.2, -0.04  # of z = 0.1 x^2
N_X, N_Z = -SLOPE / hypot(SLOPE, 1.0), 1.0 / hypot(SLOPE, 1.0)

SCENE = f"""
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "left"
motion = "fixed"
shape = {{ kind = "chart", x = "u", y = "v", z = "0.1*u**2", domain = [[-1, 0], [-0.5, 0.5]] }}
[[body]]
name = "right"
motion = "fixed"
shape = {{ kind = "chart", x = "u", y = "v", z = "-0.2*u**2", domain = [[0, 1], [-0.5, 0.5]] }}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {RADIUS} }}
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = [{START + RADIUS * N_X}, 0.0, {0.1 * START**2 + RADIUS * N_Z}]
velocity = ["speed", 0.05, "{SLOPE}*speed"]
[[contact]]
between = ["ball", "left"]
LAW
[[contact]]
between = ["ball", "right"]
LAW
[[parameter]]
name = "speed"
value = 1.0
"""


@pytest.mark.parametrize("law", ["", "friction = 0.1"])
def test_a_ball_that_passes_a_joint(law: str) -> None:
    library = differentiable(read_text(SCENE.replace("LAW", law), "scene.toml"))
    found = sensitivity(library, 0.3, of=["ball.position", "ball.velocity"], by=["speed"], accuracy="tight")
    assert found.verdict
    runs = [
        simulate(library, until=0.3, accuracy="tight", samples=1, parameters={"speed": 1.0 + change})
        for change in (-STEP, STEP)
    ]
    assert all(run.is_trusted and "feature-change" in {e.kind for e in run.events} for run in runs)
    ends = [np.concatenate([run.p[-1, -1], run.v[-1, -1]]) for run in runs]
    assert np.allclose(found.jacobian[0].ravel(), (ends[1] - ends[0]) / (2 * STEP), rtol=1e-6, atol=1e-7)
