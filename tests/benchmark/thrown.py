"""A ball in flight: the least there is to measure, for what a measurement says and keeps."""

from __future__ import annotations

from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Scene

TEXT = """gravity = [0.0, 0.0, -9.81]

[run]
until = 0.2
samples = 4

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
mass = 0.7
inertia = [0.0028, 0.003, 0.0031]
position = [0.0, 0.0, 1.0]
velocity = [1.0, 0.0, 2.0]
angular_velocity = [3.0, 5.0, 1.0]
"""


def thrown(text: str = TEXT, name: str = "thrown") -> Scene:
    """The scene, under a name of its own."""
    return read_text(text, f"{name}.toml")
