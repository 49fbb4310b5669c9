"""Faces of a body that joints hold, on a driven table: where sticking would pull a joint apart, they slip."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.scene.read import read_text
from tests.running import library_of

MU, G, MASS = 0.3, 10.0, 0.006
SHOE = f"""
gravity = [0.0, 0.0, -{G}]
[[body]]
name = "table"
motion = "driven"
shape = {{ kind = "plane" }}
path = {{ PATH }}
[[body]]
name = "shoe"
shape = {{ kind = "box", size = [0.03, 0.02, 0.01] }}
mass = {MASS}
inertia = [2.5e-7, 5e-7, 6.5e-7]
position = [0.0, 0.0, 0.005]
[[joint]]
name = "guide"
kind = "prismatic"
between = ["world", "shoe"]
[[sensor]]
name = "pull"
of = "guide.force"
[[sensor]]
name = "twist"
of = "guide.torque"
[[contact]]
between = ["shoe", "table"]
friction = {MU}
"""
TO_AND_FRO = 'position = ["0.02*(1-cos(2*pi*t))", "0.01*(1-cos(2*pi*t))", 0.0]'
ROUND = 'rotation_vector = [0.0, 0.0, "1-cos(2*pi*t)"]'


@pytest.mark.parametrize("path", [TO_AND_FRO, ROUND])
def test_what_a_joint_holds_slips_on_a_table_that_starts_from_rest(path: str) -> None:
    """The guide leaves the shoe free along the vertical only. It bears the whole friction: where the table
    shifts, mu times the weight against its velocity, which reverses after half a second."""
    scene = read_text(SHOE.replace("PATH", path), "shoe.toml")
    run = simulate(library_of(scene), until=0.9, samples=9)
    assert run.doubts == ()
    assert np.abs(run.p[:, 1] - [0.0, 0.0, 0.005]).max() < 1e-9
    assert [event.kind for event in run.events if event.kind.startswith("slip")][-1] == "slip-reversal"
    pull, twist = (run.sensors[:, k : k + 3] for k in (0, 3))
    if path == TO_AND_FRO:
        friction = MU * MASS * G * np.array([2.0, 1.0, 0.0]) / np.hypot(2.0, 1.0)
        assert pull[2] == pytest.approx(-friction, abs=1e-8)
        assert pull[7] == pytest.approx(friction, abs=1e-8)
    else:
        assert twist[2, 2] == pytest.approx(-twist[7, 2], rel=1e-6) != 0
