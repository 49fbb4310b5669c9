"""Blows by driven bodies: path and motions of joints are those at the time of a blow, which changes."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import gradient
from modelgen.codegen.library import Library
from modelgen.runtime.sensitivity_directions import directions_of
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable
from tests.sensitivity.pairs import Pairs

EGG = """
[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.1, 0.08, 0.07] }
mass = 2.0
inertia = [0.008, 0.009, 0.01]
position = [0.0, 0.0, 0.3]
velocity = [0.3, 0.1, -0.5]
angular_velocity = [1.0, 2.0, 3.0]

[[parameter]]
name = "bounce"
value = 0.7
"""


def on_plate(seed: int) -> str:
    """An egg falls on a plate that rises, sinks and tilts."""
    rng = np.random.default_rng(seed)
    amplitude, frequency = rng.uniform(0.01, 0.05, 3), rng.uniform(2, 12, 3)
    swings = [f"{a:.4f}*sin({w:.4f}*t)" for a, w in zip(amplitude, frequency, strict=True)]
    return f"""{EGG}
[[body]]
name = "plate"
motion = "driven"
shape = {{ kind = "plane" }}
path = {{ position = ["0.0", "0.0", "{swings[0]}"], rotation_vector = ["{swings[1]}", "{swings[2]}", "0.0"] }}

[[contact]]
between = ["egg", "plate"]
restitution = "bounce"
friction = {rng.uniform(0.05, 0.5):.4f}
"""


def on_swinging_arm(seed: int) -> str:
    """An egg swings between stops at the end of an arm whose angle is prescribed."""
    rng = np.random.default_rng(seed)
    return f"""{EGG}
[[body]]
name = "arm"
mass = 1.0
inertia = [0.01, 0.02, 0.02]
position = [-0.3, 0.0, 0.3]

[[joint]]
name = "motor"
kind = "revolute"
between = ["world", "arm"]
position = [-0.5, 0.0, 0.3]
rpy = ["pi/2", 0.0, 0.0]
motion = "0.7*sin({rng.uniform(3, 6):.4f}*t)*exp(0.3*t)"

[[joint]]
name = "elbow"
kind = "revolute"
between = ["arm", "egg"]
position = [-0.1, 0.0, 0.3]
rpy = ["pi/2", {rng.uniform(-0.2, 0.2):.4f}, 0.0]
limits = [-0.5, 0.5]
restitution = "bounce"
"""


def checked(library: Library, times: list[float]) -> None:
    pairs = Pairs(library, times)
    by = ["bounce", "egg.velocity", "egg.angular_velocity"]
    found = [
        pair for direction in directions_of(library.manifest.instance, by) for pair in pairs.of(direction)
    ]
    assert all(pair.verdict for pair in found)
    assert not [pair for pair in found if pair.outcome in ("off", "wrong")]
    assert sum(pair.outcome == "agrees" for pair in found) > len(found) / 2
    values = ca.MX.sym("values", 1, 6)
    loss = ca.Function("loss", [values], [ca.sumsqr(values)])
    slope = gradient(library, [times[-1]], loss, of=["egg.position", "egg.velocity"], by=by, accuracy="tight")
    assert slope.forward_difference < 1e-11


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(4))
def test_blows_of_a_plate(seed: int) -> None:
    checked(differentiable(read_text(on_plate(seed), "plate.toml")), [0.3, 0.5])


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(4))
def test_blows_at_the_stops_of_a_driven_arm(seed: int) -> None:
    checked(differentiable(read_text(on_swinging_arm(seed), "arm.toml")), [0.2, 0.4])
