"""Parameters: a library with other values runs as a scene with these numbers does, bit for bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from modelgen import require, simulate
from modelgen.codegen.library import Library
from modelgen.codegen.parameter_values import library_with
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

GROUND = """
[[body]]
name = "ground"
motion = "fixed"
shape = { kind = "plane" }
"""
EGG = (
    GROUND
    + """
[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.12, 0.09, 0.07] }
mass = 1.2
inertia = [0.00312, 0.004632, 0.0054]
center_of_mass = [0.001, 0.0, 0.002]
position = [0.01, 0.02, 0.08]
rpy = [0.1, 0.2, 0.3]
velocity = [0.1, 0.0, 0.0]
angular_velocity = [-1.9, 1.3, 2.3]

[[contact]]
between = ["egg", "ground"]
friction = { static = 0.4, kinetic = 0.3 }
restitution = 0.35
rolling_resistance = 0.001
spinning_resistance = 0.0005

[[force]]
body = "egg"
force = ["0.1*cos(t)", "0.0", "0.0"]
point = [0.01, 0.02, 0.03]

[[spring]]
between = ["egg", "ground"]
anchors = [[0.0, 0.01, 0.02], [0.3, 0.0, 0.4]]
stiffness = 12.5
damping = 0.15
rest_length = 0.33
"""
)
DENSE = (
    GROUND
    + """
[[body]]
name = "block"
shape = [
  { kind = "box", size = [0.21, 0.11, 0.06] },
  { kind = "superellipsoid", semi_axes = [0.031, 0.032, 0.033], exponents = [2.5, 3.0] },
  { kind = "sphere", radius = 0.02, position = [0.02, 0.0, 0.041] },
]
density = 800.0
position = [0.0, 0.0, 0.09]
rpy = [0.15, 0.05, 0.0]

[[contact]]
between = ["block/box", "ground"]
friction = 0.31
"""
)
SMOOTH = (
    GROUND
    + """
[[body]]
name = "tumbler"
density = 700.0
position = [0.0, 0.0, 0.07]
rpy = [0.3, 0.0, 0.0]

[body.shape]
kind = "revolution"
points = [[0.0, -0.05], [0.03, -0.04], [0.047, -0.012], [0.045, 0.013], [0.021, 0.043], [0.0, 0.051]]

[[contact]]
between = ["tumbler", "ground"]
friction = 0.32
"""
)
PLATE = (
    GROUND
    + """
[[body]]
name = "bowl"
motion = "fixed"
position = [0.0, 0.0, 0.53]

[body.shape]
kind = "chart"
x = "a*cos(u)*sin(v)"
y = "a*sin(u)*sin(v)"
z = "-a*cos(v)"
domain = [["-pi", "pi"], [0.0, 1.4]]
periodic = [true, false]
poles = ["v_min"]
parameters = { a = 0.52 }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.041 }
density = 900.0
position = [0.13, 0.01, 0.12]

[[contact]]
between = ["ball", "bowl"]
"""
)
ARM = """
[[body]]
name = "arm"
mass = 0.71
inertia = [0.01, 0.02, 0.03]
position = [0.22, 0.0, 0.0]

[[body]]
name = "hand"
mass = 0.22
inertia = [0.001, 0.002, 0.003]
position = [0.52, 0.0, 0.0]

[[joint]]
kind = "revolute"
name = "shoulder"
between = ["world", "arm"]
position = [0.013, 0.0, 0.0]
rpy = ["pi/2", 0.0, 0.0]
stiffness = 1.51
damping = 0.017
rest = 0.19
limits = [-0.4, 0.45]
restitution = 0.55

[[joint]]
kind = "screw"
name = "wrist"
between = ["arm", "hand"]
position = [0.4, 0.0, 0.0]
lead = 0.023
"""

# Scene, the number as it stands there, another value for it. Where it stands several times: which of them.
NUMBERS: Mapping[str, tuple[str, str, str, float]] = {
    "mass": (EGG, "mass = 1.2", "1.2", 1.37),
    "inertia": (EGG, "inertia = [0.00312, 0.004632, 0.0054]", "0.00312", 0.0034),
    "center_of_mass": (EGG, "center_of_mass = [0.001, 0.0, 0.002]", "0.002", -0.003),
    "static friction": (EGG, "static = 0.4", "0.4", 0.55),
    "kinetic friction": (EGG, "kinetic = 0.3", "0.3", 0.2),
    "restitution": (EGG, "restitution = 0.35", "0.35", 0.61),
    "rolling resistance": (EGG, "rolling_resistance = 0.001", "0.001", 0.002),
    "spinning resistance": (EGG, "spinning_resistance = 0.0005", "0.0005", 0.001),
    "semi-axis": (EGG, "semi_axes = [0.12, 0.09, 0.07]", "0.09", 0.085),
    "position": (EGG, "position = [0.01, 0.02, 0.08]", "0.08", 0.09),
    "orientation": (EGG, "rpy = [0.1, 0.2, 0.3]", "0.2", 0.25),
    "velocity": (EGG, "velocity = [0.1, 0.0, 0.0]", "0.1", -0.2),
    "angular velocity": (EGG, "angular_velocity = [-1.9, 1.3, 2.3]", "1.3", 1.7),
    "load point": (EGG, "point = [0.01, 0.02, 0.03]", "0.02", 0.05),
    "spring anchor": (EGG, "anchors = [[0.0, 0.01, 0.02], [0.3, 0.0, 0.4]]", "0.4", 0.5),
    "stiffness": (EGG, "stiffness = 12.5", "12.5", 22.0),
    "damping": (EGG, "damping = 0.15", "0.15", 0.05),
    "rest length": (EGG, "rest_length = 0.33", "0.33", 0.2),
    "gravity": (EGG, "gravity = [0.0, 0.0, -9.81]", "-9.81", -1.62),
    "end of the run": (EGG, "until = 0.3", "0.3", 0.25),
    "density": (DENSE, "density = 800.0", "800.0", 950.0),
    "size of a box": (DENSE, "size = [0.21, 0.11, 0.06]", "0.11", 0.13),
    "semi-axis of a quadrature": (DENSE, "semi_axes = [0.031, 0.032, 0.033]", "0.032", 0.035),
    "exponent": (DENSE, "exponents = [2.5, 3.0]", "2.5", 2.75),
    "position of a shape": (DENSE, "position = [0.02, 0.0, 0.041]", "0.041", 0.045),
    "friction": (DENSE, "friction = 0.31", "0.31", 0.21),
    "point of a profile": (SMOOTH, "[0.047, -0.012]", "0.047", 0.049),
    "radius": (PLATE, "radius = 0.041", "0.041", 0.036),
    "number of a chart": (PLATE, "a = 0.52", "0.52", 0.515),
    "position of a fixed body": (PLATE, "position = [0.0, 0.0, 0.53]", "0.53", 0.525),
    "frame of a joint": (ARM, "position = [0.013, 0.0, 0.0]", "0.013", -0.02),
    "turn of a joint": (ARM, 'rpy = ["pi/2", 0.0, 0.0]', '"pi/2"', 1.5),
    "joint stiffness": (ARM, "stiffness = 1.51", "1.51", 2.2),
    "joint damping": (ARM, "damping = 0.017", "0.017", 0.03),
    "joint rest": (ARM, "rest = 0.19", "0.19", -0.1),
    "joint limit": (ARM, "limits = [-0.4, 0.45]", "-0.4", -0.3),
    "joint restitution": (ARM, "restitution = 0.55", "0.55", 0.2),
    "lead": (ARM, "lead = 0.023", "0.023", 0.04),
}


def with_parameter(case: str, value: float | None = None) -> str:
    """The scene of a case whose number is a parameter, with another value and the same nominal one."""
    text, line, number, _ = NUMBERS[case]
    text = f"gravity = [0.0, 0.0, -9.81]\n[run]\nuntil = 0.3\nsamples = 20\n{text}"
    assert text.count(line) == 1
    assert line.count(number) == 1
    text = text.replace(line, line.replace(number, '"number"'))
    given = number if value is None else repr(value)
    return f'{text}\n[[parameter]]\nname = "number"\nvalue = {given}\nnominal = {number}\n'


def built(text: str) -> Library:
    return library_of(read_text(text, "scene.toml"))


def numbers_of(library: Library) -> dict[str, Any]:
    """The instance without the scene's tables and the values of its parameters."""
    return {k: v for k, v in library.manifest.instance.items() if k not in ("origin", "parameters")}


def assert_equal_runs(one: Trajectory, other: Trajectory) -> None:
    for field in fields(one):
        mine, its = getattr(one, field.name), getattr(other, field.name)
        if field.name not in ("wall_s", "estimate"):
            same = np.array_equal(mine, its, equal_nan=True) if isinstance(mine, np.ndarray) else mine == its
            assert same, field.name


@pytest.mark.parametrize("case", NUMBERS)
def test_a_run_with_another_value_is_that_of_a_scene_with_that_number(case: str) -> None:
    value = NUMBERS[case][-1]
    base, other = built(with_parameter(case)), built(with_parameter(case, value))
    assert numbers_of(library_with(base, {"number": value})) == numbers_of(other) != numbers_of(base)
    run = simulate(base, parameters={"number": value})
    assert_equal_runs(run, simulate(other))
    assert run.parameters == {"number": value}


@pytest.mark.parametrize("case", ["mass", "semi-axis", "gravity", "frame of a joint"])
def test_the_scales_are_those_of_the_nominal_values(case: str) -> None:
    plain = with_parameter(case).replace("nominal", "minimum").rpartition("minimum")[0]
    value = NUMBERS[case][-1]
    nominal = require(read_text(plain, "scene.toml")).scales
    assert require(read_text(with_parameter(case, value), "scene.toml")).scales == nominal
    assert library_with(built(plain), {"number": value}).manifest.instance["scales"] == {
        "length": nominal.length, "mass": nominal.mass, "time": nominal.time
    }  # fmt: skip
