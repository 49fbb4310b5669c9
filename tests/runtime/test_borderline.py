"""Decisions closer than the error of a step: feature changes, stick and slip at `fast`, where it is large."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.random import default_rng

from modelgen import simulate_batch
from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.running import library_of

Array = np.ndarray[Any, np.dtype[np.float64]]

FLOOR = '[run]\nuntil = 1.0\n[[body]]\nname = "floor"\nmotion = "fixed"\nshape = { kind = "plane" }\n'
BENT = """
[[body]]
name = "ring"
mass = 0.15
inertia = [0.00051, 0.00071, 0.00059]
position = [0, 0, 0.12]
[body.shape]
kind = "bspline_curve"
periodic = true
points = [[0.07, 0, 0], [0, 0.06, 0.02], [-0.07, 0, 0], [0, -0.06, -0.02]]
[[contact]]
between = ["ring", "floor"]
friction = 0.9
"""
ARCH = """
[[body]]
name = "arch"
shape = { kind = "half_torus", major = 0.07, minor = 0.03312 }
mass = 1.0
inertia = [0.0037, 0.0045, 0.0041]
position = [0, 0, 0.2]
[[contact]]
between = ["arch", "floor"]
friction = 0.5
restitution = 0.3
"""
LYING = """
[[body]]
name = "north"
motion = "fixed"
position = [0, 0.6, 0]
axis_angle = { axis = [1, 0, 0], angle = 1.5707963267948966 }
shape = { kind = "plane" }
[[body]]
name = "ring"
shape = { kind = "ellipse_curve", semi_axes = [0.0408, 0.0449] }
mass = 0.185687
inertia = [0.000781982564177, 0.000820699339789, 0.000767756965103]
position = [0.5349864590924761, 0.5551409706236112, 0.0005212248735017411]
quaternion = [0.04929410465450795, 8.177555477744051e-05, -0.00580443523090006, -0.9987674369395105]
velocity = [0.005318732287630867, -0.00017534852167016727, -0.04575754421840063]
angular_velocity = [0.3453939630222294, 9.710312010199093, 0.005709719083089135]
[[contact]]
between = ["ring", "floor"]
friction = 0.1786
restitution = 0.238
[[contact]]
between = ["ring", "north"]
friction = 0.6399
"""


def built(text: str, name: str) -> tuple[Library, Any]:
    library = library_of(read_text(FLOOR + text, name))
    return library, library.manifest.instance


def thrown(n: int) -> tuple[Array, Array]:
    """Starts in any pose, q (n, 7) and u (n, 6)."""
    q, u = np.zeros((n, 7)), np.zeros((n, 6))
    for k in range(n):
        rng = default_rng(k)
        turn = rng.normal(size=4)
        q[k, :3], q[k, 3:] = (0, 0, 0.12), turn / np.linalg.norm(turn)
        u[k, :3], u[k, 3:] = rng.normal(size=3) / 2, 3 * rng.normal(size=3)
    return q, u


def test_a_bent_ring_stays_on_the_floor_wherever_its_pieces_join() -> None:
    """A contact that the error of a step alone puts beyond the end of its piece was given up."""
    library, _ = built(BENT, "bent ring")
    ends = simulate_batch(library, *thrown(24), until=1.0, accuracy="fast")
    assert all(outcome.succeeded for outcome in ends.outcomes)
    assert ends.q[:, 2].min() > 0


def test_an_arch_that_falls_flat_lies_on_its_crest() -> None:
    """Flat, it has no lowest point: it fell through as soon as both its ends had left."""
    library, _ = built(ARCH, "arch")
    ends = simulate_batch(library, *thrown(40), until=1.0, accuracy="fast")
    assert all(outcome.succeeded for outcome in ends.outcomes)
    assert ends.q[:, 2].min() > -1e-6


def test_a_ring_that_lies_almost_flat_turns_on_past_the_point_at_the_wall() -> None:
    """It hardly slips at floor and wall, which it touches at nearly one point: two would stop it."""
    library, instance = built(LYING, "lying ring")
    q, u = (np.array([instance[key]] * 8) for key in ("initial_q", "initial_u"))
    u[:, 4] *= 1 + 1e-4 * np.arange(8)
    ends = simulate_batch(library, q, u, until=0.01, accuracy="fast")
    assert ends.energy_drift.max() < 1e-5
