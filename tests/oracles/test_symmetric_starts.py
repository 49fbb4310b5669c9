"""Bodies that start where all points of a curve are nearest to them: their first strike in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.running import library_of

ACROSS = [float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0]  # a quarter turn about x
STARTS = {  # what stands, what moves along `way`, whence, how it is turned; and how far until it strikes (m)
    "ring on a post": (make.cylinder(0.5), make.torus(1.0, 0.3), "x", {}, 0.2),
    "link in a link": (
        make.torus(1.0, 0.3), make.torus(1.0, 0.65), "y", {"position": [1, 0, 0], "quaternion": ACROSS}, 0.05,
    ),
    "ring in a ring": (make.torus(2.0, 0.5, cavity=True), make.torus(2.0, 0.45), "x", {}, 0.05),
    "ball in a bore": (make.cylinder(1.0, cavity=True), make.sphere(0.9), "x", {}, 0.1),
    "ball in a ring": (
        make.torus(2.0, 0.5, cavity=True), make.sphere(0.4), "x", {"position": [2, 0, 0]}, 0.1,
    ),
    "spheroid in a bore": (make.cylinder(1.0, cavity=True), make.ellipsoid(0.9, 0.9, 1.5), "x", {}, 0.1),
    "spheroid in a spheroid": (
        make.ellipsoid(1.0, 1.0, 1.4, cavity=True), make.ellipsoid(0.9, 0.9, 1.1), "x", {}, 0.1,
    ),
}  # fmt: skip


def moved(stands: Shape, moves: Shape, way: str, pose: dict[str, object], gap: float) -> Trajectory:
    """A run for twice the time that the gap takes."""
    velocity = [0.1 * (axis == way) for axis in "xyz"]
    body = make.dynamic("body", moves, mass=1.0, inertia=[0.4, 0.4, 0.4], velocity=velocity, **pose)
    scene = make.scene(
        "symmetric", [make.fixed("world", stands), body], gravity=[0, 0, 0],
        contact=[{"between": ["body", "world"], "restitution": 0.5}],
    )  # fmt: skip
    return simulate(library_of(scene), until=20 * gap, samples=20)


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", STARTS)
def test_a_body_on_an_axis_of_symmetry_strikes_when_it_has_crossed_the_gap(name: str) -> None:
    stands, moves, way, pose, gap = STARTS[name]
    path = moved(stands, moves, way, pose, gap)
    assert path.outcome is Outcome.DONE
    assert not path.doubts
    struck = [event.t for event in path.events if event.kind == "impact"]
    assert struck[0] == pytest.approx(10 * gap, abs=1e-9)


def test_a_ring_on_too_thick_a_post_is_refused() -> None:
    with pytest.raises(SimulationError):
        moved(make.cylinder(0.71), make.torus(1.0, 0.3), "x", {}, 0.1)
