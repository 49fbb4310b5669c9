"""Faces that turn over a straight side of their hull that ends on curves, and rings, against plane motion."""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.oracles.pieces import rotations
from tests.planar.scenes import HEIGHT, INERTIA, MASS, TIGHT, G, events, pushed, standing, table
from tests.planar.stadium import RADIUS, stadium
from tests.running import library_of

RATE, ARM, AFTER = 2.0, 0.03, 0.12  # N/s; m above the centre of mass; s


def leans(reach: float, start: float, t: np.ndarray) -> np.ndarray:
    """Of a body that turns about a line at `reach` under its base, the line sliding freely, rad.

    The height of the centre of mass over the line is z = reach sin theta + h cos theta; z'' m + m g is what
    the table bears, and its moment about the centre of mass is that of the push less I theta''.
    """
    h = HEIGHT / 2

    def slope(now: float, state: np.ndarray) -> list[float]:
        theta, rate = state
        once = reach * cos(theta) - h * sin(theta)
        twice = -reach * sin(theta) - h * cos(theta)
        moment = RATE * now * ARM * cos(theta) - MASS * (G + twice * rate * rate) * once
        return [rate, moment / (INERTIA[0] + MASS * once * once)]

    done = solve_ivp(slope, (start, t[-1]), [0.0, 0.0], "DOP853", t, rtol=1e-13, atol=1e-17)
    return np.asarray(done.y[0])


def bean() -> tuple[Shape, float]:
    """Its hull has a straight side over the waist, which touches the outline at two smooth points."""
    r = "0.04*(1 + 0.5*cos(2*t))"
    shape = make.extrusion(HEIGHT, x=f"{r}*cos(t)", y=f"{r}*sin(t)", domain=[0.0, "2*pi"])
    best = minimize_scalar(
        lambda t: -0.04 * (1 + 0.5 * cos(2 * t)) * sin(t), bounds=(0.2, 1.5), options={"xatol": 1e-12}
    )
    return shape, float(-best.fun)


SIDES = {"bean": bean, "stadium": lambda: (stadium(), RADIUS)}


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", SIDES)
@pytest.mark.parametrize("aside", [0.0, 0.02])
def test_a_face_turns_on_the_straight_side_of_its_hull_though_it_ends_on_curves(
    name: str, aside: float
) -> None:
    """A torque about y moves the pressure along the side, and changes nothing of the lean."""
    shape, reach = SIDES[name]()
    start = reach * MASS * G / (RATE * ARM)
    scene = make.scene(
        "sides", [table(), standing(shape)], contact=[{"between": ["body", "table"]}],
        force=[{"body": "body", "force": ["0", f"{RATE}*t", "0"], "point": [0, 0, ARM]}],
        torque=[{"body": "body", "torque": ["0", f"{aside}*t", "0"]}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=start + AFTER, samples=60, accuracy=TIGHT)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(start, abs=1e-9)
    after = path.t > start + 1e-3
    R = rotations(path, 1)[after]
    lean = np.arctan2(-R[:, 1, 2], R[:, 2, 2])
    assert np.abs(np.abs(lean) - leans(reach, start, path.t[after])).max() < 1e-11
    assert np.abs(R[:, :, 0] - [1, 0, 0]).max() < 1e-11
    assert borne_twice(path)
    assert not path.warnings
    assert path.energy_drift < 1e-12


def borne_twice(path: Trajectory) -> bool:
    """At the end two contacts of one rim or two press on the table."""
    return int((path.force[-1] > 0).sum()) == 2


def test_a_face_turns_on_the_middle_of_a_side_that_is_nearly_straight() -> None:
    """Bent with a radius of 3.4 m, forty times the size: by symmetry the plane motion at the half width."""
    reach = 0.02
    shape = make.extrusion(
        HEIGHT, x="0.02*cos(t) + 0.03*tanh(8*cos(t))", y="0.02*sin(t)", domain=[0.0, "2*pi"]
    )
    start = reach * MASS * G / (RATE * ARM)
    path = pushed(shape, ["0", f"{RATE}*t", "0"], [0, 0, ARM], start + AFTER, 60)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(start, abs=1e-9)
    after = path.t > start + 1e-3
    R = rotations(path, 1)[after]
    lean = np.arctan2(-R[:, 1, 2], R[:, 2, 2])
    assert np.abs(np.abs(lean) - leans(reach, start, path.t[after])).max() < 1e-9
    assert path.outcome.name == "DONE"


@pytest.mark.parametrize("angle", [0.0, 2.2])
def test_a_ring_tips_where_a_disc_of_its_radius_does_and_rolls_like_it(angle: float) -> None:
    """The hull of an annulus is that of its outer circle."""
    force = [f"{RATE * cos(angle)!r}*t", f"{RATE * sin(angle)!r}*t", "0"]
    ring, disc = (
        pushed(shape, force, [0, 0, ARM], 2.06, 40)
        for shape in (make.tube(0.04, 0.025, HEIGHT), make.cylinder(0.04, HEIGHT))
    )
    (tip,) = events(ring, "tipping")
    assert tip.t == pytest.approx(0.04 * MASS * G / (RATE * ARM), abs=1e-9)
    assert np.abs(ring.p - disc.p).max() < 1e-12
    assert np.abs(ring.quaternion - disc.quaternion).max() < 1e-11


@pytest.mark.cases(2)
@pytest.mark.parametrize("angle", [0.0, 0.5, 1.8])
def test_a_glass_that_is_pressed_outside_its_base_from_the_start_rolls_over_its_rim(angle: float) -> None:
    """Not over a chord between points that hold it; the plane motion is that of any side at the radius."""
    start = 0.04 * MASS * G / (RATE * ARM) * 1.01
    push = RATE * np.array([cos(angle), sin(angle)])
    force = [f"{float(push[0])!r}*({start!r} + t)", f"{float(push[1])!r}*({start!r} + t)", "0"]
    path = pushed(make.cylinder(0.04, HEIGHT), force, [0, 0, ARM], 0.1, 20)
    assert [event.kind for event in path.events] == ["face-contact", "tipping"]
    lean = np.arccos(np.clip(rotations(path, 1)[1:, 2, 2], -1, 1))
    assert np.abs(lean - leans(0.04, start, start + path.t[1:])).max() < 1e-8


def test_a_glass_on_an_imaginary_edge_turns_with_it() -> None:
    """The edge is of the glass (section 5.3): the planar motion is that of the rim itself."""
    edge, rim = (
        simulate(library_of(rocking()), until=2.1, samples=30, accuracy=replace(TIGHT, imaginary_edge=lean))
        for lean in (0.01, 0.0)
    )
    (walk,) = events(edge, "feature-change")
    start = 0.04 * MASS * G / (RATE * ARM)
    assert leans(0.04, start, np.array([start + 0.01, walk.t]))[-1] == pytest.approx(0.01, abs=1e-8)
    assert np.abs(edge.p - rim.p).max() < 1e-12


def rocking() -> Scene:
    return make.scene(
        "edge", [table(), standing(make.cylinder(0.04, HEIGHT))], contact=[{"between": ["body", "table"]}],
        force=[{"body": "body", "force": [f"{RATE}*t", "0", "0"], "point": [0, 0, ARM]}],
    )  # fmt: skip
