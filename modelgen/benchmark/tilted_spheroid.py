"""A spheroid that touches the plane z = 0, leaning from upright about the x axis."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin, sqrt

from modelgen.scene.python_scenes import dynamic, ellipsoid
from modelgen.scene.scene_types import Body


def tilted_spheroid(a: float, c: float, turned: float, angular_velocity: Sequence[float]) -> Body:
    """The body "egg" with the semi-axes a, a, c in m, turned by an angle in rad."""
    return dynamic(
        "egg",
        ellipsoid(a, a, c),
        density=1000.0,
        position=[0.0, 0.0, sqrt((a * sin(turned)) ** 2 + (c * cos(turned)) ** 2)],
        rpy=[turned, 0.0, 0.0],
        angular_velocity=list(angular_velocity),
    )
