"""Loads that a body feels in a narrow place are not stepped over, against the integral of energy."""

from __future__ import annotations

from collections.abc import Callable
from math import acos, exp, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

LEVELS = pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
SHAPES = {
    "ball": 'shape = { kind = "sphere", radius = 0.1 }\nposition = [0.0, 0.0, 0.1]',
    "box": 'shape = { kind = "box", size = [0.2, 0.2, 0.2] }\nposition = [0.0, 0.0, 0.1]',
}
TEXT = """
[[body]]
name = "plane"
shape = {{ kind = "plane" }}
motion = "fixed"

[[body]]
name = "body"
{shape}
mass = 1.0
inertia = [4e-3, 4e-3, 4e-3]
velocity = [1.0, 0.0, 0.0]

[[contact]]
between = ["body", "plane"]

[[force]]
body = "body"
force = ["{force}", 0.0, 0.0]
"""


def slid(shape: str, force: str, accuracy: str, until: float = 2.0) -> Trajectory:
    """At 1 m/s along x on a plane without friction."""
    scene = read_text(TEXT.format(shape=SHAPES[shape], force=force), "place.toml")
    return simulate(library_of(scene), until=until, accuracy=accuracy, samples=40)


def place_at(time: float, work: Callable[[float], float], bends: list[float]) -> float:
    """Where a mass of 1 kg is that does work(x) on its way, with bends of the integrand there."""

    def taken(x: float) -> float:
        return float(
            quad(lambda y: 1 / sqrt(1 - 2 * work(y)), 0, x, points=bends, epsabs=1e-14, limit=200)[0]
        )

    return float(brentq(lambda x: taken(x) - time, 0, 2 * time, xtol=1e-14))


def check_arrives(path: Trajectory, work: Callable[[float], float], bends: list[float]) -> None:
    body = path.body_names.index("body")
    assert path.estimate is not None
    assert path.estimate.status == "estimated"
    error = abs(float(path.p[-1, body, 0]) - place_at(float(path.t[-1]), work, bends))
    assert error < 5 * path.position_error[-1] + 1e-12
    assert error < 2e-3


@pytest.mark.cases(4)
@LEVELS
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("width", [0.02, 0.04, 0.09])
@pytest.mark.parametrize("start", [0.31, 0.7])
def test_a_strip_brakes_what_slides_across(start: float, width: float, shape: str, accuracy: str) -> None:
    """With 5 N; at 1 m/s each of these strips is passed within a characteristic time."""
    path = slid(shape, f"-2.5*(sign(x - {start}) - sign(x - {start + width}))", accuracy)
    check_arrives(path, lambda x: 5 * min(max(x - start, 0), width), [start, start + width])


@LEVELS
@pytest.mark.parametrize("width", [0.01, 0.02, 0.05])
def test_a_narrow_hill_is_climbed(width: float, accuracy: str) -> None:
    """0.4 J exp(-s^2), s = (x - 0.63) / width: most of the 0.5 J that the body has."""
    s = f"((x - 0.63)/{width})"
    path = slid("ball", f"0.8/{width}*{s}*exp(-{s}**2)", accuracy)
    check_arrives(
        path, lambda x: 0.4 * exp(-(((x - 0.63) / width) ** 2)), [0.63 - 3 * width, 0.63, 0.63 + 3 * width]
    )


@LEVELS
def test_a_strip_passed_at_another_time_of_the_same_step_is_seen(accuracy: str) -> None:
    """Wherever the steps fall: 10 ms in the strip, two looks."""
    library = library_of(
        read_text(TEXT.format(shape=SHAPES["ball"], force="-2.5*(sign(x-0.7)-sign(x-0.71))"), "place.toml")
    )
    for until in np.linspace(1.0, 3.0, 25):
        path = simulate(library, until=float(until), accuracy=accuracy, samples=2, estimate=False)
        assert path.v[-1, path.body_names.index("body"), 0] == pytest.approx(sqrt(0.9), abs=1e-3)


@pytest.mark.cases(9)
@LEVELS
@pytest.mark.parametrize("rate", [0.1, 1.0])
@pytest.mark.parametrize("depth", [1e-5, 1e-4, 1e-3])
def test_a_place_entered_just_where_the_body_turns_back_is_seen(
    depth: float, rate: float, accuracy: str
) -> None:
    """x = sin(rate t) / 10; where it is within `depth` of the turn, y is pushed."""
    turn, until = 0.1, 3 / rate
    push = f"10*max(0, (x - {turn - depth})/{depth})"
    text = TEXT.format(shape=SHAPES["ball"], force=f"-{rate**2}*x")
    text = text.replace("velocity = [1.0, 0.0, 0.0]", f"velocity = [{rate * turn}, 0.0, 0.0]")
    text = text.replace(f'"-{rate**2}*x", 0.0, 0.0', f'"-{rate**2}*x", "{push}", 0.0')
    path = simulate(library_of(read_text(text, "turn.toml")), until=until, accuracy=accuracy, samples=40)
    half = acos(1 - depth / turn) / rate
    at = pi / 2 / rate
    impulse = quad(
        lambda t: 10 * (turn * sin(rate * t) - turn + depth) / depth, at - half, at + half, epsabs=0
    )[0]
    assert path.estimate is not None
    error = abs(float(path.p[-1, path.body_names.index("body"), 1]) - impulse * (until - at))
    assert error < 10 * path.position_error[-1] + 1e-12 or path.t[-1] > path.estimate.horizon
    assert accuracy == "fast" or error < 1e-3 * impulse * until
