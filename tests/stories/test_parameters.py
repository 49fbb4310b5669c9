"""Parameters: a library with other values runs as a scene with these numbers does, bit for bit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modelgen import (
    build,
    derive,
    emit,
    normal_rates,
    record_of,
    require,
    simulate,
    simulate_batch,
    start_many,
    sweep,
)
from modelgen.benchmark.unit_conversion import Units, in_units
from modelgen.codegen.library import Library
from modelgen.codegen.library_with_parameters import library_with
from modelgen.errors import ModelgenError, SceneError, SimulationError
from modelgen.runtime.stepped_simulation import start
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.python_scenes import dynamic, fixed, plane, sphere
from modelgen.scene.python_scenes import scene as python_scene
from modelgen.scene.read import read_text
from modelgen.scene.scene_from_tables import with_form
from tests.running import library_of, scene_of

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
cavity = true
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
BLOWN = (
    EGG
    + """
[[input]]
name = "wind"
default = 0.57
minimum = 0.41
maximum = 0.83

[[force]]
body = "egg"
force = ["wind*t", 0, 0]
"""
)
DRIVEN = BLOWN.replace('name = "wind"', 'name = "wind"\nhold = "linear"')

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
    "tolerance": ("tolerance = 1e-9\n" + EGG, "tolerance = 1e-9", "1e-9", 1e-6),
    "step": ('method = "rk4"\nstep = 0.001\n' + EGG, "step = 0.001", "0.001", 0.002),
    "step of time-stepping": (
        'method = "time-stepping"\nstep = 0.001\n' + EGG, "step = 0.001", "0.001", 0.002
    ),
    "imaginary edge": ("imaginary_edge = 0.02\n" + DENSE, "imaginary_edge = 0.02", "0.02", 0.3),
    "input": (BLOWN, "default = 0.57", "0.57", 0.77),
    "input on a line": (DRIVEN, "default = 0.57", "0.57", 0.77),
    "range of an input": (BLOWN, "maximum = 0.83", "0.83", 0.62),
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
}  # fmt: skip


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


def assert_lanes_are_runs_of(base: Library, other: Library, value: float) -> None:
    """Of two lanes of the base, the second with the number of the other: states and events on the way."""
    (own,) = (each["value"] for each in base.manifest.instance["parameters"])
    many, alone = start_many(base, 2, parameters={"number": [own, value]}), [start(base), start(other)]
    for _ in range(3):
        many.step(0.1)
        for lane, sim in enumerate(alone):
            assert tuple(many.events(lane)) == sim.step(until=float(many.t[lane]))
            assert np.array_equal(many.state[lane], sim.state)


@pytest.mark.cases(8)
@pytest.mark.parametrize("case", NUMBERS)
def test_a_run_with_another_value_is_that_of_a_scene_with_that_number(case: str) -> None:
    value = NUMBERS[case][-1]
    base, other = built(with_parameter(case)), built(with_parameter(case, value))
    assert numbers_of(library_with(base, {"number": value})) == numbers_of(other) != numbers_of(base)
    run = simulate(base, parameters={"number": value})
    assert_equal_runs(run, simulate(other))
    assert run.parameters == {"number": value}
    assert_lanes_are_runs_of(base, other, value)


def test_expressions_of_a_shape_follow_parameters() -> None:
    """Also by way of a constant; the shape then has a parameter of that name."""
    text = PLATE.replace("parameters = { a = 0.52 }\n", "")
    text = "[constants]\na = 'number/2'\n[run]\nuntil = 0.3\n" + text
    one, two = (
        built(f'{text}[[parameter]]\nname = "number"\nvalue = {value}\nnominal = 1.04\n')
        for value in (1.04, 1.03)
    )
    assert one.manifest.kinds == built(f"[run]\nuntil = 0.3\n{PLATE}").manifest.kinds
    assert_equal_runs(simulate(one, parameters={"number": 1.03}), simulate(two))


@pytest.mark.parametrize(
    ("text", "line", "values"),
    [
        (PLATE, "position = [0.0, 0.0, 0.53]", (0.0, 0.53)),  # of a fixed body: at the world's frame or not
        (EGG, "center_of_mass = [0.001, 0.0, 0.002]", (0.0, 0.002)),  # at the shape's frame or not
    ],
)
def test_places_that_follow_from_a_parameter_go_through_zero(
    text: str, line: str, values: tuple[float, float]
) -> None:
    text = "[run]\nuntil = 0.02\n" + text.replace(line, line.rpartition("[")[0] + '[0.0, 0.0, "number"]')
    for own, other in (values, values[::-1]):
        one, two = (
            built(f'{text}[[parameter]]\nname = "number"\nvalue = {value}\nnominal = 0.1\n')
            for value in (own, other)
        )
        assert numbers_of(library_with(one, {"number": other})) == numbers_of(two)
        assert one.manifest.kinds == two.manifest.kinds


def test_the_default_of_an_input_follows_a_parameter() -> None:
    text = GROUND + BALL + '[[input]]\nname = "wind"\ndefault = "5*a"\n' + FORCE.replace("FACTOR", "wind")
    one, two = (built(with_table(text, 'name = "a"', f"value = {a}", "nominal = 0.1")) for a in (0.1, 0.12))
    assert_equal_runs(simulate(one, until=0.2, parameters={"a": 0.12}), simulate(two, until=0.2))


def with_table(text: str, *lines: str) -> str:
    """A scene with one parameter."""
    return "\n".join((text, "[[parameter]]", *lines, ""))


BALL = """
[[body]]
name = "ball"
shape = { kind = "sphere", radius = "a" }
density = 1000.0
position = [0.0, 0.0, 0.3]
[[contact]]
between = ["ball", "ground"]
"""
FORCE = """
[[force]]
body = "ball"
force = ["FACTOR*t", 0, 0]
"""
A = ('name = "a"', "value = 0.1")
MISTAKES: Mapping[str, tuple[str, list[str]]] = {
    "unused": (
        with_table(GROUND + BALL, *A, "[[parameter]]", 'name = "b"', "value = 1"),
        ["'b'", "nothing uses"],
    ),
    "used in an unused constant": (
        with_table("[constants]\nc = 'b'\n" + GROUND + BALL, *A, "[[parameter]]", 'name = "b"', "value = 1"),
        ["parameter[1]", "'b'", "nothing uses"],
    ),
    "unknown": (with_table(GROUND + BALL, 'name = "ab"', "value = 1"), ["'a'", "did you mean 'ab'?"]),
    "twice": (with_table(GROUND + BALL, *A, "[[parameter]]", *A), ["parameter[1].name", "another parameter"]),
    "the name of a constant": (
        with_table("[constants]\na = 1.0\n" + GROUND + BALL, *A),
        ["the name 'a'", "a constant"],
    ),
    "the name of a variable": (with_table(GROUND + BALL, 'name = "vx"', "value = 1"), ["'vx'", "but not t"]),
    "of a parameter": (
        with_table(GROUND + BALL, 'name = "a"', 'value = "b/2"', "[[parameter]]", 'name = "b"', "value = 1"),
        ["parameter[0].value", "unknown name 'b'"],
    ),
    "a constant in a ring": (
        with_table("[constants]\nb = 'a + c'\nc = 'b'\n" + GROUND + BALL, *A),
        ["b -> c -> b"],
    ),
    "below its minimum": (
        with_table(GROUND + BALL, *A, "minimum = 0.2"),
        ["parameter[0].value", "0.1", "at least 0.2"],
    ),
    "nominal above its maximum": (
        with_table(GROUND + BALL, *A, "nominal = 3", "maximum = 0.2"),
        ["parameter[0].nominal", "at most 0.2"],
    ),
    "an empty range": (with_table(GROUND + BALL, *A, "minimum = 1", "maximum = 0"), ["minimum 1, maximum 0"]),
    "no value": (with_table(GROUND + BALL, 'name = "a"'), ["'value' is missing"]),
    "a nominal value that is no scene": (
        with_table(GROUND + BALL, *A, "nominal = -1"),
        ["shape.radius", "at the nominal values of the parameters", "positive"],
    ),
    "folded": (with_table("fold = true\n" + GROUND + BALL, *A), ["fold", "remove fold"]),
    "a count": (
        with_table(GROUND + BALL + '[[pattern]]\nof = "ball"\ncount = "40*a"\n', *A),
        ["pattern[0].count", "follows from a parameter"],
    ),
    "in an expression of t": (
        with_table(GROUND + BALL + FORCE.replace("FACTOR", "a"), *A),
        ["force[0].force[0]", "the parameter 'a' in an expression of t x", '[[input]] with default = "a"'],
    ),
    "a constant of it in an expression of t": (
        with_table("[constants]\nb = '2*a'\n" + GROUND + BALL + FORCE.replace("FACTOR", "b"), *A),
        ["force[0].force[0]", "the parameter 'a' in an expression of t x"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", MISTAKES)
def test_a_mistake_in_the_scene_is_named_with_its_place(case: str) -> None:
    text, told = MISTAKES[case]
    with pytest.raises(SceneError) as refused:
        read_text(text, "scene.toml")
    assert not [part for part in told if part not in str(refused.value)], str(refused.value)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"b": 1.0}, ["no parameter 'b'", "known: a"]),
        ({"A": 1.0}, ["no parameter 'A'"]),
        ({"a": 0.001}, ["parameters: a", "0.001", "at least 0.01"]),
        ({"a": float("nan")}, ["parameters: a", "nan"]),
        ({"a": float("inf")}, ["parameters: a", "inf"]),
        ({"a": "0.1"}, ["parameters: a", "a number is allowed"]),
        ({"a": True}, ["parameters: a", "a number is allowed"]),
        ([0.1], ["parameters", "a list", "parameters={"]),
    ],
)
def test_a_wrong_value_is_named(values: Any, told: list[str]) -> None:
    with pytest.raises(SimulationError) as refused:
        simulate(built(with_table(GROUND + BALL, *A, "minimum = 0.01")), parameters=values)
    assert not [part for part in told if part not in str(refused.value)], str(refused.value)


def test_a_value_that_the_scene_refuses_is_told_with_its_place() -> None:
    library = built(with_table(GROUND + BALL, *A))
    with pytest.raises(SimulationError, match=r"a = -1: refused by scene.toml: body\[1\].shape.radius"):
        simulate(library, parameters={"a": -1.0})


def test_a_scene_without_parameters_says_that_it_has_none() -> None:
    with pytest.raises(SimulationError, match=r"no parameter 'a'; known: none"):
        simulate(scene_of("bouncing_ball"), parameters={"a": 1.0})


@pytest.mark.parametrize(
    ("case", "value", "told"),
    [
        ("friction", 0.0, ["number = 0", "kinds of contact", "built at number = 0.31"]),
        ("size of a box", -1.0, ["refused by"]),
        ("inertia", 0.004632, None),
        ("joint stiffness", 0.0, ["refused by"]),
        ("semi-axis", 0.07, None),
    ],
)
def test_another_structure_is_refused(case: str, value: float, told: list[str] | None) -> None:
    library = built(with_parameter(case))
    if told is None:
        assert simulate(library, until=0.01, parameters={"number": value}).parameters == {"number": value}
        return
    with pytest.raises(SimulationError) as refused:
        simulate(library, parameters={"number": value})
    assert not [part for part in told if part not in str(refused.value)], str(refused.value)


def test_of_several_parameters_those_that_change_the_structure_are_named() -> None:
    egg = EGG.replace("mass = 1.2", 'mass = "m"').replace("[0.00312, 0.004632, 0.0054]", '["Ix", "Iy", "Iz"]')
    tables = [("m", 1.2), ("Ix", 0.003), ("Iy", 0.004), ("Iz", 0.005)]
    text = egg + "".join(f'[[parameter]]\nname = "{name}"\nvalue = {value}\n' for name, value in tables)
    library = built(text)
    simulate(library, until=0.01, parameters={"m": 1.3, "Ix": 0.004})
    with pytest.raises(SimulationError) as refused:
        simulate(library, parameters={"m": 1.3, "Ix": 0.004, "Iz": 0.004})
    told = str(refused.value)
    assert "free_isotropic_loaded in place of free_diagonal_loaded" in told
    assert "parameters: Ix = 0.004, Iz = 0.004: another structure" in told


def test_a_library_that_was_loaded_and_one_with_values_take_values_too(tmp_path: Path) -> None:
    text = with_parameter("mass") + '[[parameter]]\nname = "rest"\nvalue = 0.33\n'
    scene = read_text(text.replace("rest_length = 0.33", 'rest_length = "rest"'), "scene.toml")
    build(emit(derive(require(scene))), folder=tmp_path, level="O1")
    library = Library.load(tmp_path)
    both = library_with(library, {"number": 1.4, "rest": 0.25})
    chained = library_with(library_with(library, {"number": 1.4}), {"rest": 0.25})
    assert both.manifest.instance == chained.manifest.instance != library.manifest.instance
    assert library_with(library, {"rest": 0.25, "number": 1.4}) is both
    assert library_with(library, {"rest": 0.33}) is library
    assert_equal_runs(simulate(both), simulate(library, parameters={"rest": 0.25, "number": 1.4}))


def test_a_scene_that_was_changed_after_reading_takes_no_values() -> None:
    scene = read_text(with_table(GROUND + BALL, *A), "scene.toml")
    library = library_of(replace(scene, gravity=(0.0, 0.0, -1.0)))
    simulate(library, until=0.01)
    with pytest.raises(SimulationError, match="changed after it was read"):
        simulate(library, parameters={"a": 0.2})


def test_a_forced_form_is_kept() -> None:
    scene = read_text(with_parameter("semi-axis"), "scene.toml")
    forced = with_form(scene, "block")
    library = library_of(forced)
    assert library.manifest.kinds["contact"][0]["form"] == "block"
    assert library_with(library, {"number": 0.08}).manifest.kinds == library.manifest.kinds
    other = library_of(with_form(read_text(with_parameter("semi-axis", 0.08), "scene.toml"), "block"))
    assert_equal_runs(simulate(library, parameters={"number": 0.08}), simulate(other))


def test_parameters_of_a_scene_in_python() -> None:
    tables = {
        "body": [
            {"name": "ground", "motion": "fixed", "shape": {"kind": "plane"}},
            {
                "name": "ball",
                "shape": {"kind": "sphere", "radius": "a"},
                "density": 900.0,
                "position": (0, 0, "3*a"),
            },
        ],
        "contact": [{"between": ("ball", "ground"), "restitution": 0.5}],
    }
    one, two = (
        python_scene("drop", [], parameter=[{"name": "a", "value": value, "nominal": 0.1}], **tables)
        for value in (0.1, 0.13)
    )
    assert_equal_runs(simulate(library_of(one), parameters={"a": 0.13}), simulate(library_of(two)))


def test_bodies_of_python_functions_have_no_parameters() -> None:
    bodies = [fixed("ground", plane()), dynamic("ball", sphere(0.1), density=900.0)]
    with pytest.raises(SceneError, match="bodies made by functions"):
        python_scene("drop", bodies, parameter=[{"name": "a", "value": 0.1}])
    with pytest.raises(SceneError, match="unknown name 'a'"):
        dynamic("ball", sphere("a"), density=900.0)  # type: ignore[arg-type]


def test_the_record_of_a_run_has_the_shapes_of_its_values() -> None:
    text = with_parameter("semi-axis")
    library, other = built(text), built(with_parameter("semi-axis", 0.085))
    run = simulate(library, parameters={"number": 0.085})
    mine, its = record_of(run, library).meshes, record_of(simulate(other), other).meshes
    assert mine.keys() == its.keys()
    assert mine
    assert all(np.array_equal(mine[key], its[key]) for key in mine)


def test_a_driven_run_takes_values() -> None:
    library, other = built(with_parameter("mass")), built(with_parameter("mass", 1.37))
    mine, its = start(library, parameters={"number": 1.37}), start(other)
    for t in (0.1, 0.25):
        assert mine.step(t) == its.step(t)
        assert np.array_equal(mine.state, its.state)


def test_values_from_the_command_line(modelgen: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, value in (("one", None), ("two", 1.37)):
        text = with_parameter("mass", value).replace("value", 'unit = "kg"\nmaximum = 2.0\nvalue')
        Path(f"{name}.toml").write_text(text, encoding="utf-8")
    mine = modelgen("simulate", "one.toml", "--set", "number=2.74/2", "--json").json
    its = modelgen("simulate", "two.toml", "--json").json
    assert mine["parameters"] == its["parameters"] == {"number": 1.37}
    assert mine["final"] == its["final"]
    assert "parameters: number = 1.37" in modelgen("simulate", "one.toml", "--set", "number=1.37").out
    (told,) = modelgen("check", "one.toml", "--brief", "--json").json["parameters"]
    assert told["uses"] == ["body[1].mass (body 'egg')"]
    text = modelgen("check", "one.toml", "--brief").out
    assert re.search(r"number +1.2 +1.2 +\.\.2 +kg +body\[1\]\.mass", text)


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (["numbr=1"], "did you mean 'number'?"),
        (["number"], "write --set mass=1.2"),
        (["number=x"], "unknown name 'x'"),
        (["number=1", "number=2"], "a second value of 'number'"),
        (["number=-1"], "refused by"),
    ],
)
def test_wrong_values_on_the_command_line(
    texts: list[str], told: str, modelgen: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("one.toml").write_text(with_parameter("mass"), encoding="utf-8")
    refused = modelgen("simulate", "one.toml", *(part for text in texts for part in ("--set", text)))
    assert refused.code == 2
    assert told in refused.err


@pytest.mark.parametrize("case", ["step", "input"])
def test_lanes_have_the_settings_and_inputs_of_scenes_with_their_numbers(case: str) -> None:
    """Numbers of a scene that are none of its tables of the core: kept apart by lane as these are."""
    value = NUMBERS[case][-1]
    assert_lanes_are_runs_of(built(with_parameter(case)), built(with_parameter(case, value)), value)


def test_an_input_of_a_lane_has_the_range_of_a_scene_with_its_number() -> None:
    many = start_many(built(with_parameter("range of an input")), 2, parameters={"number": [0.83, 0.62]})
    many.inputs["wind"][:] = 0.7
    with pytest.raises(ModelgenError, match=r"input 'wind' of lane 1: 0\.7; a number from 0\.41 to 0\.62"):
        many.step(0.1)


def test_rows_of_a_sweep_have_the_settings_of_a_scene_with_their_number() -> None:
    value = NUMBERS["step"][-1]
    base, other = built(with_parameter("step")), built(with_parameter("step", value))
    table = sweep(base, {"number": [0.001, value]}, until=0.1, estimate=False)
    for row, library in enumerate((base, other)):
        assert table["steps"][row] == simulate(library, until=0.1, samples=1, estimate=False).steps


def test_a_batch_takes_values() -> None:
    library, other = built(with_parameter("mass")), built(with_parameter("mass", 1.37))
    instance = library.manifest.instance
    starts = np.array(instance["initial_q"]), np.array(instance["initial_u"])
    mine = simulate_batch(library, *starts, until=0.1, parameters={"number": 1.37})
    its = simulate_batch(other, *starts, until=0.1)
    assert np.array_equal(mine.q, its.q)
    assert np.array_equal(mine.u, its.u)


def test_rates_of_normals_need_the_values_of_the_run() -> None:
    scene = read_text(with_parameter("semi-axis"), "scene.toml")
    derivation = derive(require(scene))
    run = simulate(library_of(scene), parameters={"number": 0.085})
    with pytest.raises(ModelgenError, match="other values of the scene's parameters"):
        normal_rates(derivation, run)


@pytest.mark.parametrize("case", ["mass", "semi-axis", "gravity", "frame of a joint"])
def test_the_scales_are_those_of_the_nominal_values(case: str) -> None:
    plain = with_parameter(case).replace("nominal", "minimum").rpartition("minimum")[0]
    value = NUMBERS[case][-1]
    nominal = require(read_text(plain, "scene.toml")).scales
    assert require(read_text(with_parameter(case, value), "scene.toml")).scales == nominal
    assert library_with(built(plain), {"number": value}).manifest.instance["scales"] == {
        "length": nominal.length, "mass": nominal.mass, "time": nominal.time
    }  # fmt: skip


def test_a_scene_in_other_units_has_its_nominal_values_in_them() -> None:
    scene = read_text(with_parameter("semi-axis", 0.085), "scene.toml")
    scales, units = require(scene).scales, Units(length=10.0, mass=3.0, time=7.0)
    other = require(in_units(scene, units)).scales
    assert (other.length, other.mass, other.time) == pytest.approx(
        (10.0 * scales.length, 3.0 * scales.mass, 7.0 * scales.time), rel=1e-12
    )
