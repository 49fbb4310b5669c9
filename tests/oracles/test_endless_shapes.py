"""Shapes without an end: a plane, which they touch along a line or pass through, and the tip of a cone."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from modelgen.assembly import require
from modelgen.errors import SceneError, SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import TABLE, G, ball, ran

ANGLE = 0.5  # half angle of the cone, rad
BODY = {"mass": 1.0, "inertia": [1e-2] * 3}
STRAIGHT = {
    "cone": make.cone(ANGLE),
    "hollow cone": make.cone(ANGLE, cavity=True),
    "cylinder": make.cylinder(0.1),
    "hollow cylinder": make.cylinder(0.1, cavity=True),
    "plane": make.plane(),
    "line": make.line(),
}
CURVED = {
    "bowl": make.paraboloid(0.2, 0.3),
    "dome": make.paraboloid(-0.2, -0.3),
    "saddle": make.paraboloid(-0.2, 0.3),
    "hollow bowl": make.paraboloid(0.2, 0.3, cavity=True),
}


@pytest.mark.parametrize("name", STRAIGHT)
def test_a_straight_shape_without_ends_has_no_contact_with_a_plane(name: str) -> None:
    body = make.dynamic("body", STRAIGHT[name], position=[0, 0, 0.3], **BODY)
    scene = make.scene("endless", [TABLE, body], contact=[{"between": ["body", "table"]}])
    with pytest.raises(SceneError, match=r"no form has isolated contact points .*; give one ends"):
        require(scene)


@pytest.mark.slow
@pytest.mark.parametrize("name", CURVED)
@pytest.mark.parametrize("roll", [0.0, 0.3, pi / 2, 2.0, pi])
@pytest.mark.parametrize("height", [0.3, -0.2])
def test_a_paraboloid_is_above_a_plane_or_refused(name: str, roll: float, height: float) -> None:
    """The lowest point of a convex one that faces the plane follows from its Legendre transform; all others
    pass through the plane somewhere."""
    shape = CURVED[name]
    radii, side = np.array([value for _, value in shape.parameters]), 1.0 if shape.cavity else -1.0
    y, z = -sin(roll), -cos(roll)  # downwards, in the axes of the shape
    is_held = (side * radii > 0).all() and side * z < -1e-9
    is_held = is_held and height > y * y * abs(radii[1]) / (2 * abs(z))
    body = make.dynamic("body", shape, position=[0, 0, height], rpy=[roll, 0.0, 0.0], **BODY)
    if is_held:
        assert ran([TABLE, body], 0.02, [{"between": ["body", "table"]}]).outcome is Outcome.DONE
    else:
        with pytest.raises(SimulationError, match="at the start"):
            ran([TABLE, body], 0.02, [{"between": ["body", "table"]}])


CONE = make.fixed("cone", make.cone(ANGLE))
ON_TIP: dict[str, tuple[Shape, float]] = {  # a body, and the height of its centre above the tip, m
    "sphere": (make.sphere(0.05), 0.05),
    "ellipsoid": (make.ellipsoid(0.05, 0.04, 0.06), 0.06),
    "box": (make.box(0.1, 0.1, 0.1), 0.05),
}
TIPS = ["sphere", *(pytest.param(name, marks=pytest.mark.slow) for name in list(ON_TIP)[1:])]


@pytest.mark.parametrize("name", TIPS)
def test_a_body_stands_on_the_tip_of_a_cone(name: str) -> None:
    shape, height = ON_TIP[name]
    body = make.dynamic("body", shape, position=[0, 0, height + 0.1], **BODY)
    path = ran([CONE, body], 0.3, [{"between": ["body", "cone"]}])
    assert path.outcome is Outcome.DONE
    np.testing.assert_allclose(path.p[-1, 1], [0, 0, height], atol=1e-10)


def gap(x: np.ndarray) -> np.ndarray:
    """The distance (n,) m of points from the cone."""
    r = np.hypot(x[:, 0], x[:, 1])
    along = r * sin(ANGLE) - x[:, 2] * cos(ANGLE)
    return np.where(along > 0, r * cos(ANGLE) + x[:, 2] * sin(ANGLE), np.hypot(r, x[:, 2]))


@pytest.mark.parametrize("speed", [-3.0, -1.0, 0.5])
def test_a_ball_touches_the_tip_and_the_side_and_not_the_mirror_image(speed: float) -> None:
    radius = 0.05
    start = ball("ball", [0.5, 0.01, 0.25], radius, velocity=[speed, 0.0, 1.0])
    path = ran([CONE, start], 0.5, [{"between": ["ball", "cone"], "restitution": 0.5}], samples=200)
    apart = gap(path.p[:, 1].astype(float)) - radius
    assert path.outcome is Outcome.DONE
    assert apart.min() > -1e-9
    touched = {event.kind for event in path.events} & {"impact", "touch-down"}
    assert bool(touched) == (apart.min() < 1e-2)


@pytest.mark.parametrize("length", [None, 3.0])
@pytest.mark.parametrize("slope", [1.1e-3, -1e-2, 0.05, -0.1, 0.15, 0.3])
def test_a_frustum_falls_onto_a_rail_whose_apex_is_far_away(length: float | None, slope: float) -> None:
    """Its axis is level and across the rail: the lowest line of its side is tangent to the rail."""
    radius, middle, half, drop = 0.1, 0.46, 0.04, 0.01
    rail = make.fixed("rail", make.cylinder(radius, length), rpy=[0.0, pi / 2, 0.0])
    wheel = make.dynamic(
        "wheel", make.frustum(middle + half * slope, middle - half * slope, 2 * half), **BODY,
        position=[0.3, 0.0, radius * np.hypot(1, slope) + middle + drop], rpy=[-pi / 2, 0.0, 0.0],
    )  # fmt: skip
    path = ran([rail, wheel], 0.1, [{"between": ["wheel", "rail"]}])
    assert path.events[0].t == pytest.approx(np.sqrt(2 * drop / G), abs=1e-9)
