"""Small scenes for the tests of require, dynamics and codegen."""

from __future__ import annotations

from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Scene

TABLE = '[[body]]\nname = "table"\nmotion = "fixed"\nshape = { kind = "plane" }\n'


def egg(name: str = "egg", axes: str = "[0.12, 0.09, 0.07]", more: str = "density = 1000.0") -> str:
    return f'[[body]]\nname = "{name}"\nshape = {{ kind = "ellipsoid", semi_axes = {axes} }}\n{more}\n'


def ball(name: str = "ball", shape: str = "", more: str = "density = 1000.0") -> str:
    return f'[[body]]\nname = "{name}"\nshape = {{ kind = "sphere", radius = 0.1{shape} }}\n{more}\n'


def contact(a: str, b: str, more: str = "") -> str:
    return f'[[contact]]\nbetween = ["{a}", "{b}"]\n{more}\n'


def scene(*parts: str, head: str = "") -> Scene:
    return read_text("\n".join((head, *parts)), "test.toml")


def ball_on_table(shape: str = "", more: str = "density = 1000.0", load: str = "", head: str = "") -> Scene:
    return scene(TABLE, ball("ball", shape, more), contact("ball", "table"), load, head=head)


WIDE = scene(
    TABLE.replace('"fixed"', '"driven"') + 'path = { position = ["0.1*sin(t)", "0", "0"], '
    'rotation_vector = ["0", "0", "t"] }\nposition = [0.0, 0.0, -0.1]\n',
    '[[body]]\nname = "wall"\nmotion = "fixed"\nshape = { kind = "plane" }\n'
    "position = [-1.0, 0.0, 0.0]\naxis_angle = { axis = [0.0, 1.0, 0.0], angle = 1.0 }\n",
    ball(more="density = 1000.0\nposition = [0.0, 0.0, 0.1]"),
    '[[body]]\nname = "egg"\nshape = { kind = "ellipsoid", semi_axes = [0.1, 0.2, 0.3], '
    "position = [0.0, 0.01, 0.0] }\nmass = 2.0\nposition = [0.4, 0.0, 1.0]\nangular_velocity = [1, 2, 3]\n"
    "inertia = [[0.1, 0.01, 0.0], [0.01, 0.12, 0.02], [0.0, 0.02, 0.15]]\n",
    '[[body]]\nname = "ring"\nshape = { kind = "torus", major = 0.3, minor = 0.05 }\ndensity = 500.0\n'
    "position = [0.0, 0.0, 2.0]\n",
    contact("table", "ball"),
    contact("ball", "egg"),
    contact("wall", "egg"),
    contact("ring", "egg"),
    '[[force]]\nbody = "egg"\nforce = ["sin(t)", "-vx", "2*qx"]\npoint = [0.0, 0.1, 0.0]\nframe = "body"\n',
    '[[force]]\nbody = "ball"\nforce = ["1", "x", "0"]\n',
    '[[torque]]\nbody = "ring"\ntorque = ["0", "wx", "0.1"]\n',
    '[[spring]]\nbetween = ["ball", "wall"]\nanchors = [[0, 0, 0], [0, 0, 1]]\nstiffness = 100.0\n'
    "damping = 1.0\nrest_length = 0.2\n",
    '[[spring]]\nbetween = ["ring", "egg"]\nanchors = [[0, 0, 0.1], [0, 0, 1]]\nstiffness = 100.0\n',
)  # every motion, inertia and load
