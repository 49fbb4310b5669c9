"""Derivatives of runs whose motion is known in closed form, differentiated by a complex step."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from modelgen import sensitivity
from modelgen.codegen.library import Library
from modelgen.runtime.finite_differences import run_differences
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

G, R = 9.81, 0.1
FLOOR = """
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
"""


def built(text: str, parameters: dict[str, float]) -> Library:
    tables = "".join(
        f'[[parameter]]\nname = "{name}"\nvalue = {value}\n' for name, value in parameters.items()
    )
    return differentiable(read_text(text + tables, "scene.toml"))


def complex_step(function: Callable[..., complex], values: Sequence[float]) -> np.ndarray:
    """The gradient of a function that is analytic near real arguments."""
    found = []
    for k in range(len(values)):
        moved = [complex(value, 1e-30 if i == k else 0.0) for i, value in enumerate(values)]
        found.append(function(*moved).imag / 1e-30)
    return np.array(found)


BALL = (
    FLOOR
    + """
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = [0.0, 0.0, "high"]
velocity = [0.3, 0.0, "up"]

[[contact]]
between = ["ball", "floor"]
restitution = "bounce"
"""
)


def thrown(high: complex, up: complex, bounce: complex, t: float) -> tuple[complex, complex, complex]:
    """Height and velocity after one bounce, and its time."""
    speed = np.sqrt(up * up + 2 * G * (high - R))
    strikes = (up + speed) / G
    later = t - strikes
    return R + bounce * speed * later - G * later * later / 2, bounce * speed - G * later, strikes


@pytest.mark.parametrize(("high", "up", "bounce", "t"), [(0.9, 1.1, 0.8, 0.8), (0.4, -0.5, 1.0, 0.5)])
def test_a_ball_thrown_on_a_floor(high: float, up: float, bounce: float, t: float) -> None:
    library = built(BALL, {"high": high, "up": up, "bounce": bounce})
    by = ["high", "up", "bounce"]
    found = sensitivity(library, t, of=["ball.position", "ball.velocity"], by=by, accuracy="tight")
    assert found.verdict
    for row, entry in ((2, 0), (5, 1)):
        expected = complex_step(lambda *v, entry=entry: thrown(*v, t)[entry], (high, up, bounce))
        assert np.allclose(found.jacobian[0, row], expected, rtol=1e-10, atol=1e-10)
    assert np.allclose(found.jacobian[0, 0], 0, atol=1e-14)
    (event,) = found.events
    assert event.t == pytest.approx(thrown(high, up, bounce, t)[2].real, abs=1e-12)
    assert np.allclose(event.by, complex_step(lambda *v: thrown(*v, t)[2], (high, up, bounce)), atol=1e-10)


TWO = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "one"
shape = { kind = "sphere", radius = 0.1 }
mass = "light"
inertia = [0.01, 0.01, 0.01]
velocity = ["fast", 0.0, 0.0]

[[body]]
name = "two"
shape = { kind = "sphere", radius = "wide" }
mass = 3.0
inertia = [0.01, 0.01, 0.01]
position = [1.0, 0.0, 0.0]
velocity = [-0.5, 0.0, 0.0]

[[contact]]
between = ["one", "two"]
restitution = "bounce"
"""


def test_a_ball_struck_by_one_that_moves() -> None:
    """Its velocity does not depend on where they meet, its place does."""
    values = {"light": 0.7, "fast": 2.0, "wide": 0.2, "bounce": 0.6}
    t = 0.6

    def two(light: complex, fast: complex, wide: complex, bounce: complex) -> tuple[complex, complex]:
        strikes = (1.0 - R - wide) / (fast + 0.5)
        after = (light * fast - 3.0 * 0.5 + light * bounce * (fast + 0.5)) / (light + 3.0)
        return 1.0 - 0.5 * strikes + after * (t - strikes), after

    found = sensitivity(
        built(TWO, values), t, of=["two.position", "two.velocity"], by=list(values), accuracy="tight"
    )
    assert found.verdict
    for row, entry in ((0, 0), (3, 1)):
        expected = complex_step(lambda *v, entry=entry: two(*v)[entry], tuple(values.values()))
        assert np.allclose(found.jacobian[0, row], expected, rtol=1e-11, atol=1e-11)


SLIDER = (
    FLOOR
    + """
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = [0.0, 0.0, 0.1]
velocity = ["along", "aside", 0.0]
angular_velocity = ["spin", 0.0, 0.0]

[[contact]]
between = ["ball", "floor"]
friction = "rough"
"""
)


@pytest.mark.parametrize("spin", [0.0, 8.0])
def test_a_ball_that_slides_until_it_rolls(spin: float) -> None:
    """Straight, and obliquely: the slip keeps its direction, and ends after 2 |slip| / (7 mu g)."""
    values = {"along": 1.5, "aside": 0.4, "spin": spin, "rough": 0.3}
    t = 0.5

    def rolled(
        along: complex, aside: complex, spin: complex, rough: complex
    ) -> tuple[complex, complex, complex]:
        slip_x, slip_y = along, aside + spin * R
        slip = np.sqrt(slip_x * slip_x + slip_y * slip_y)
        ends = 2 * slip / (7 * rough * G)
        vx, vy = along - 2 / 7 * slip_x, aside - 2 / 7 * slip_y
        x = along * ends - rough * G * slip_x / slip * ends * ends / 2 + vx * (t - ends)
        return x, vy, ends

    found = sensitivity(
        built(SLIDER, values), t, of=["ball.position", "ball.velocity"], by=list(values), accuracy="tight"
    )
    assert found.verdict
    for row, entry in ((0, 0), (4, 1)):
        expected = complex_step(lambda *v, entry=entry: rolled(*v)[entry], tuple(values.values()))
        assert np.allclose(found.jacobian[0, row], expected, rtol=1e-7, atol=1e-8)
    expected = complex_step(lambda *v: rolled(*v)[2], tuple(values.values()))
    assert np.allclose(found.events[0].by, expected, rtol=1e-7, atol=1e-8)


PENDULUM = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "arm"
mass = 1.3
inertia = [0.02, 0.02, 0.02]
position = [0.5, 0.0, 0.0]
velocity = [0.0, 0.0, 0.0]

[[joint]]
kind = "revolute"
name = "hinge"
between = ["world", "arm"]
position = [0.0, 0.0, 0.0]
stiffness = "stiff"
rest = 0.6
limits = [-1.0, "stop"]
restitution = "bounce"
"""


def test_a_pendulum_with_a_stop() -> None:
    """A sine about the rest angle of its spring, turned back at the stop."""
    values = {"stiff": 2.0, "stop": 0.9, "bounce": 0.7}
    inertia, t = 0.02 + 1.3 * 0.25, 1.5

    def turned(stiff: complex, stop: complex, bounce: complex) -> tuple[complex, complex]:
        w = np.sqrt(stiff / inertia)
        strikes = np.arccos((0.6 - stop) / 0.6) / w  # 0.6 (1 - cos w t) = stop
        speed = -bounce * 0.6 * w * np.sin(w * strikes)
        angle = 0.6 + (stop - 0.6) * np.cos(w * (t - strikes)) + speed / w * np.sin(w * (t - strikes))
        return 0.5 * np.sin(angle), strikes

    found = sensitivity(built(PENDULUM, values), t, of=["arm.position"], by=list(values), accuracy="tight")
    assert found.verdict
    expected = complex_step(lambda *v: turned(*v)[0], tuple(values.values()))
    assert np.allclose(found.jacobian[0, 1], expected, rtol=1e-9, atol=1e-9)
    assert np.allclose(
        found.events[0].by, complex_step(lambda *v: turned(*v)[1], tuple(values.values())), atol=1e-9
    )


WALL = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "wall"
motion = "driven"
rpy = [0.0, "-pi/2", 0.0]
path = { position = ["2.0 - 0.7*t - SPEEDS_UP*t**2/2", 0.0, 0.0] }
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = ["place", 0.0, 0.0]
velocity = ["fast", 0.0, 0.0]

[[contact]]
between = ["ball", "wall"]
restitution = "bounce"
"""


@pytest.mark.parametrize("speeds_up", [0.0, 0.5])
def test_a_ball_struck_by_a_moving_wall(speeds_up: float) -> None:
    """By a wall of constant speed its place changes as -e with its start, its velocity not at all; one that
    speeds up strikes a later ball at another speed."""
    values = {"place": 0.2, "fast": 1.3, "bounce": 0.6}
    t = 1.5

    def struck(place: complex, fast: complex, bounce: complex) -> tuple[complex, complex, complex]:
        left = 2.0 - R - place
        strikes = 2 * left / (fast + 0.7 + np.sqrt((fast + 0.7) ** 2 + 2 * speeds_up * left))
        wall = -0.7 - speeds_up * strikes
        after = wall - bounce * (fast - wall)
        return place + fast * strikes + after * (t - strikes), after, strikes

    library = built(WALL.replace("SPEEDS_UP", str(speeds_up)), values)
    found = sensitivity(library, t, of=["ball.position", "ball.velocity"], by=list(values), accuracy="tight")
    assert found.verdict
    for row, entry in ((0, 0), (3, 1)):
        expected = complex_step(lambda *v, entry=entry: struck(*v)[entry], tuple(values.values()))
        assert np.allclose(found.jacobian[0, row], expected, rtol=1e-11, atol=1e-11)
    if not speeds_up:
        assert found.jacobian[0, 0, 0] == pytest.approx(-values["bounce"], abs=1e-11)
    expected = complex_step(lambda *v: struck(*v)[2], tuple(values.values()))
    assert np.allclose(found.events[0].by, expected, atol=1e-11)


CYCLOID = """
gravity = [0.0, 0.0, "-pull"]
[[body]]
name = "track"
motion = "fixed"

[body.shape]
kind = "chart"
x = "a*(u + sin(u))"
y = "v"
z = "a*(1 - cos(u))"
domain = [[-2.5, 2.5], [-1.0, 1.0]]
parameters = { a = "wide" }

[[body]]
name = "wall"
motion = "fixed"
rpy = [0.0, "pi/2", 0.0]
shape = { kind = "plane" }

[[body]]
name = "bead"
shape = { kind = "point" }
mass = 0.4
inertia = [1e-5, 1e-5, 1e-5]
position = ["wide*(high + sin(high))", 0.0, "wide*(1 - cos(high))"]

[[contact]]
between = ["bead", "track"]

[[contact]]
between = ["bead", "wall"]
restitution = 1.0
"""


def test_a_bead_on_a_cycloid_falls_to_the_bottom_in_the_same_time_from_anywhere() -> None:
    """Huygens: its way along the track is a cosine, whatever the amplitude."""
    values = {"wide": 0.3, "high": 0.8, "pull": 9.81}
    t = 0.75

    def height(wide: complex, high: complex, pull: complex) -> complex:
        return wide * (1 - np.cos(high)) * np.cos(np.sqrt(pull / (4 * wide)) * t) ** 2

    found = sensitivity(built(CYCLOID, values), t, of=["bead.position"], by=list(values), accuracy="tight")
    assert found.verdict
    assert np.allclose(found.jacobian[0, 2], complex_step(height, tuple(values.values())), atol=1e-9)
    (event,) = found.events
    falls = np.pi * np.sqrt(values["wide"] / values["pull"])  # a quarter of the period
    assert event.t == pytest.approx(falls, abs=1e-10)
    assert np.allclose(event.by, [falls / 2 / values["wide"], 0.0, -falls / 2 / values["pull"]], atol=1e-9)


BLOCK = """
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "slope"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "block"
shape = { kind = "box", size = [0.2, 0.1, 0.05] }
mass = "heavy"
inertia = [0.01, 0.01, 0.01]
position = [0.0, 0.0, 0.025]

[[force]]
body = "block"
force = ["3*t", 0.0, 0.0]

[[contact]]
between = ["block", "slope"]
friction = { static = "rough", kinetic = "smooth" }
"""


def test_a_block_that_is_pulled_until_it_slips_on_its_face() -> None:
    values = {"heavy": 1.2, "rough": 0.4, "smooth": 0.3}
    t = 2.0

    def pulled(heavy: complex, rough: complex, smooth: complex) -> tuple[complex, complex]:
        slips = rough * heavy * G / 3
        speed = 3 * (t * t - slips * slips) / 2 / heavy - smooth * G * (t - slips)
        return speed, slips

    found = sensitivity(built(BLOCK, values), t, of=["block.velocity"], by=list(values), accuracy="tight")
    assert found.verdict
    expected = complex_step(lambda *v: pulled(*v)[0], tuple(values.values()))
    assert np.allclose(found.jacobian[0, 0], expected, rtol=1e-10, atol=1e-10)
    (event,) = found.events
    assert event.contact == "block-slope"
    assert np.allclose(event.by, complex_step(lambda *v: pulled(*v)[1], tuple(values.values())), atol=1e-10)


DISC = (
    FLOOR
    + """
[[body]]
name = "disc"
shape = { kind = "cylinder", radius = 0.1, length = 0.02 }
center_of_mass = [0.0, 0.0, -0.01]
mass = 2.0
inertia = [0.005, 0.005, 0.01]
position = [0.0, 0.0, 0.01]
angular_velocity = [0.0, 0.0, 30.0]

[[contact]]
between = ["disc", "floor"]
friction = "rough"
"""
)


@pytest.mark.slow
def test_a_disc_that_spins_on_its_face() -> None:
    """Friction of a uniform pressure slows the spin w by 4 mu g / (3 R), and a small slip v beside it by
    mu g v / (w R): v is as w^(3/4). Its centre of mass is in the face, so that friction does not tilt it."""
    rough, spin, t = 0.3, 30.0, 0.4
    found = sensitivity(
        built(DISC, {"rough": rough}),
        t,
        of=["disc.velocity", "disc.angular_velocity"],
        by=["rough", "disc.velocity", "disc.angular_velocity"],
        accuracy="tight",
    )
    assert found.verdict
    slowed = spin - 4 * rough * G * t / (3 * R)
    assert found.value[0, 5] == pytest.approx(slowed, rel=1e-10)
    left = (slowed / spin) ** 0.75
    assert np.allclose(found.jacobian[0, :2, 1:3], left * np.eye(2), atol=1e-9)
    assert found.jacobian[0, 5, 0] == pytest.approx(-4 * G * t / (3 * R), rel=1e-9)
    assert found.jacobian[0, 5, 6] == pytest.approx(1.0, abs=1e-9)


def test_a_ball_that_strikes_at_its_start() -> None:
    """The impact of the start is differentiated as any other."""
    text = BALL.replace('"high"', "0.1")
    values = {"up": -2.0, "bounce": 0.6}
    found = sensitivity(
        built(text, values), 0.1, of=["ball.position"], by=["up", "bounce", "ball.velocity"], accuracy="tight"
    )
    assert found.verdict
    by_up, by_bounce = -values["bounce"], -values["up"]
    assert np.allclose(found.jacobian[0, 2], np.array([by_up, by_bounce, 0, 0, by_up]) * 0.1, atol=1e-12)
    assert np.allclose(found.jacobian[0, 0], np.array([0, 0, 1, 0, 0]) * 0.1, atol=1e-12)


ROD = """
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "rod"
mass = 0.9
inertia = [0.01, 0.03, 0.03]
position = ["0.5*cos(turn)", 0.0, "0.5*sin(turn)"]
rpy = [0.0, "-turn", 0.0]
velocity = [0.0, 0.0, "kick"]

[[joint]]
kind = "revolute"
name = "hinge"
between = ["world", "rod"]
position = [0.0, 0.0, 0.0]
rpy = ["-pi/2", 0.0, 0.0]
"""


def test_a_start_that_a_joint_corrects() -> None:
    """The joint takes from the given velocity what it forbids: the rate of turn that is left changes with the
    angle at which the rod is kicked."""
    values = {"turn": 0.5, "kick": 1.7}
    found = sensitivity(
        built(ROD, values),
        0.0,
        of=["rod.velocity", "rod.angular_velocity"],
        by=list(values),
        accuracy="tight",
    )
    assert found.verdict
    inertia = 0.03 + 0.9 * 0.25

    def kicked(turn: complex, kick: complex) -> list[complex]:
        rate = 0.9 * 0.5 * np.cos(turn) * kick / inertia
        return [-0.5 * np.sin(turn) * rate, 0.5 * np.cos(turn) * rate, -rate]

    for row, entry in ((0, 0), (2, 1), (4, 2)):
        expected = complex_step(lambda *v, entry=entry: kicked(*v)[entry], tuple(values.values()))
        assert np.allclose(found.jacobian[0, row], expected, atol=1e-10)


@pytest.mark.parametrize(
    ("text", "values"),
    [(ROD, {"turn": 0.5, "kick": 1.7}), (BALL.replace('"high"', "0.1"), {"up": -2.0, "bounce": 0.6})],
)
def test_differences_of_a_start_that_is_corrected(text: str, values: dict[str, float]) -> None:
    """A change of the start is one of what joints and blows have made of it."""
    library = built(text, values)
    body, quantities = (
        ("rod", ("velocity", "angular_velocity")) if text is ROD else ("ball", ("position", "velocity"))
    )
    of = [f"{body}.{quantity}" for quantity in quantities]
    by = [*values, *of]
    found = sensitivity(library, 0.1, of=of, by=by, accuracy="tight", estimate=False)
    expected = run_differences(library, 0.1, of=of, by=by, accuracy="tight")
    assert np.allclose(found.jacobian, expected, atol=1e-7)
