"""A scene with parameters, an input and sensors, whose runs end in several ways."""

from __future__ import annotations

from functools import cache

from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.running import library_of

BALL = """
[run]
until = 0.5

[[parameter]]
name = "friction"
value = 0.3
minimum = 0.0
maximum = 1.0

[[parameter]]
name = "height"
value = 0.3
minimum = 0.0

[[input]]
name = "push"
minimum = -5
maximum = 5

[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.05 }
density = 900.0
position = [0.0, 0.0, "height"]
velocity = [1.0, 0.0, 0.0]

[[contact]]
between = ["ball", "floor"]
friction = "friction"
restitution = 0.5

[[force]]
body = "ball"
force = ["push", "0.01*sqrt(0.6 - x)", "0"]

[[sensor]]
name = "place"
of = "ball.position"

[[sensor]]
name = "far"
value = "abs(place_x)"
"""


@cache
def ball() -> Library:
    """A ball that is thrown onto a floor: refused from below its radius, not finite beyond x = 0.6 m."""
    return library_of(read_text(BALL, "ball.toml"))
