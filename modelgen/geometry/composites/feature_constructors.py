"""The conditions and features that composites are put together from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from modelgen.scene.scene_types import Condition, Feature, Pose, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

TILT = 2.0**-40  # of the wings of a thin plate or surface, out of it: tells its upper side from its lower one


def linear(point: Sequence[float] | Array, inward: Sequence[float] | Array, next: str | None) -> Condition:
    """The half-space through `point` (3) m that the unit vector `inward` (3) points into."""
    b = [float(entry) + 0.0 for entry in inward]  # no negative zeros
    c = 0.0 - sum(entry * float(at) for entry, at in zip(b, point, strict=True))
    return Condition("quadric", (c, *b, *(0.0,) * 6), next)


def within_circle(radius: float, next: str | None) -> Condition:
    """(radius^2 - x^2 - y^2)/(2 radius)."""
    bend = -0.5 / radius
    return Condition("quadric", (radius / 2, 0.0, 0.0, 0.0, bend, bend, 0.0, 0.0, 0.0, 0.0), next)


def beyond_circle(radius: float, next: str | None) -> Condition:
    """(x^2 + y^2 - radius^2)/(2 radius)."""
    inside = within_circle(radius, next)
    return Condition("quadric", tuple(0.0 - number for number in inside.numbers), next)


def above(z: float, next: str | None) -> Condition:
    return linear((0.0, 0.0, z), (0.0, 0.0, 1.0), next)


def below(z: float, next: str | None) -> Condition:
    return linear((0.0, 0.0, z), (0.0, 0.0, -1.0), next)


def at_least(index: int, bound: float, next: str | None) -> Condition:
    """eta_index >= bound."""
    return Condition("parameter", (float(index), 1.0, bound), next)


def at_most(index: int, bound: float, next: str | None) -> Condition:
    """eta_index <= bound."""
    return Condition("parameter", (float(index), -1.0, bound), next)


def wing(outward: float, along_z: float, face: str) -> Condition:
    """The wing outward (T x z) + along_z z into `face`."""
    return Condition("wing", (outward, along_z), face)


def smooth(kind: str, pose: Pose, **parameters: float) -> Shape:
    """A shape of the catalogue; parameters in its order."""
    return Shape(kind, tuple(parameters.items()), pose=pose, name=kind)


def face(name: str, shape: Shape, *conditions: Condition) -> Feature:
    return Feature(name, 2, shape, conditions)


def edge(name: str, shape: Shape, *conditions: Condition) -> Feature:
    return Feature(name, 1, shape, conditions)


def vertex(name: str, at: Sequence[float] | Array, *conditions: Condition) -> Feature:
    x, y, z = (float(entry) for entry in at)
    return Feature(name, 0, smooth("point", Pose(), x=x, y=y, z=z), conditions)


def turned(condition: Condition, rotation: Array) -> Condition:
    """A condition of the normal at a point, in other axes. Those of the place are as they were."""
    if condition.kind not in ("direction", "tip", "tilt"):
        return condition
    x, y, z = map(float, rotation @ np.array(condition.numbers[:3]))
    return replace(condition, numbers=(x, y, z, *condition.numbers[3:]))
