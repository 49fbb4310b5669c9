"""Faces that turn over a straight side of their hull that ends on curves, and rings, against plane motion."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import build as make
from modelgen.scene.types import Shape
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
    (tip,) = events(path, "tip")
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


@pytest.mark.parametrize("angle", [0.0, 2.2])
def test_a_ring_tips_where_a_disc_of_its_radius_does_and_rolls_like_it(angle: float) -> None:
    """The hull of an annulus is that of its outer circle."""
    force = [f"{RATE * cos(angle)!r}*t", f"{RATE * sin(angle)!r}*t", "0"]
    ring, disc = (
        pushed(shape, force, [0, 0, ARM], 2.06, 40)
        for shape in (make.tube(0.04, 0.025, HEIGHT), make.cylinder(0.04, HEIGHT))
    )
    (tip,) = events(ring, "tip")
    assert tip.t == pytest.approx(0.04 * MASS * G / (RATE * ARM), abs=1e-9)
    assert np.abs(ring.p - disc.p).max() < 1e-12
    assert np.abs(ring.quaternion - disc.quaternion).max() < 1e-11
