"""Scenes whose numbers are fitted in tests, and recordings of their runs with noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from modelgen import derive, emit, require, sensitivity
from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.running import compiled

Array = np.ndarray[Any, Any]

BOUNCE = """
[[parameter]]
name = "friction"
value = 0.1
minimum = 0.0
maximum = 0.5
[[parameter]]
name = "restitution"
value = 0.7
minimum = 0.0
maximum = 1.0

[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.05 }
density = 900.0
position = [0.0, 0.0, 0.35]
velocity = [1.0, 0.2, 0.0]
angular_velocity = [10.0, -60.0, 0.0]

[[contact]]
between = ["ball", "floor"]
friction = "friction"
restitution = "restitution"
"""
ROLL = """
gravity = ["g*sin(slope)", 0.0, "-g*cos(slope)"]
[[parameter]]
name = "friction"
value = 0.2
minimum = 0.01
maximum = 1.0
[[parameter]]
name = "resistance"
value = 5e-4
minimum = 1e-5
maximum = 5e-3
[[parameter]]
name = "slope"
value = 0.02
minimum = -0.2
maximum = 0.2
[constants]
g = 9.81

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.03 }
density = 2700.0
position = [0.0, 0.0, 0.03]
velocity = [1.0, 0.3, 0.0]

[[contact]]
between = ["ball", "table"]
friction = "friction"
rolling_resistance = "resistance"
"""
SPRINGS = """
[[parameter]]
name = "stiffness"
value = 3.0
minimum = 0.5
maximum = 20.0
unit = "N m/rad"
[[parameter]]
name = "damping"
value = 0.02
minimum = 0.0
maximum = 0.2
[[parameter]]
name = "mass"
value = 0.4
minimum = 0.1
maximum = 2.0

[[body]]
name = "upper"
mass = 0.5
inertia = [0.01, 0.01, 0.01]
position = [0.15, 0.0, 0.0]
[[body]]
name = "lower"
mass = "mass"
inertia = [0.005, 0.005, 0.005]
position = [0.45, 0.0, 0.0]

[[joint]]
kind = "revolute"
name = "shoulder"
between = ["world", "upper"]
rpy = [1.5707963267948966, 0.0, 0.0]
stiffness = "stiffness"
damping = "damping"
[[joint]]
kind = "revolute"
name = "elbow"
between = ["upper", "lower"]
position = [0.3, 0.0, 0.0]
rpy = [1.5707963267948966, 0.0, 0.0]

[[spring]]
between = ["upper", "lower"]
stiffness = 20.0
rest_length = 0.2

[[sensor]]
name = "shoulder_angle"
of = "shoulder.coordinate"
[[sensor]]
name = "elbow_angle"
of = "elbow.coordinate"
"""
RATIO = """
gravity = [0.0, 0.0, 0.0]
[[parameter]]
name = "mass"
value = 2.0
minimum = 0.1
maximum = 20.0
[[parameter]]
name = "stiffness"
value = 50.0
minimum = 1.0
maximum = 1000.0

[[body]]
name = "frame"
motion = "fixed"
[[body]]
name = "block"
mass = "mass"
inertia = [0.01, 0.01, 0.01]
position = [0.3, 0.0, 0.0]

[[spring]]
between = ["frame", "block"]
stiffness = "stiffness"
rest_length = 0.2
"""


@dataclass(frozen=True)
class Motion:
    """A scene, what of it is recorded with which noise, and what is fitted."""

    text: str
    of: tuple[str, ...]
    noise: dict[str, float]
    by: tuple[str, ...]
    until: float  # s
    rows: int = 60

    @property
    def library(self) -> Library:
        return library_of_text(self.text)

    @property
    def t(self) -> Array:
        return np.linspace(0.0, self.until, self.rows)

    def recording(self, seed: int | None = None) -> dict[str, Array]:
        """The columns of a run with the scene's values, with noise where there is a seed."""
        shown = _shown(self.text, self.of, self.by, self.until, self.rows)
        columns = dict(shown)
        if seed is not None:
            random = np.random.default_rng(seed)
            columns = {
                name: values + self._noise_of(name) * random.normal(size=values.shape)
                for name, values in columns.items()
            }
        return {"t": self.t, **columns}

    def _noise_of(self, name: str) -> float:
        return next(size for key, size in self.noise.items() if name == key or name.startswith(f"{key}_"))

    def other_guess(self, seed: int) -> dict[str, float]:
        """Values of the parameters anywhere in their ranges."""
        random = np.random.default_rng(seed)
        ranges = [(each["minimum"], each["maximum"]) for each in self._kinds()]
        return {name: float(random.uniform(*ends)) for name, ends in zip(self.by, ranges, strict=True)}

    def near_guess(self, seed: int) -> dict[str, float]:
        """Values of the parameters within half of the truth."""
        factors = np.random.default_rng(seed).uniform(0.5, 1.5, len(self.by))
        largest = [each["maximum"] for each in self._kinds()]
        values = np.minimum(factors * self.true_values, largest)
        return dict(zip(self.by, values.tolist(), strict=True))

    @property
    def true_values(self) -> Array:
        return np.array([each["value"] for each in self._kinds()])

    def _kinds(self) -> list[dict[str, Any]]:
        known = {each["name"]: each for each in self.library.manifest.instance["parameters"]}
        return [known[name] for name in self.by]


@cache
def library_of_text(text: str) -> Library:
    return compiled(emit(derive(require(read_text(text, "motion.toml"))), derivatives=True))


@cache
def _shown(
    text: str, of: tuple[str, ...], by: tuple[str, ...], until: float, rows: int
) -> tuple[tuple[str, Array], ...]:
    found = sensitivity(library_of_text(text), np.linspace(0.0, until, rows), of=of, by=by[:1])
    return tuple(zip(found.of, found.value.T, strict=True))


MOTIONS = {
    "bounce": Motion(
        BOUNCE,
        ("ball.position", "ball.angular_velocity"),
        {"ball.position": 2e-3, "ball.angular_velocity": 0.5},
        ("friction", "restitution"),
        1.0,
    ),
    "roll": Motion(
        ROLL, ("ball.position",), {"ball.position": 1e-3}, ("friction", "resistance", "slope"), 1.5
    ),
    "springs": Motion(
        SPRINGS,
        ("shoulder_angle", "elbow_angle"),
        {"shoulder_angle": 5e-3, "elbow_angle": 5e-3},
        ("stiffness", "damping", "mass"),
        1.2,
        40,
    ),
}
