"""A light ball between its floor and a heavy one: thousands of impacts, closer and closer, to their end."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.scene.read import read_text
from tests.running import library_of

GRAVITY = 9.81

SQUEEZED = """
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "light"
mass = 1.0
inertia = [0.001, 0.001, 0.001]
shape = {{ kind = "sphere", radius = 0.05 }}
position = [0, 0, {low}]
[[body]]
name = "heavy"
mass = {mass}
inertia = [1.0, 1.0, 1.0]
shape = {{ kind = "sphere", radius = 0.1 }}
position = [0, 0, {high}]
[[contact]]
between = ["light", "floor"]
restitution = {e}
[[contact]]
between = ["heavy", "light"]
restitution = {e}
"""


def squeezed(gap: float, fall: float, mass: float, e: float, until: float) -> tuple[float, float]:
    """m, at time `until`: height of a light ball over its floor, and of one of `mass` times its mass over it.

    They start from `gap` and `fall` at rest and fly on parabolas from impact to impact.
    (0, 0): both have come to rest.
    """
    time, light, heavy, impacts = 0.0, 0.0, 0.0, 0
    while gap + fall > 1e-15 * (1 + impacts / 1000) or abs(light) + abs(heavy) > 1e-7:
        to_floor = (light + np.sqrt(light * light + 2 * GRAVITY * gap)) / GRAVITY
        to_light = fall / (light - heavy) if light > heavy else np.inf
        step = min(to_floor, to_light, until - time)
        gap, fall = gap + light * step - GRAVITY / 2 * step**2, fall + (heavy - light) * step
        light, heavy = light - GRAVITY * step, heavy - GRAVITY * step
        time, impacts = time + step, impacts + 1
        if time >= until:
            return gap, fall
        if to_floor < to_light:
            gap, light = 0.0, -e * light
        else:
            push = (1 + e) * (light - heavy) * mass / (1 + mass)
            fall, light, heavy = 0.0, light - push, heavy + push / mass
    return 0.0, 0.0


@pytest.mark.parametrize("member", range(12))
def test_a_light_ball_between_floor_and_heavy_ball_is_followed_to_the_end_of_its_bounces(member: int) -> None:
    random = np.random.default_rng([7, member])
    gap, fall = 10 ** random.uniform(-3, -1), random.uniform(0.05, 0.3)
    mass, e = 10 ** random.uniform(1, 3.3), random.uniform(0.8, 0.98)
    until = 1.2 * float(np.sqrt(2 * (gap + fall) / GRAVITY))
    text = SQUEEZED.format(low=0.05 + gap, high=0.2 + gap + fall, mass=mass, e=e)
    path = simulate(library_of(read_text(text, "squeezed.toml")), until=until)
    height = path.p[-1, :, 2]
    assert path.is_trusted
    assert path.estimate is not None
    assert path.fallback_time == 0
    error = 4 * path.estimate.position[-1] + 1e-13  # rounding of the judge
    assert (height[1] - 0.05, height[2] - height[1] - 0.15) == pytest.approx(
        squeezed(gap, fall, mass, e, until), abs=error
    )
