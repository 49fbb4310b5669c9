"""Characteristic length, mass and time of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, sqrt

import numpy as np

from modelgen.assembly.body_motions import contacting_shapes, pairs_by_body
from modelgen.assembly.initial_motion_rate import initial_motion_rate
from modelgen.assembly.masses import Mass
from modelgen.geometry.extent import bounding_radius
from modelgen.model import Scales
from modelgen.scene.scene_types import Body, ContactPair, Scene, SpringLoad

FAINT = 1e5  # times as long


def scales_of(scene: Scene, moving: Sequence[tuple[Body, Mass]]) -> Scales:
    """Characteristic length (m), mass (kg) and time (s) of a scene with these moving bodies and their masses.

    length: the least radius of a moving body (m), by its contacting shapes, or of the uniform sphere of its
    inertia where they have no bound, or are points; of any body if that is infinite too, else what the scene
    extends over. mass: the largest.
    time: sqrt(length/g); without gravity length/speed; where nothing moves either, by what sets it in motion:
    loads, springs, paths; the span of the run if nothing does. What would take FAINT times as long as what
    comes after it here, or gravity as the run, does not count.
    """
    pairs = pairs_by_body(scene)
    radii = [_radius(body, pairs[body.name]) for body, _ in moving]
    radii = [_of_inertia(mass) if r == inf else r for r, (_, mass) in zip(radii, moving, strict=True)]
    length = min(radii, default=inf)
    if length == inf:
        length = min((_radius(body, pairs[body.name]) for body in scene.bodies), default=inf)
    length = _spread(scene) if length == inf else length
    largest = max((mass.mass for _, mass in moving), default=1.0)
    return Scales(length, largest, _time(scene, moving, length))


def flush_height(scene: Scene, scales: Scales) -> float:
    """Height (m) up to which surfaces of shapes that are fixed together are one."""
    return scene.run.flush_height * scales.length


def _radius(body: Body, pairs: Sequence[ContactPair]) -> float:
    shapes = contacting_shapes(body, pairs)
    values = [bounding_radius(shape) for shape in shapes]
    return max((value for value in values if 0 < value < inf), default=inf)


def _spread(scene: Scene) -> float:
    """Length scale of a scene of points: distances of bodies, lengths of springs, or the path covered in the
    run (m)."""
    start = np.array([body.pose.position for body in scene.bodies] or [(0.0, 0.0, 0.0)])
    rests = [load.rest_length for load in scene.loads if isinstance(load, SpringLoad)]
    spread = max(float(np.ptp(start, axis=0).max()), *rests, 0.0)
    moved = max((hypot(*body.velocity) for body in scene.bodies), default=0.0) * scene.run.until
    return spread or moved or hypot(*scene.gravity) * scene.run.until**2 or 1.0


def _of_inertia(mass: Mass) -> float:
    """Radius (m) of the uniform sphere of the same mass and mean moment 2/5 m r^2."""
    if mass.inertia is None:
        return inf
    return sqrt(5 / 6 * float(np.trace(mass.inertia)) / mass.mass)


def _time(scene: Scene, moving: Sequence[tuple[Body, Mass]], length: float) -> float:
    gravity = hypot(*scene.gravity)
    speeds = (hypot(*body.velocity) + length * hypot(*body.angular_velocity) for body, _ in moving)
    moved = max(speeds, default=0.0) / length
    if sqrt(gravity / length) > max(moved, 1 / scene.run.until) / FAINT:
        return sqrt(length / gravity)
    driven = initial_motion_rate(scene, moving, length) or 0.0
    return 1 / (moved if moved > driven / FAINT else driven or 1 / scene.run.until)
