"""Bodies on places of their surface without curvature, and bodies that touch a plane along a curve.

A superellipsoid with exponents above 2 is flat at the ends of its axes, yet meets a plane in one point. A
ring that lies flat meets it in a circle: three points of it hold it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from math import sin, sqrt

import numpy as np
import pytest

from modelgen import simulate
from modelgen.assembly.coaxial_supports import coaxial_supports_of
from modelgen.assembly.rim_support_points import support_points_of
from modelgen.codegen.library import Library
from modelgen.geometry.shape_features import features_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Feature, Shape
from tests.running import library_of

AXES = (0.05, 0.04, 0.03)  # m
EXPONENTS = [(2.0, 2.0), (2.5, 2.5), (3.0, 3.0), (4.0, 4.0), (4.0, 2.0), (2.0, 4.0)]
ENDS = {2: (1.0, 0.0, 0.0, 0.0), 1: (0.5, 0.5, 0.5, 0.5), 0: (0.5, -0.5, -0.5, -0.5)}  # axis that is upright
SPEED, HIGH, GRAVITY = 0.3, 0.01, 9.81


def on_floor(bodies: Sequence[Body], **keys: object) -> Library:
    contact = [{"between": [body.name, "floor"], **keys} for body in bodies]
    return library_of(make.scene("flat", [make.fixed("floor", make.plane()), *bodies], contact=contact))


@cache
def standing(height: float, friction: float) -> Library:
    """One of each exponents on each end, this high above the floor; those on frictionless floor slide."""
    bodies = [
        make.dynamic(
            f"b{k}{axis}",
            make.superellipsoid(*AXES, p, q),
            mass=0.2,
            inertia=[1e-4, 1.2e-4, 1.1e-4],
            position=[0.0, 0.2 * (3 * k + axis), AXES[axis] + height],
            quaternion=list(turn),
            velocity=[0.0 if friction else SPEED, 0.0, 0.0],
        )
        for k, (p, q) in enumerate(EXPONENTS)
        for axis, turn in ENDS.items()
    ]
    return on_floor(bodies, friction=friction) if friction else on_floor(bodies)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_stands_on_the_ends_of_its_axes(friction: float) -> None:
    path = simulate(standing(0.0, friction), until=0.2, samples=5, estimate=False)
    assert path.is_trusted, path.doubts
    along = 0.0 if friction else SPEED
    moved = path.p[:, 1:] - path.p[0, 1:]
    np.testing.assert_allclose(moved[:, :, 0] - along * path.t[:, None], 0, atol=1e-14)
    np.testing.assert_allclose(moved[:, :, 1:], 0, atol=1e-15)
    np.testing.assert_allclose(path.force, 0.2 * GRAVITY, rtol=1e-12)


def test_falls_onto_the_ends_of_its_axes() -> None:
    path = simulate(standing(HIGH, 0.0), until=0.2, samples=5, estimate=False)
    assert path.is_trusted, path.doubts
    assert {event.kind for event in path.events} == {"touch-down"}
    assert len(path.events) == 3 * len(EXPONENTS)
    np.testing.assert_allclose([event.t for event in path.events], sqrt(2 * HIGH / GRAVITY), rtol=1e-12)
    np.testing.assert_allclose(path.p[-1, 1:, 2] + HIGH, path.p[0, 1:, 2], atol=1e-14)


def height(normal: np.ndarray, p: float, q: float) -> float:
    """The support function of a superellipsoid: how far it reaches along a unit normal, m."""
    P, Q = p / (p - 1), q / (q - 1)
    x, y, z = np.abs(np.array(AXES) * normal)
    return float(((x**P + y**P) ** (Q / P) + z**Q) ** (1 / Q))


def depths(path: Trajectory, p: float, q: float) -> np.ndarray:
    """How deep the body is in the floor at each sample, m."""
    w, x, y, z = path.quaternion[:, 1].T
    down = -np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]).T
    return np.array([height(n, p, q) for n in down]) - path.p[:, 1, 2]


@pytest.mark.cases(8)
@pytest.mark.parametrize("tilt", [10.0**-k for k in range(1, 13)])
@pytest.mark.parametrize("exponents", [(2.0, 2.0), (2.5, 2.5), (3.0, 3.0), (4.0, 4.0), (4.0, 2.0)])
def test_is_not_trusted_in_the_floor_beside_its_end(exponents: tuple[float, float], tilt: float) -> None:
    turn = [np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0]
    up = height(np.array([0.0, np.sin(tilt), np.cos(tilt)]), *exponents)
    body = make.dynamic(
        "b", make.superellipsoid(*AXES, *exponents), density=1000.0, position=[0.0, 0.0, up], quaternion=turn
    )
    path = simulate(on_floor([body]), until=0.02, samples=9, estimate=False)
    assert path.is_trusted or tilt < 1e-3, path.doubts
    assert not path.is_trusted or np.abs(depths(path, *exponents)).max() < 1e-11


BUMP = make.chart("u", "-v", "(u**2 + v**2)**2", domain=[(-0.05, 0.05), (-0.04, 0.04)])
RINGS = {  # with the height of the origin at contact
    "torus": (make.torus(0.05, 0.02), 0.02),
    "circle": (make.circle(0.05), 0.0),
    "ellipse": (make.ellipse_curve(0.05, 0.03), 0.0),
    "own": (
        make.curve("0.05*cos(t)", "0.03*sin(t) + 0.005*sin(2*t)", "0", domain=(0, 2 * np.pi), periodic=True),
        0.0,
    ),
}
FLOORS = {
    "box": make.box(2.0, 2.0, 1.0, position=[0.0, 0.0, -0.5]),
    "drum": make.cylinder(1.0, 1.0, position=[0.0, 0.0, -0.5]),
}


@cache
def ring_on(name: str, floor: str, above: float, tilt: float = 0.0) -> Library:
    """A ring above a floor that slides along x while it falls."""
    shape, touching = RINGS[name]
    body = make.dynamic(
        "b", shape, mass=1.0, inertia=[1e-3, 1.1e-3, 1.2e-3], center_of_mass=[0, 0, 0],
        position=[0.01, 0.02, touching + above], velocity=[SPEED, 0.0, 0.0],
        quaternion=[np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0],
    )  # fmt: skip
    contact = [{"between": ["b", "floor"]}]
    return library_of(make.scene("ring", [make.fixed("floor", FLOORS[floor]), body], contact=contact))


@pytest.mark.parametrize("method", ["", "time-stepping"])
@pytest.mark.parametrize(
    ("name", "floor", "above"),
    [
        (name, floor, above)
        for name, floor, above in product(RINGS, FLOORS, (0.0, 1e-3))
        if above or name == "torus"  # a wire that begins within a face is refused
    ],
)
def test_a_ring_that_lies_flat_is_held(name: str, floor: str, above: float, method: str) -> None:
    step = 1e-3
    stepping = {"method": "time-stepping", "step": step} if method else {}
    path = simulate(ring_on(name, floor, above), until=0.05, samples=5, estimate=False, **stepping)
    assert path.outcome is Outcome.DONE
    assert path.is_trusted or method, path.doubts
    touching, landed = RINGS[name][1], sqrt(2 * above / GRAVITY)
    fallen = above - GRAVITY / 2 * np.minimum(path.t, landed) ** 2
    within = 2 * step * GRAVITY * max(landed, step) if method else 1e-12
    np.testing.assert_allclose(path.p[:, 1, 2], touching + fallen, atol=within)
    np.testing.assert_allclose(path.p[:, 1, 0], 0.01 + SPEED * path.t, atol=1e-12)
    np.testing.assert_allclose(path.w[:, 1], 0, atol=1e-9)


@pytest.mark.cases(6)
@pytest.mark.parametrize("tilt", [10.0**-k for k in range(2, 13)])
@pytest.mark.parametrize(("name", "floor"), [("torus", "box"), ("torus", "drum"), ("circle", "box")])
def test_a_ring_that_is_nearly_flat_falls_flat(name: str, floor: str, tilt: float) -> None:
    """It begins just above the floor, and stays above it."""
    radius = dict(RINGS[name][0].parameters).get("major", 0.05)
    path = simulate(
        ring_on(name, floor, radius * sin(tilt) + 1e-6, tilt), until=0.05, samples=9, estimate=False
    )
    assert path.outcome is Outcome.DONE
    tilts = np.arccos(np.clip(1 - 2 * (path.quaternion[:, 1, 1:3] ** 2).sum(axis=1), -1, 1))
    least = RINGS[name][1] + radius * np.sin(tilts)
    assert (path.p[:, 1, 2] - least).min() > -1e-8
    assert path.p[-1, 1, 2] < RINGS[name][1] + 2.1 * radius * tilt + 2e-6


NOT_ISOLATED = {**RINGS, "bump": (BUMP, 0.0)}


@pytest.mark.parametrize("method", ["", "time-stepping"])
@pytest.mark.parametrize("above", [0.0, 1e-3])
@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=[pytest.mark.slow] * (each == "bump")) for each in NOT_ISOLATED]
)
def test_ends_where_closest_points_that_are_not_isolated_meet(name: str, above: float, method: str) -> None:
    shape, touching = NOT_ISOLATED[name]
    step = 1e-3
    stepping = {"method": "time-stepping", "step": step} if method else {}
    path = simulate(falling(shape, touching + above), until=0.05, samples=3, **stepping)
    assert path.outcome is Outcome.MARGIN
    assert not path.is_trusted
    assert path.outcome_contact.startswith("b-floor")
    fallen_in_three_steps = 3 * step * GRAVITY * path.t_end
    assert path.penetration_max <= (fallen_in_three_steps if method else 2e-6)
    assert 0 <= path.t_end - sqrt(2 * above / GRAVITY) < (6 * step if method else step)


def falling(shape: Shape, origin: float) -> Library:
    inertia = [1e-3, 1.1e-3, 1.2e-3]
    body = make.dynamic(
        "b", shape, mass=1.0, inertia=inertia, center_of_mass=[0, 0, 0], position=[0, 0, origin]
    )
    return on_floor([body])


@pytest.mark.parametrize("supports_of", [support_points_of, coaxial_supports_of])
def test_the_points_that_hold_an_arc_are_on_the_wire(
    supports_of: Callable[[Feature], tuple[Feature, ...]],
) -> None:
    """Not on the rest of its circle: at both ends and in the middle. They hold it while it lies flat, or
    while a ball is on its axis."""
    line = make.polyline([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.2, 0.0]], radius=0.05)
    (arc,) = (each for each in features_of(line).features if each.shape.kind == "circle")
    held = [[value for _, value in each.shape.parameters] for each in supports_of(arc)]
    middle = 0.05 * (1 - sqrt(0.5))
    expected = [[0.15, 0.0, 0.0], [0.2 - middle, middle, 0.0], [0.2, 0.05, 0.0]]
    np.testing.assert_allclose(held, expected, atol=1e-15)
