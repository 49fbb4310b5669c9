"""Characteristic length, mass and time of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, sqrt

import numpy as np

from modelgen.geometry.extent import bounding_radius
from modelgen.model import Scales
from modelgen.require.masses import Mass
from modelgen.require.pruning import contacting_shapes
from modelgen.scene.types import Body, Scene


def scales_of(scene: Scene, moving: Sequence[tuple[Body, Mass]]) -> Scales:
    """Of a scene with these moving bodies and their masses.

    length: the least radius of a moving body (m), by its contacting shapes, or of the uniform sphere of its
    inertia where they have no bound, or are points; of any body if that is infinite too. mass: the largest.
    time: sqrt(length/g), or length/speed where there is no gravity.
    """
    radii = [_radius(scene, body) for body, _ in moving]
    radii = [_of_inertia(mass) if r == inf else r for r, (_, mass) in zip(radii, moving, strict=True)]
    length = min(radii, default=inf)
    if length == inf:
        length = min((_radius(scene, body) for body in scene.bodies), default=inf)
    length = 1.0 if length == inf else length
    largest = max((mass.mass for _, mass in moving), default=1.0)
    return Scales(length, largest, _time(scene, [body for body, _ in moving], length))


def _radius(scene: Scene, body: Body) -> float:
    shapes = contacting_shapes(scene, body)
    values = [bounding_radius(shape) for shape in shapes]
    return max((value for value in values if 0 < value < inf), default=inf)


def _of_inertia(mass: Mass) -> float:
    """Radius (m) of the uniform sphere of the same mass and mean moment 2/5 m r^2."""
    if mass.inertia is None:
        return inf
    return sqrt(5 / 6 * float(np.trace(mass.inertia)) / mass.mass)


def _time(scene: Scene, moving: Sequence[Body], length: float) -> float:
    gravity = hypot(*scene.gravity)
    if gravity > 0:
        return sqrt(length / gravity)
    speed = max(
        (hypot(*body.velocity) + length * hypot(*body.angular_velocity) for body in moving), default=0.0
    )
    return length / speed if speed > 0 else 1.0
