"""Bodies on several feet, and on several supports: one planar contact, whose hull is that of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.pieces import rotations
from tests.planar.scenes import TIGHT, G, events, table
from tests.planar.test_pressure import reach_of_hull
from tests.running import library_of

MASS, INERTIA, HEIGHT = 1.0, [4e-3, 4e-3, 6e-3], 0.125  # of a stool; its centre of mass over its feet, m
RATE, ARM, SIDE = 10.0, 0.1, 0.04  # N/s; m above the centre of mass; of a square foot, m

Places = Sequence[tuple[float, float]]


def feet(places: Places, radius: float = 0.0) -> list[Shape]:
    """Square feet, or round ones of a radius."""
    foot = make.cylinder if radius else make.box
    size = (radius, 0.05) if radius else (SIDE, SIDE, 0.05)
    return [foot(*size, name=f"foot{k}", position=[x, y, -0.1]) for k, (x, y) in enumerate(places)]


def stool(shapes: Sequence[Shape], **keys: object) -> Body:
    return make.dynamic(
        "stool", *shapes, **{"mass": MASS, "inertia": INERTIA, "position": [0, 0, HEIGHT], **keys}
    )


def pushed(shapes: Sequence[Shape], angle: float, until: float, friction: float = 0.0) -> Trajectory:
    force = [f"{RATE * cos(angle)!r}*t", f"{RATE * sin(angle)!r}*t", "0"]
    scene = make.scene(
        "stool", [table(), stool(shapes)],
        contact=[{"between": [f"stool/{shape.name}", "table"], "friction": friction} for shape in shapes],
        force=[{"body": "stool", "force": force, "point": [0, 0, ARM]}],
    )  # fmt: skip
    return simulate(library_of(scene), until=until, samples=40, accuracy=TIGHT)


def outer(places: Places) -> np.ndarray:
    half = SIDE / 2
    return np.array([(x + a, y + b) for x, y in places for a in (-half, half) for b in (-half, half)])


def time_of(reach: float) -> float:
    """When the centre of pressure F h/(m g) has come as far."""
    return reach * MASS * G / (RATE * ARM)


def leans(reach: float, start: float, t: np.ndarray) -> np.ndarray:
    """Of a body that turns about a line at `reach` under its base, the line sliding freely, rad."""

    def slope(now: float, state: np.ndarray) -> list[float]:
        theta, rate = state
        once = reach * cos(theta) - HEIGHT * sin(theta)
        twice = -reach * sin(theta) - HEIGHT * cos(theta)
        moment = RATE * now * ARM * cos(theta) - MASS * (G + twice * rate * rate) * once
        return [rate, moment / (INERTIA[1] + MASS * once * once)]

    done = solve_ivp(slope, (start, t[-1]), [0.0, 0.0], "DOP853", t, rtol=1e-13, atol=1e-17)
    return np.asarray(done.y[0])


TWO, THREE = ((-0.1, 0.0), (0.1, 0.0)), ((-0.1, -0.06), (0.1, -0.06), (0.0, 0.12))
FOUR = ((-0.1, -0.08), (0.1, -0.08), (0.1, 0.08), (-0.1, 0.08))
OVERLAPPING = ((-0.01, 0.0), (0.02, 0.0), (0.02, 0.01))


@pytest.mark.cases(6)
@pytest.mark.parametrize("places", [TWO, THREE, FOUR, OVERLAPPING])
@pytest.mark.parametrize("angle", [0.0, 0.9, 4.0])
def test_a_body_on_feet_tips_where_the_ray_of_its_pressure_leaves_the_hull_of_all(
    places: Places, angle: float
) -> None:
    direction = np.array([cos(angle), sin(angle)])
    time = time_of(reach_of_hull(outer(places), direction))
    path = pushed(feet(places), angle, time + 0.05)
    assert [event.kind for event in path.events][:2] == ["face-contact", "tipping"]
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(time, abs=1e-9)
    assert (tip.contact, tip.features) == ("stool-table", "bottom")
    rests = path.t < tip.t
    assert path.patch_force[rests, 0] == pytest.approx(np.full(rests.sum(), MASS * G), rel=1e-12)
    assert path.outcome.name == "DONE"
    assert not path.warnings


@pytest.mark.cases(2)
@pytest.mark.parametrize("n", [3, 4, 5])
def test_a_body_on_feet_with_friction_tips_at_the_same_place_and_not_before(n: int) -> None:
    """Its load acts at the height of the load over the table; nothing slips."""
    places = [(0.1 * cos(2 * pi * k / n), 0.1 * sin(2 * pi * k / n)) for k in range(n)]
    reach = reach_of_hull(outer(places), np.array([cos(0.7), sin(0.7)]))
    tip = reach * MASS * G / (RATE * (HEIGHT + ARM))
    path = pushed(feet(places), 0.7, tip + 0.02, friction=1.5)
    assert [event.kind for event in path.events] == ["face-contact", "tipping"]
    assert path.events[1].t == pytest.approx(tip, abs=1e-9)


def test_a_body_on_two_feet_turns_about_the_outer_edge_of_one() -> None:
    start = time_of(0.12)
    path = pushed(feet(TWO), 0.0, start + 0.12)
    after = path.t > start + 1e-3
    lean = np.arctan2(rotations(path, 1)[after][:, 0, 2], rotations(path, 1)[after][:, 2, 2])
    assert np.abs(lean - leans(0.12, start, path.t[after])).max() < 1e-11
    assert path.energy_drift < 1e-12


def test_a_body_on_round_feet_turns_about_the_line_that_touches_two_of_them() -> None:
    """The hull of discs: a side between two smooth points, at the radius from the line of the centres."""
    radius = 0.02
    start = time_of(0.08 + radius)
    path = pushed(feet(FOUR, radius), pi / 2, start + 0.12)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(start, abs=1e-9)
    after = path.t > start + 1e-3
    lean = np.arctan2(rotations(path, 1)[after][:, 1, 2], rotations(path, 1)[after][:, 2, 2])
    assert np.abs(lean - leans(0.08 + radius, start, path.t[after])).max() < 1e-11


@pytest.mark.slow
def test_a_stool_that_slides_over_an_edge_tips_when_its_feet_in_front_have_left_it() -> None:
    """The hull reaches to the edge while a strip of them is on the desk, and then only to the hind feet."""
    desk = make.fixed("desk", make.box(1.0, 1.0, 0.1, position=[-0.5, 0, -0.05]))
    speed, begin = 0.2, -0.15
    shapes = feet(FOUR)
    scene = make.scene(
        "edge", [desk, stool(shapes, position=[begin, 0, HEIGHT], velocity=[speed, 0, 0])],
        contact=[{"between": ["desk", f"stool/{shape.name}"]} for shape in shapes],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.5, samples=10, accuracy=TIGHT)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx((-begin - 0.08) / speed, abs=1e-8)
    assert path.outcome.name == "DONE"


@pytest.mark.cases(1)
@pytest.mark.parametrize("bodies", [1, 2])
def test_a_plank_on_two_bricks_tips_over_the_far_edge_of_one(bodies: int) -> None:
    """Of one fixed body or of two, which stand turned; the plank slides until its middle passes the edge."""
    west, east = (make.box(0.1, 0.2, 0.05, name=name, position=[x, 0, -0.025]) for name, x in
                  (("west", -0.2), ("east", 0.2)))  # fmt: skip
    if bodies == 1:
        bricks = [make.fixed("bricks", west, east)]
        names = ["bricks/west", "bricks/east"]
    else:
        turned = {"axis": [0, 0, 1], "angle": pi}
        bricks = [make.fixed("west", west), make.fixed("east", make.box(0.1, 0.2, 0.05),
                  position=[0.2, 0, -0.025], axis_angle=turned)]  # fmt: skip
        names = ["west", "east"]
    speed = 0.5
    plank = make.dynamic(
        "plank", make.box(0.7, 0.1, 0.03), density=700.0, position=[0, 0, 0.015], velocity=[speed, 0, 0]
    )
    scene = make.scene("plank", [*bricks, plank], contact=[{"between": [name, "plank"]} for name in names])
    path = simulate(library_of(scene), until=0.53, samples=20, accuracy=TIGHT)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(0.25 / speed, abs=1e-9)
    assert path.patch_force[path.t < tip.t, 0] == pytest.approx(0.7 * 0.1 * 0.03 * 700.0 * G, rel=1e-12)
    assert path.w[-1, -1, 1] > 0


def test_a_plank_on_two_loose_bricks_tips_over_the_far_edge_of_one() -> None:
    """More forces than there are rows; nothing rubs, so the bricks stay until it tips."""
    bricks = [
        make.dynamic(name, make.box(0.1, 0.2, 0.05), density=2000.0, position=[x, 0, 0.025])
        for name, x in (("west", -0.2), ("east", 0.2))
    ]
    plank = make.dynamic(
        "plank", make.box(0.7, 0.1, 0.03), density=700.0, position=[0, 0, 0.065], velocity=[0.5, 0, 0]
    )
    pairs = [["table", "west"], ["table", "east"], ["west", "plank"], ["east", "plank"]]
    scene = make.scene("loose", [table(), *bricks, plank], contact=[{"between": pair} for pair in pairs])
    path = simulate(library_of(scene), until=0.53, samples=53, accuracy=TIGHT, estimate=False)
    assert not any(event.kind == "fallback-start" for event in path.events)
    assert events(path, "tipping")[-1].t == pytest.approx(0.5, abs=1e-9)
    rests = path.t < 0.5
    assert np.abs(path.v[rests, 1:3]).max() < 1e-12
    assert np.abs(path.w[rests, 3]).max() < 1e-12
    assert path.energy_drift < 1e-12


@pytest.mark.parametrize("order", [1, -1])
def test_feet_that_are_welded_to_each_other_slide_as_those_of_one_body(order: int) -> None:
    """Two blocks of 1 and 2 kg, 0.2 m apart, turn at 2 rad/s as they slide, beside one body of both. How much
    each of them carries is not told, nor is the force of the weld."""
    weights, places, turn = np.array([1.0, 2.0]), np.array([-2 / 15, 1 / 15]), 2.0
    table_wide = make.fixed("table", make.box(4.0, 4.0, 1.0), position=[0.0, 0.0, -0.5])
    blocks = [
        make.dynamic(
            name, make.box(0.1, 0.1, 0.1), mass=mass, inertia=[2e-3 * mass] * 3, position=[x, 0.0, 0.05],
            velocity=[1.0, turn * x, 0.0], angular_velocity=[0.0, 0.0, turn],
        )
        for name, mass, x in zip("ab", map(float, weights), map(float, places), strict=True)
    ][::order]  # fmt: skip
    far = float(weights @ places**2)
    whole = make.dynamic(
        "whole", *(make.box(0.1, 0.1, 0.1, name=name, position=[float(x), 0.0, 0.0])
                   for name, x in zip("ab", places, strict=True)),
        mass=3.0, inertia=[6e-3, 6e-3 + far, 6e-3 + far], position=[0.0, 0.0, 0.05],
        velocity=[1.0, 0.0, 0.0], angular_velocity=[0.0, 0.0, turn],
    )  # fmt: skip
    weld = {"name": "weld", "kind": "weld", "between": ["a", "b"]}
    welded, one = (
        simulate(
            library_of(make.scene("feet", [table_wide, *bodies], contact=contact, joint=joints)), until=0.3
        )
        for bodies, joints, contact in (
            (blocks, [weld], [{"between": [each.name, "table"], "friction": 0.3} for each in blocks]),
            ([whole], [], [{"between": [f"whole/{name}", "table"], "friction": 0.3} for name in "ab"]),
        )
    )
    assert welded.is_trusted, welded.doubts
    centre = np.einsum("b,nbi->ni", weights[::order] / 3, welded.p[:, 1:])
    np.testing.assert_allclose(centre, one.p[:, 1], atol=1e-10)
    np.testing.assert_allclose(welded.w[:, 1], one.w[:, 1], atol=1e-9)
    assert np.isnan(welded.joint_force).all()
