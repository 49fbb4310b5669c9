"""Characteristic length, mass and time of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, sqrt

from modelgen.geometry.catalogue import surface_of
from modelgen.model import Scales
from modelgen.pruning import contacting_shapes
from modelgen.scene.types import Body, Scene


def scales_of(scene: Scene, moving: Sequence[tuple[Body, float]]) -> Scales:
    """Of a scene whose moving bodies have these masses (kg).

    length: the least bounding radius of a moving body's contacting shapes (m); of any shape if none is finite.
    mass: the largest. time: sqrt(length/g), or length/speed where there is no gravity.
    """
    radii = [_radius(scene, body) for body, _ in moving] + [inf]
    length = min(radii)
    if length == inf:
        length = min([_radius(scene, body) for body in scene.bodies] + [inf])
    length = 1.0 if length == inf else length
    mass = max((mass for _, mass in moving), default=1.0)
    return Scales(length, mass, _time(scene, [body for body, _ in moving], length))


def _radius(scene: Scene, body: Body) -> float:
    shapes = contacting_shapes(scene, body)
    values = [surface_of(shape).bounding([value for _, value in shape.parameters]) for shape in shapes]
    return max((value for value in values if value < inf), default=inf)


def _time(scene: Scene, moving: Sequence[Body], length: float) -> float:
    gravity = hypot(*scene.gravity)
    if gravity > 0:
        return sqrt(length / gravity)
    speed = max(
        (hypot(*body.velocity) + length * hypot(*body.angular_velocity) for body in moving), default=0.0
    )
    return length / speed if speed > 0 else 1.0
