"""Derivatives of what all kinds of sensors show, beside differences of runs."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import sensitivity
from modelgen.runtime.finite_differences import run_differences
from tests.sensitivity.test_closed_forms import built

SCENE = """
gravity = [0.0, 0.0, "-pull"]
[[body]]
name = "floor"
motion = "driven"
shape = { kind = "plane" }
path = { position = ["0.0", "0.0", "0.02*sin(7*t)"] }

[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.1, 0.08, 0.07] }
mass = "heavy"
inertia = [0.004, 0.0055, 0.006]
position = [0.0, 0.0, 0.09]
rpy = [0.2, 0.1, 0.0]
velocity = [0.3, 0.1, -0.8]
angular_velocity = [1.0, 2.0, 3.0]

[[contact]]
between = ["egg", "floor"]
friction = 0.3

[[input]]
name = "push"
default = 0.4

[[force]]
body = "egg"
force = ["push*cos(3*t)", "0.0", "0.0"]
JOINTS
"""
ARM = """
[[body]]
name = "arm"
mass = 0.7
inertia = [0.01, 0.02, 0.02]
position = [0.3, 0.0, 0.6]

[[joint]]
name = "elbow"
kind = "revolute"
between = ["world", "arm"]
position = [0.1, 0.0, 0.6]
rpy = ["pi/2", 0.0, 0.0]
LIMITS
"""
LIMITS = "limits = [-0.5, 0.5]\nrestitution = 0.6"
ROPE = """
[[joint]]
name = "string"
kind = "rope"
between = ["world", "egg"]
frames = [{ position = [0.0, 0.0, 0.6] }, { position = [0.0, 0.0, 0.0] }]
limits = ["none", 0.9]
"""
OF_POINT = ("acceleration", "proper_acceleration", "position", "velocity")
OF_EGG = (*OF_POINT, "angular_acceleration", "angular_velocity", "orientation")


def sensor(name: str, of: str, *keys: str) -> str:
    return "\n".join(["[[sensor]]", f'name = "{name}"', f'of = "{of}"', *keys, ""])


def sensors(with_arm: bool) -> str:
    shown = [sensor(f"egg{k}", f"egg.{quantity}") for k, quantity in enumerate(OF_EGG)]
    shown += [sensor(f"point{k}", f"egg.{q}", "point = [0.02, 0.01, -0.03]") for k, q in enumerate(OF_POINT)]
    shown += [sensor("seen", "egg.position", 'relative_to = "floor"', "point = [0.02, 0.01, -0.03]")]
    shown += [sensor(quantity, f"egg-floor.{quantity}") for quantity in ("gap", "force")]
    if with_arm:
        shown += [sensor(f"arm{q}", f"elbow.{q}") for q in ("coordinate", "rate", "force", "torque")]
    shown += ['[[sensor]]\nname = "mixed"\nvalue = "force*seen_x + sin(t)*push*point0_z + egg5_x**2"\n']
    return "\n".join(shown)


@pytest.mark.parametrize(
    "joints",
    [
        "",
        ARM.replace("LIMITS", ""),
        ARM.replace("LIMITS", LIMITS),
        ROPE,
        ARM.replace("LIMITS", LIMITS) + ROPE,
    ],
    ids=["free", "arm", "arm with limits", "rope", "arm with limits and rope"],
)
def test_sensors(joints: str) -> None:
    text = SCENE.replace("JOINTS", joints) + sensors("elbow" in joints)
    library = built(text, {"heavy": 1.3, "pull": 9.81})
    by, times = ["heavy", "pull", "push", "egg.velocity", "egg.orientation"], [0.01, 0.12, 0.4]
    found = sensitivity(library, times, by=by, accuracy="tight", estimate=False)
    expected, coarse = (
        run_differences(library, times, by=by, accuracy="tight", step=step) for step in (1e-4, 2e-4)
    )
    assert found.verdict
    resolved = np.abs(expected - coarse)
    size = np.max(np.abs(expected), axis=2, keepdims=True)
    assert np.mean(resolved < 1e-6 * size + 1e-9) > 0.9
    apart = np.abs(found.jacobian - expected)
    wrong = apart > 1e-7 * size + 10 * resolved + 1e-9
    assert not {found.of[i] for i in np.nonzero(wrong)[1]}
