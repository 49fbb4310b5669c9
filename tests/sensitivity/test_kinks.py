"""On a kink a derivative is that of the side that is said, and never called differentiable; a little beside
it each is, and has its closed form."""

from __future__ import annotations

from math import pi, sqrt

import casadi
import numpy as np
import pytest

from modelgen import gradient, sensitivity
from modelgen.runtime.sensitivity import Sensitivity
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

BESIDE = (-1e-3, 0.0, 1e-3)  # of the number that is on the kink
SEEDS = range(3)
FLOOR = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
"""


def found_in(text: str, t: float, by: list[str], of: list[str] | None = None, **given: object) -> Sensitivity:
    library = differentiable(read_text(text, "scene.toml"))
    return sensitivity(library, t, of=of, by=by, accuracy="tight", estimate=False, **given)  # type: ignore[arg-type]


def check(found: Sensitivity, beside: float, below: float, above: float, component: int = 0) -> None:
    """The derivatives below and above the kink; on it that of the side that is said."""
    side = str(found.sides[0, component, 0])
    if beside:
        assert found.verdict, found.verdict
        assert side == "both"
    else:
        assert found.verdict.kind == "one-sided", found.verdict
        assert side in ("smaller", "larger")
    expected = below if beside < 0 or side == "smaller" else above
    assert found.jacobian[0, component, 0] == pytest.approx(expected, rel=1e-7, abs=1e-10)


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("seed", SEEDS)
def test_an_actuator_at_its_limit(seed: int, beside: float) -> None:
    """A wheel turns by t^2/2I of the torque, which grows no more beyond the limit."""
    limit, inertia, t = map(float, np.random.default_rng(seed).uniform(0.5, 2.0, 3))
    text = f"""
[[input]]
name = "push"
default = {limit!r}
[[body]]
name = "wheel"
mass = 1.0
inertia = [{inertia!r}, {inertia!r}, {inertia!r}]
[[joint]]
name = "axle"
kind = "revolute"
between = ["world", "wheel"]
[[actuator]]
joint = "axle"
force = "push"
limits = [-{limit!r}, {limit!r}]
[[sensor]]
name = "angle"
of = "axle.coordinate"
"""
    t = min(t, 0.9 * sqrt(pi * inertia / limit))  # within half a turn
    found = found_in(text, t, ["push"], inputs={"push": limit * (1 + beside)})
    check(found, beside, t**2 / 2 / inertia, 0.0)


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_weight_that_is_balanced(seed: int, gravity: float, beside: float) -> None:
    """It rises as t^2/2m of what is more than its weight, which may be zero."""
    mass, t = map(float, np.random.default_rng(seed).uniform(0.5, 2.0, 2))
    text = f"""{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = {mass!r}
inertia = [0.01, 0.01, 0.01]
position = [0, 0, 0.1]
[[input]]
name = "push"
[[force]]
body = "ball"
force = ["0", "0", "push"]
[[contact]]
between = ["ball", "floor"]
"""
    found = found_in(
        f"gravity = [0, 0, {-gravity}]\n{text}",
        t,
        ["push"],
        ["ball.position"],
        inputs={"push": mass * (gravity + 10 * beside)},
    )
    check(found, beside, 0.0, t**2 / 2 / mass, 2)


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_push_at_the_threshold_of_friction(seed: int, beside: float) -> None:
    """A ball that is pushed at its centre rolls until friction, F I/(I + m R^2), reaches its bound."""
    mass, mu, t = map(float, np.random.default_rng(seed).uniform(0.3, 0.9, 3))
    inertia, radius, gravity = 0.003, 0.1, 9.81
    threshold = mu * mass * gravity * (inertia + mass * radius**2) / inertia
    text = f"""{FLOOR}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius} }}
mass = {mass!r}
inertia = [{inertia}, {inertia}, {inertia}]
position = [0, 0, {radius}]
[[input]]
name = "push"
[[force]]
body = "ball"
force = ["push", "0", "0"]
[[contact]]
between = ["ball", "floor"]
friction = {mu!r}
"""
    found = found_in(text, t, ["push"], ["ball.position"], inputs={"push": threshold * (1 + beside)})
    if beside > 0 and not found.verdict:
        assert found.verdict.reason == "slow slip is turned fast by friction"  # as it begins
    else:
        check(found, beside, t**2 / 2 / (mass + inertia / radius**2), t**2 / 2 / mass)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_push_across_one_at_the_threshold_of_friction(seed: int) -> None:
    """The bound does not change to first order, so both sides keep it, whatever rounding says."""
    random = np.random.default_rng(seed)
    mass, mu = float(np.exp(random.uniform(-4, 4))), float(random.uniform(0.2, 0.6))
    text = f"""{FLOOR}
[[input]]
name = "across"
[[body]]
name = "box"
shape = {{ kind = "box", size = [0.4, 0.3, 0.1] }}
mass = {mass!r}
inertia = [{0.02 * mass!r}, {0.03 * mass!r}, {0.04 * mass!r}]
position = [0, 0, 0.05]
[[force]]
body = "box"
point = [0, 0, -0.05]
force = ["{mu * mass * 9.81!r}", "across", "0"]
[[contact]]
between = ["box", "floor"]
friction = {mu!r}
"""
    found = found_in(text, 0.2, ["across"], ["box.position"])
    assert found.verdict, found.verdict
    assert np.all(np.abs(found.jacobian) <= 1e-12 / mass)


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_throw_that_just_reaches_a_ceiling(seed: int, beside: float) -> None:
    """Beyond it the ball strikes at vs^2 = v^2 - 2 g h, and flies on downwards."""
    random = np.random.default_rng(seed)
    high, bounce = float(random.uniform(0.3, 1.0)), float(random.uniform(0.2, 0.8))
    gravity, radius = 9.81, 0.1
    fast = sqrt(2 * gravity * (high - radius)) * (1 + beside)
    text = f"""
[[body]]
name = "ceiling"
motion = "fixed"
shape = {{ kind = "plane" }}
position = [0, 0, {high!r}]
rpy = ["pi", 0, 0]
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = {radius} }}
mass = 1.0
inertia = [0.01, 0.01, 0.01]
velocity = [0, 0, {fast!r}]
[[contact]]
between = ["ball", "ceiling"]
restitution = {bounce!r}
"""
    t = 1.2 * fast / gravity

    def height(v: complex) -> complex:
        strikes = np.sqrt(v * v - 2 * gravity * (high - radius))
        left = t - (v - strikes) / gravity
        return high - radius - bounce * strikes * left - gravity / 2 * left**2

    found = found_in(text, t, ["ball.velocity"], ["ball.position"])
    assert bool(found.verdict) == bool(beside), found.verdict
    slope = height(fast + 1e-20j).imag / 1e-20 if beside > 0 else t
    assert found.jacobian[0, 2, 2] == pytest.approx(slope, rel=1e-7)
    assert list(found.sides[0, 2]) == ["both", "both", "both" if beside else "smaller"]


FREE = """
gravity = [0, 0, 0]
[[body]]
name = "ball"
mass = 1.5
inertia = [0.01, 0.01, 0.01]
position = ["place", 0.2, 0]
velocity = ["fast", 0, 0]
[[parameter]]
name = "place"
value = {place!r}
[[parameter]]
name = "fast"
value = {fast!r}
[[sensor]]
name = "p"
of = "ball.position"
[[sensor]]
name = "shown"
value = "{shown}"
"""


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize(
    ("shown", "kink", "slopes"),
    [
        ("3*abs(p_x - 0.4)", 0.4, (-3.0, 3.0)),
        ("max(p_x, 2*p_x - 0.4)", 0.4, (1.0, 2.0)),
        ("min(p_x, p_y)", 0.2, (1.0, 0.0)),
        ("2*p_x + sign(p_x)", 0.0, (2.0, 2.0)),
        ("atan2(p_x, -p_y)", 0.0, (-5.0, -5.0)),
        ("max(abs(p_x), 3*p_x) + p_x*p_x", 0.0, (-1.0, 3.0)),
        ("sqrt(p_x*p_x + 0*p_y)", 0.0, (-1.0, 1.0)),
    ],
)
def test_a_sensor_on_a_kink_at_its_sample(
    shown: str, kink: float, slopes: tuple[float, float], beside: float
) -> None:
    """Of a free flight; atan2(x, -y) jumps by a turn at x = 0, where its slope is -1/y."""
    fast, t = 0.7, 0.5
    found = found_in(
        FREE.format(place=kink - fast * t + beside, fast=fast, shown=shown), t, ["place"], ["shown"]
    )
    side = str(found.sides[0, 0, 0])
    assert bool(found.verdict) == bool(beside), found.verdict
    if beside:
        assert found.jacobian[0, 0, 0] == pytest.approx(slopes[beside > 0], rel=3e-3)
    elif found.verdict.kind == "one-sided":
        assert found.jacobian[0, 0, 0] == pytest.approx(slopes[side == "larger"], rel=1e-7)
    else:
        assert shown.startswith(("sqrt", "2*p_x"))  # not finite, a jump
    assert found_in(FREE.format(place=kink - fast * t, fast=fast, shown=shown), t, ["place"], ["p"]).verdict


@pytest.mark.parametrize(
    ("force", "smooth"), [("-9*sign(x)", False), ("-9*max(0, x)", True), ("-9*abs(x)", True)]
)
@pytest.mark.parametrize("fast", [0.0, 0.8])
def test_a_load_that_starts_on_a_jump_or_a_kink(force: str, smooth: bool, fast: float) -> None:
    """A kink that the motion leaves at once changes nothing of first order; a jump does."""
    load = f'[[force]]\nbody = "ball"\nforce = ["{force}", 0, 0]\n'
    found = found_in(FREE.format(place=0.0, fast=fast, shown="t") + load, 0.3, ["place"], ["ball.velocity"])
    assert bool(found.verdict) == (smooth and fast > 0), found.verdict
    if found.verdict:
        w = sqrt(9 / 1.5)
        assert found.jacobian[0, 0, 0] == pytest.approx(-w * np.sin(w * 0.3), rel=1e-7)


@pytest.mark.parametrize("value", [-1e-3, 0.0, 1e-3])
def test_a_parameter_that_lets_a_ball_start_from_the_floor(value: float) -> None:
    """Upwards it flies, downwards it strikes; of a start of the body only what the floor permits is meant."""
    text = f"""{FLOOR}
[[parameter]]
name = "up"
value = {value}
[[body]]
name = "ball"
shape = {{ kind = "sphere", radius = 0.1 }}
mass = 1.0
inertia = [0.01, 0.01, 0.01]
position = [0, 0, 0.1]
velocity = [0, 0, "up"]
[[contact]]
between = ["ball", "floor"]
restitution = 0.5
"""
    t = 5e-5
    found = found_in(text, t, ["up"], ["ball.position"])
    assert bool(found.verdict) == bool(value), found.verdict
    if value:
        assert found.jacobian[0, 2, 0] == pytest.approx(t if value > 0 else -0.5 * t, rel=1e-9)
    assert found_in(text, t, ["ball.velocity"], ["ball.position"]).verdict


@pytest.mark.parametrize("seed", SEEDS)
def test_forces_that_are_not_unique(seed: int) -> None:
    """Two hinges on one axis share what they carry in any way; their sum and the motion are unique."""
    random = np.random.default_rng(seed)
    apart, heavy, t = float(random.uniform(0.2, 0.5)), float(random.uniform(0.5, 2.0)), 0.1
    hinges = "".join(
        f"""
[[joint]]
name = "{name}"
kind = "revolute"
between = ["world", "arm"]
position = [0, {at!r}, 0]
axis_angle = {{ axis = [1, 0, 0], angle = "-pi/2" }}
"""
        for name, at in (("a", 0.0), ("b", apart))
    )
    text = f"""{hinges}
[[parameter]]
name = "heavy"
value = {heavy!r}
[[body]]
name = "arm"
mass = "heavy"
inertia = [0.1, 0.2, 0.3]
position = [0.5, 0, 0]
[[sensor]]
name = "fa"
of = "a.force"
[[sensor]]
name = "fb"
of = "b.force"
[[sensor]]
name = "sum"
value = "fa_z + fb_z"
[[sensor]]
name = "p"
of = "arm.position"
"""
    for of, unique in (["fa"], False), (["fb"], False), (["sum"], True), (["p"], True):
        found = found_in(text, t, ["heavy"], of)
        assert bool(found.verdict) == unique, (of, found.verdict)
    found = found_in(text, 1e-9, ["heavy"], ["sum"])
    inertia = 0.2 + heavy * 0.25  # about the axis: m g less m times the acceleration g m r^2 / I
    slope = 9.81 * (1 - 0.25 * (2 * heavy * inertia - 0.25 * heavy**2) / inertia**2)
    assert found.jacobian[0, 0, 0] == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("law", ["poisson", "stronge"])
def test_what_is_not_differentiated_is_not_a_number(law: str) -> None:
    text = f"""{FLOOR}
[[body]]
name = "rod"
shape = {{ kind = "capsule", radius = 0.05, length = 0.6 }}
density = 700.0
position = [0, 0, 0.7]
rpy = [0, 0.5, 0]
velocity = [0.3, 0, -1]
[[contact]]
between = ["rod", "floor"]
restitution = {{ value = 0.6, law = "{law}" }}
friction = 0.2
"""
    library = differentiable(read_text(text, "scene.toml"))
    found = sensitivity(library, [0.05, 0.4], of=["rod.position"], by=["rod.velocity"], estimate=False)
    assert found.verdicts[0]
    assert np.all(np.isfinite(found.jacobian[0]))
    assert found.verdict.reason == "the law of an impact is not differentiated"
    assert np.all(np.isnan(found.jacobian[1]))
    values = casadi.MX.sym("values", 1, 3)
    loss = casadi.Function("loss", [values], [casadi.sumsqr(values)])
    slope = gradient(library, 0.4, loss, of=["rod.position"], by=["rod.velocity"])
    assert not slope.verdict
    assert np.all(np.isnan(slope.gradient))
