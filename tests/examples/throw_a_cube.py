"""Throw a cube so that it ends on a given face, at a given place.

    python -m tests.examples.throw_a_cube

Velocity and spin are sought by Gauss and Newton's method with the derivatives of the run, through a blow of a
corner with friction and restitution. Wanted is that the cube is at its place some time after, lies as on the
face, and does not tumble; whether it comes to rest on that face is looked at in a longer run.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares

from modelgen import build, derive, emit, require, sensitivity, simulate
from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.examples.plan_example import Array, upright
from tests.running import with_velocity

SCENE = """
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "cube"
shape = { kind = "box", size = [0.1, 0.1, 0.1] }
density = 400.0
position = [0.0, 0.0, 0.3]
rpy = [0.3, 0.2, 0.1]

[[contact]]
between = ["cube", "floor"]
friction = 0.3
restitution = 0.1

[[sensor]]
name = "q"
of = "cube.orientation"

[[sensor]]
name = "tilt_x"  # the vertical in the axes of the cube, less their x: zero with the face +x upwards
value = "2*(q_x*q_z - q_w*q_y) - 1"

[[sensor]]
name = "tilt_y"
value = "2*(q_y*q_z + q_w*q_x)"

[[sensor]]
name = "tilt_z"
value = "1 - 2*(q_x**2 + q_y**2)"
"""
EARLY, UNTIL, REST = 0.38, 0.5, 2.5  # s: while it tips after the first blow; when it has tipped; at rest
PLACE = (0.35, 0.05)  # m, at UNTIL
FIRST = np.array([1.04, 0.04, 0.5, -0.6, -4.8, -0.1])  # m/s, rad/s
SPREAD = np.array([0.1, 0.1, 0.1, 0.3, 0.3, 0.3])
ELSEWHERE = np.array([0.8, 0.0, 0.1, 0.3, -3.5, -0.7])  # a throw that ends on another face
WEIGHTS = np.repeat([1.0, 0.02, 5e-4], (2, 3, 2))  # of place, tilt, and tumbling
REACHED = 1e-3  # m
BY = ["cube.velocity", "cube.angular_velocity"]
OF = ["cube.position", "tilt_x", "tilt_y", "tilt_z", "cube.angular_velocity"]


class CubeThrow:
    """What a throw misses, with a count of runs."""

    def __init__(self, library: Library) -> None:
        self._library, self.runs, self.until = library, 0, UNTIL

    def thrown(self, throw: Array) -> Library:
        """The library with another start."""
        return with_velocity(self._library, "cube", throw)

    def residual(self, throw: Array) -> Array:
        """(7,) of the place, m, the tilt, and the tumbling, weighed."""
        self.runs += 1
        found = _weighed(sensitivity(self.thrown(throw), self.until, of=OF, by=[]).value[0])
        found[:2] -= PLACE
        return found

    def slope(self, throw: Array) -> Array:
        """(7, 6), by the throw."""
        return _weighed(sensitivity(self.thrown(throw), self.until, of=OF, by=BY).jacobian[0])

    def reached(self, throw: Array) -> bool:
        """At its place, and, of a run until rest, on the face."""
        return bool(np.hypot(*self.residual(throw)[:2]) < REACHED and self.ends_on_the_face(throw))

    def ends_on_the_face(self, throw: Array) -> bool:
        """Of a run until rest."""
        path = simulate(self.thrown(throw), until=REST, samples=2, estimate=False)
        return bool(upright(path.quaternion[-1, 1])[0] > 0.999)


def _weighed(shown: Array) -> Array:
    """Place, tilts, and tumbling about the axes of the cube that lie flat, of the components of OF."""
    return (WEIGHTS * shown[[0, 1, 3, 4, 5, 7, 8]].T).T


def problem() -> CubeThrow:
    scene = read_text(SCENE, "throw_a_cube.toml")
    return CubeThrow(build(emit(derive(require(scene)), derivatives=True), level="O1"))


def perturbed(random: np.random.Generator) -> Array:
    """Another throw to begin with."""
    return FIRST + SPREAD * random.normal(size=6)


def by_derivatives(throw: CubeThrow, start: Array) -> Array:
    return searched(throw, start, throw.slope)


def searched(throw: CubeThrow, start: Array, slope: Any) -> Array:
    """By Gauss and Newton's method, first at a time at which the cube tips and a change of the throw is seen
    in its tilt: once it lies on another face, none is."""
    found = start
    for throw.until, most in ((EARLY, 20), (UNTIL, 40)):
        found = least_squares(throw.residual, found, jac=slope, x_scale=SPREAD, max_nfev=most).x
    return np.asarray(found)


if __name__ == "__main__":
    throw = problem()
    found = by_derivatives(throw, FIRST)
    print(f"thrown with {found[:3].round(4)} m/s and {found[3:].round(3)} rad/s, found in {throw.runs} runs")
    print(f"misses its place by {np.hypot(*throw.residual(found)[:2]):.1e} m")
    print(f"ends on the face: {throw.ends_on_the_face(found)}")
