"""Contacts whose forces a joint could hold as well: they push, from the first sample on."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.scene.read import read_text
from tests.running import library_of

CAM_AND_ROLLER = """
[[body]]
name = "cam"
motion = "driven"
shape = {{ kind = "extrusion", x = "0.04*cos(t)", y = "0.025*sin(t)", domain = [0, "2*pi"], length = 0.02 }}
path = {{ rotation_vector = ["0", "0", "2*pi*t"] }}

[[body]]
name = "roller"
shape = {{ kind = "cylinder", radius = 0.01, length = 0.02 }}
density = 7800
position = [0.0, 0.035, 0.0]

[[contact]]
between = ["roller", "cam"]
friction = {friction}

[[joint]]
name = "slide"
kind = "prismatic"
between = ["world", "roller"]
position = [0.0, {height}, 0.0]
axis_angle = {{ axis = [1.0, 0.0, 0.0], angle = "-pi/2" }}
"""
WEIGHT = 0.0356890624665  # N, that the cam's acceleration needs at first


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize(
    "height", [pytest.param(0.0, marks=pytest.mark.slow), 0.035, pytest.param(0.2, marks=pytest.mark.slow)]
)
def test_the_rims_of_a_roller_on_a_slide_push_from_the_first_sample_on(
    height: float, friction: float
) -> None:
    scene = read_text(CAM_AND_ROLLER.format(height=height, friction=friction), "cam.toml")
    path = simulate(library_of(scene), until=0.03, samples=20)
    assert path.force.min() >= 0
    assert path.force[0].sum() == pytest.approx(WEIGHT, rel=1e-11)
    assert np.abs(np.diff(path.force.sum(axis=1))).max() < 1e-3
    assert path.complementarity_max < 1e-13
