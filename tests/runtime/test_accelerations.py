"""Accelerations as sensors: against differences of velocities along runs, and closed forms."""

from __future__ import annotations

from math import cos, sin

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, gradient, require, sensitivity, simulate, start
from modelgen.errors import SceneError
from modelgen.scene.read import read_text
from modelgen.verification.sensors import check_sensors
from tests.running import library_of
from tests.sensitivity.differences import differentiable

STEP = 1e-3  # s, between two states of a difference
STENCIL = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}  # of the central difference of order 8
# of its error: derivatives of order 9 of these motions are below 30**8 times the acceleration, and velocities
# are exact to the tolerance 1e-13 of a run
CLOSE = (30 * STEP) ** 8 + 1e-13 / STEP

SENSORS = "".join(
    f'[[sensor]]\nname = "{name}"\nof = "{of}"\n{more}\n'
    for name, of, more in (
        ("speed", "egg.velocity", ""),
        ("push", "egg.acceleration", ""),
        ("spin", "egg.angular_velocity", ""),
        ("twist", "egg.angular_acceleration", ""),
        ("tipspeed", "egg.velocity", "point = [0.1, 0.02, -0.03]"),
        ("tippush", "egg.acceleration", "point = [0.1, 0.02, -0.03]"),
        ("seen", "egg.velocity", 'point = [0.1, 0.02, -0.03]\nrelative_to = "disc"'),
        ("seenpush", "egg.acceleration", 'point = [0.1, 0.02, -0.03]\nrelative_to = "disc"'),
        ("turn", "egg.angular_velocity", 'relative_to = "disc"'),
        ("turnpush", "egg.angular_acceleration", 'relative_to = "disc"'),
        ("bobspeed", "bob.velocity", 'point = [0, 0, -0.1]\nrelative_to = "egg"'),
        ("bobpush", "bob.acceleration", 'point = [0, 0, -0.1]\nrelative_to = "egg"'),
        ("ridden", "disc.velocity", "point = [0.2, 0, 0]"),
        ("rode", "disc.acceleration", "point = [0.2, 0, 0]"),
        ("imu", "egg.proper_acceleration", "point = [0.1, 0.02, -0.03]"),
        ("felt", "egg.orientation", ""),
    )
)
PAIRS = {
    "speed": "push", "spin": "twist", "tipspeed": "tippush", "seen": "seenpush", "turn": "turnpush",
    "bobspeed": "bobpush", "ridden": "rode",
}  # fmt: skip
SCENE = f"""
[[parameter]]
name = "heft"
value = 0.4

[[body]]
name = "table"
motion = "fixed"
shape = {{ kind = "plane" }}

[[body]]
name = "egg"
shape = {{ kind = "ellipsoid", semi_axes = [0.12, 0.09, 0.07] }}
mass = "heft"
inertia = [0.001, 0.0016, 0.0018]
center_of_mass = [0.01, 0.0, 0.005]
position = [0.0, 0.0, 0.07]
velocity = [0.5, 0.1, 0.0]
angular_velocity = [1.0, 2.0, 3.0]

[[body]]
name = "disc"
motion = "driven"
[body.path]
position = ["0.1*sin(3*t)", "0.2*t*t", "1"]
rotation_vector = ["0.2*t", "0.1*sin(t)", "2*t + sin(2*t)"]

[[body]]
name = "bob"
mass = 0.2
inertia = [0.001, 0.001, 0.001]
position = [0.3, 0.0, 0.5]

[[joint]]
kind = "revolute"
between = ["world", "bob"]
position = [0.0, 0.0, 0.5]
rpy = ["pi/2", 0, 0]

[[contact]]
between = ["egg", "table"]
friction = 0.2
{SENSORS}
"""


def test_accelerations_are_derivatives_of_velocities_along_a_run() -> None:
    """With sliding friction, a joint, driven axes; no event lies within the times of the difference."""
    at, library = 0.1, library_of(read_text(SCENE, "egg.toml"))
    sim = start(library, accuracy="tight")
    shown = {}
    for k in range(-4, 5):
        events = sim.step(until=at + k * STEP)
        assert k == -4 or not events
        shown[k] = dict(sim.sensors)
    for speed, push in PAIRS.items():
        found = np.asarray(shown[0][push])
        rate = sum(
            weight * (np.asarray(shown[k][speed]) - np.asarray(shown[-k][speed]))
            for k, weight in STENCIL.items()
        )
        assert rate / STEP == pytest.approx(found, abs=CLOSE * max(1.0, float(np.abs(found).max()))), push


def test_proper_acceleration_is_that_of_the_point_without_gravity_in_axes_of_the_body() -> None:
    sim = start(library_of(read_text(SCENE, "egg.toml")))
    sim.step(until=0.1)
    w, *turn = np.asarray(sim.sensors["felt"])
    fallen = np.asarray(sim.sensors["tippush"]) + np.array([0.0, 0.0, 9.81])
    across = np.cross(turn, fallen)
    turned = fallen - 2 * w * across + 2 * np.cross(turn, across)  # by the inverse of the quaternion
    assert sim.sensors["imu"] == pytest.approx(turned, abs=1e-12)


def test_the_kernel_is_that_of_homogeneous_matrices_differentiated_twice() -> None:
    derivation = derive(require(read_text(SCENE, "egg.toml")))
    (finding,) = check_sensors(derivation.function("mg_sensors"), derivation, 20, 1)
    assert finding.status == "tested"


PENDULUM = """
[[body]]
name = "arm"
mass = 1.0
inertia = [0.001, 0.02, 0.02]
position = ["0.3*cos(0.4)", "0", "-0.3*sin(0.4)"]
rpy = [0, 0.4, 0]

[[joint]]
name = "hinge"
kind = "revolute"
between = ["world", "arm"]
rpy = ["pi/2", 0, 0]

[[sensor]]
name = "centre"
of = "arm.acceleration"

[[sensor]]
name = "hub"
of = "arm.acceleration"
point = [-0.3, 0, 0]

[[sensor]]
name = "felt"
of = "arm.proper_acceleration"
"""


def test_a_pendulum_that_is_released_has_the_accelerations_of_its_closed_form() -> None:
    shown = start(library_of(read_text(PENDULUM, "pendulum.toml"))).sensors
    angular = 0.3 * 9.81 * cos(0.4) / (0.02 + 0.3**2)  # downwards
    assert shown["centre"] == pytest.approx(
        [-0.3 * angular * sin(0.4), 0.0, -0.3 * angular * cos(0.4)], abs=1e-12
    )
    assert shown["hub"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    along, across = -9.81 * sin(0.4), 9.81 * cos(0.4) - 0.3 * angular
    assert shown["felt"] == pytest.approx([along, 0.0, across], abs=1e-12)


PUCK = """
[[input]]
name = "push"

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "puck"
shape = { kind = "sphere", radius = 0.5 }
mass = 2.0
inertia = [0.2, 0.2, 0.2]
position = [0.0, 0.0, 1.0]

[[contact]]
between = ["table", "puck"]

[[force]]
body = "puck"
force = ["push", "0", "0"]

[[sensor]]
name = "rate"
of = "puck.acceleration"

[[sensor]]
name = "felt"
of = "puck.proper_acceleration"


"""


def test_what_is_shown_at_an_event_is_after_it() -> None:
    library = library_of(read_text(PUCK, "puck.toml"))
    sim = start(library)
    assert sim.sensors["rate"] == pytest.approx([0.0, 0.0, -9.81])
    assert sim.sensors["felt"] == pytest.approx([0.0, 0.0, 0.0])
    (landing,) = sim.step(until=0.5)
    assert sim.sensors["rate"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert sim.sensors["felt"] == pytest.approx([0.0, 0.0, 9.81])
    sim.inputs["push"] = 3.0
    assert sim.sensors["rate"] == pytest.approx([1.5, 0.0, 0.0])  # before a step is taken
    at_landing = start(library)
    at_landing.step(until=landing.t)
    assert at_landing.sensors["rate"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    path = simulate(library, until=landing.t, samples=2, estimate=False)
    assert path.sensors[:, 2] == pytest.approx([-9.81, -9.81, 0.0], abs=1e-12)
    stepped = simulate(library, until=0.2, samples=1, method="time-stepping", step=1e-2, estimate=False)
    assert np.isnan(stepped.sensors).all()  # which has no accelerations


@pytest.mark.slow
def test_derivatives_of_accelerations_follow_from_those_of_the_state() -> None:
    library = differentiable(read_text(SCENE, "egg.toml"))
    names, by, times = ["tippush", "seenpush", "imu", "twist"], ["heft", "egg.velocity"], [0.05, 0.1]
    found = sensitivity(library, times, of=names, by=by, accuracy="tight")
    near, far = (
        sensitivity(
            library, times, of=names, by=["heft"], parameters={"heft": 0.4 + h}, accuracy="tight"
        ).value
        for h in (-1e-4, 1e-4)
    )
    difference = (far - near) / 2e-4
    assert found.jacobian[:, :, 0] == pytest.approx(difference, abs=1e-4 * np.abs(difference).max())
    values = ca.MX.sym("values", *found.value.shape)
    weights = np.random.default_rng(3).normal(size=found.value.shape)
    loss = ca.Function("loss", [values], [ca.sum1(ca.sum2(weights * values))])
    back = gradient(library, times, loss, of=names, by=by, accuracy="tight")
    expected = np.einsum("ij,ijk->k", weights, found.jacobian)
    assert back.gradient == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            'of = "puck.proper_acceleration"',
            'of = "puck.proper_acceleration"\nrelative_to = "table"',
            "own axes",
        ),
        (
            'of = "puck.acceleration"',
            'of = "puck.angular_acceleration"\npoint = [0, 0, 1]',
            "a point has position,",
        ),
        ('of = "puck.acceleration"', 'of = "puck.aceleration"', "did you mean 'acceleration'"),
    ],
)
def test_mistakes_in_sensors_of_accelerations(old: str, new: str, words: str) -> None:
    text = PUCK
    assert old in text
    with pytest.raises(SceneError, match=words):
        read_text(text.replace(old, new), "puck.toml")
