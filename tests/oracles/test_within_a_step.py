"""Loads that reach a bound and fall short of it again within one step of the method: closed forms."""

from __future__ import annotations

from math import asin, cos, pi, sin, sqrt

import pytest
from scipy.optimize import brentq

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

BODIES = """
gravity = [0, 0, {gravity!r}]
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "body"
shape = {shape}
mass = 1
inertia = [{inertia}, {inertia}, {inertia}]
position = [0, 0, {height}]
[[contact]]
between = ["body", "floor"]
{contact}
[[{load}]]
body = "body"
{load} = {value}
{point}
"""
BOX = {"shape": '{ kind = "box", size = [0.2, 0.2, 0.1] }', "inertia": 0.01, "height": 0.05}
BALL = {"shape": '{ kind = "sphere", radius = 0.1 }', "inertia": 0.004, "height": 0.1}
GRIPPING = "friction = { static = 0.2, kinetic = 0.1 }"
UNTIL = 2.0
OFF = {"fast": 1e-8, "balanced": 1e-12, "tight": 1e-13}
PRESETS = pytest.mark.parametrize("preset", list(OFF))
OVER = pytest.mark.parametrize("over", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])  # part of a load beyond its bound


def ran(
    body: dict[str, object],
    load: str,
    value: str,
    over: float,
    preset: str,
    contact: str = "",
    point: str = "",
) -> Trajectory:
    """At 10 m/s^2 the load just reaches its bound; here it goes beyond it by a part of itself."""
    gravity = -10 * (1 - over)
    text = BODIES.format(**body, gravity=gravity, load=load, value=value, contact=contact, point=point)
    path = simulate(library_of(read_text(text, "strain.toml")), until=UNTIL, accuracy=preset, samples=3)
    assert path.estimate is not None
    return path


def kinds(path: Trajectory) -> list[str]:
    return [event.kind for event in path.events if event.kind != "face-contact"]


def slid(force: float, held: float, kinetic: float) -> float:
    """Where a box of 1 kg is after a load of force sin(2 t) that breaks its friction constraint."""
    start = asin(held / force) / 2

    def speed(t: float) -> float:
        return force / 2 * (cos(2 * start) - cos(2 * t)) - kinetic * (t - start)

    stop = brentq(speed, pi / 4 + 0.05, UNTIL)
    lasts = stop - start
    swing = cos(2 * start) * lasts - (sin(2 * stop) - sin(2 * start)) / 2
    return force / 2 * swing - kinetic * lasts**2 / 2


def rolled(force: float, held: float, kinetic: float) -> float:
    """Where a ball of 1 kg is that rolls, slips, and rolls again."""
    start = asin(held / force) / 2

    def lag(t: float) -> float:
        return force / 2 * (cos(2 * start) - cos(2 * t)) - 3.5 * kinetic * (t - start)

    def way(since: float, until: float, inertia: float, speed: float) -> tuple[float, float]:
        lasts, gain = until - since, force / 2 / inertia
        swing = cos(2 * since) * lasts - (sin(2 * until) - sin(2 * since)) / 2
        return speed * lasts + gain * swing, speed + gain * (cos(2 * since) - cos(2 * until))

    first, speed = way(0.0, start, 1.4, 0.0)
    stop = brentq(lag, pi / 4 + 0.02, UNTIL)
    second, gained = way(start, stop, 1.0, speed)
    lost = kinetic * (stop - start)
    third, _ = way(stop, UNTIL, 1.4, gained - lost)
    return first + second - lost * (stop - start) / 2 + third


def check_place(path: Trajectory, exact: float, over: float, preset: str) -> None:
    """The less a bound is exceeded, the less sharply its time is told."""
    off = abs(float(path.p[-1, 1, 0]) - exact)
    assert path.estimate is not None
    assert off <= 2 * path.estimate.position[-1] + 1e-13
    assert off < OFF[preset] or over < 1e-3


@pytest.mark.cases(8)
@PRESETS
@OVER
def test_a_box_slides_once_its_grip_was_exceeded_for_a_moment(preset: str, over: float) -> None:
    friction, base = "friction = { static = 0.4, kinetic = 0.3 }", "point = [0, 0, -0.05]"
    path = ran(BOX, "force", '["4*sin(2*t)", "0", "0"]', over, preset, friction, base)
    assert kinds(path) == ["slip-start", "slip-stop"]
    check_place(path, slid(4.0, 4 * (1 - over), 3 * (1 - over)), over, preset)


@pytest.mark.cases(8)
@PRESETS
@OVER
def test_a_ball_slips_once_its_grip_was_exceeded_for_a_moment(preset: str, over: float) -> None:
    path = ran(BALL, "force", '["7*sin(2*t)", "0", "0"]', over, preset, GRIPPING)
    assert kinds(path)[:2] == ["slip-start", "slip-stop"]
    check_place(path, rolled(7.0, 7 * (1 - over), 1 - over), over, preset)


@PRESETS
@OVER
def test_what_is_lifted_for_a_moment_leaves_and_comes_back(preset: str, over: float) -> None:
    path = ran(BALL, "force", '["0", "0", "10*sin(2*t)"]', over, preset)
    assert kinds(path) == ["lift-off", "touch-down"]
    assert path.events[0].t == pytest.approx(asin(1 - over) / 2, abs=1e-7 / sqrt(over))


@PRESETS
@OVER
def test_what_is_tipped_for_a_moment_leans_and_lies_down(
    preset: str, over: float, request: pytest.FixtureRequest
) -> None:
    if (preset, over) == ("fast", 1e-5):  # whether the corners land at once is decided by rounding
        reason = "a face that lands on all corners at once while they still carry it is not seen to lie"
        request.applymarker(pytest.mark.xfail(reason=reason, strict=False))
    path = ran(BOX, "torque", '["sin(2*t)", "0", "0"]', over, preset)
    told = kinds(path)
    assert told[0] == "tipping"
    assert "touch-down" in told
    assert path.events[-1].kind == "face-contact"


@PRESETS
def test_what_comes_near_its_bound_and_keeps_it_is_left_alone(preset: str) -> None:
    path = ran(BALL, "force", '["7*sin(2*t)", "0", "0"]', -1e-9, preset, GRIPPING)
    assert path.events == ()
    assert path.p[-1, 1, 0] == pytest.approx(2.5 * (UNTIL - sin(2 * UNTIL) / 2), abs=OFF[preset])
