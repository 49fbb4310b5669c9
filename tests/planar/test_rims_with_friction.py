"""A face with friction that turns over a curved edge: it rolls or slides on its rim from the first moment."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.planar.scenes import HEIGHT, INERTIA, MASS, RADIUS, TIGHT, G, events, standing, table
from tests.running import library_of

HALF, ABOVE, GROWTH = HEIGHT / 2, 0.03, 2.0  # m; of the load over the centre of mass, m; N/s
ELLIPSE = make.extrusion(
    HEIGHT, x="a*cos(t)", y="b*sin(t)", domain=["-pi", "pi"], parameters={"a": RADIUS, "b": 0.03}
)


def glass(
    mu: float, azimuth: float, until: float, shape: Shape | None = None, accuracy: Accuracy = TIGHT
) -> Trajectory:
    """The glass on a table, pushed along an azimuth by a growing force over its centre of mass."""
    force = [f"{GROWTH * c:.17g}*t" for c in (cos(azimuth), sin(azimuth))]
    scene = make.scene(
        "rim_with_friction", [table(), standing(shape or make.cylinder(RADIUS, HEIGHT))],
        contact=[{"between": ["body", "table"], "friction": mu}],
        force=[{"body": "body", "force": [*force, "0"], "point": [0, 0, ABOVE]}],
    )  # fmt: skip
    return simulate(library_of(scene), until=until, samples=60, accuracy=accuracy, estimate=False)


def test_a_glass_that_sticks_turns_over_the_edge_of_its_base_as_a_pendulum() -> None:
    """About the point of the rim where it tips: torque F z - m g (-x) of what is pushed and of its weight."""
    tip = RADIUS * MASS * G / (GROWTH * (HALF + ABOVE))
    path = glass(1.0, 0.0, tip + 0.15)
    assert [event.kind for event in path.events] == ["face-contact", "tipping"]
    assert events(path, "tipping")[0].t == pytest.approx(tip, abs=1e-12)
    pivoted = INERTIA[1] + MASS * (RADIUS**2 + HALF**2)

    def rates(t: float, y: np.ndarray) -> list[float]:
        c, s = cos(y[0]), sin(y[0])
        pushed, weighs = RADIUS * s + (HALF + ABOVE) * c, MASS * G * (RADIUS * c - HALF * s)
        return [y[1], (GROWTH * t * pushed - weighs) / pivoted]

    after = path.t > tip
    exact = solve_ivp(rates, (tip, path.t[-1]), [0, 0], "DOP853", path.t[after], rtol=1e-13, atol=1e-15).y[0]
    assert exact[-1] > 0.06
    x = RADIUS - RADIUS * np.cos(exact) + HALF * np.sin(exact)
    z = RADIUS * np.sin(exact) + HALF * np.cos(exact)
    assert np.abs(path.p[after, 1] - np.array([x, 0 * x, z]).T).max() < 1e-10
    assert path.energy_drift < 1e-11


def test_a_glass_that_slides_turns_over_the_edge_of_its_base_sliding_on() -> None:
    """Friction mu N against the slip, in the plane of the load."""
    mu = 0.3
    slip = mu * MASS * G / GROWTH
    tip = MASS * G * (RADIUS - mu * HALF) / (GROWTH * ABOVE)
    path = glass(mu, 0.0, tip + 0.1)
    assert [(event.kind, event.contact) for event in path.events][:3] == [
        ("face-contact", "body-table"), ("slip-start", "body-table"), ("tipping", "body-table"),
    ]  # fmt: skip
    assert [event.t for event in path.events[1:3]] == pytest.approx([slip, tip], abs=1e-11)

    def rates(t: float, y: np.ndarray) -> list[float]:
        _, v, lean, turn = y
        c, s, force = cos(lean), sin(lean), GROWTH * t
        arm, z = RADIUS * c - HALF * s, RADIUS * s + HALF * c
        # I lean'' = F a c - N arm + mu N z, N = m (g + arm lean'' - z turn^2)
        constraint = mu * z - arm
        lean2 = (force * ABOVE * c + constraint * MASS * (G - z * turn**2)) / (
            INERTIA[1] - constraint * MASS * arm
        )
        N = MASS * (G + arm * lean2 - z * turn**2)
        return [v, (force - mu * N) / MASS, turn, lean2]

    slid = GROWTH * (tip - slip) ** 2 / 2 / MASS
    start = [slid * (tip - slip) / 3, slid, 0, 0]
    after = path.t > tip
    y = solve_ivp(rates, (tip, path.t[-1]), start, "DOP853", path.t[after], rtol=1e-13, atol=1e-15).y
    assert y[2, -1] > 0.015
    exact = np.array([y[0], 0 * y[0], RADIUS * np.sin(y[2]) + HALF * np.cos(y[2])]).T
    assert np.abs(path.p[after, 1] - exact).max() < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("azimuth", [pytest.param(0.4, marks=pytest.mark.slow), 1.0])
def test_an_elliptic_base_rolls_without_slip_alike_on_both_sides(azimuth: float) -> None:
    path = glass(1.2, azimuth, 1.0, ELLIPSE)
    tip = events(path, "tipping")[0].t
    assert [event.kind for event in path.events][:2] == ["face-contact", "tipping"]
    path, other = (glass(1.2, sign * azimuth, tip + 0.12, ELLIPSE) for sign in (1, -1))
    assert [event.kind for event in path.events] == ["face-contact", "tipping"]
    mirror = np.array([1, -1, 1])
    assert np.abs(path.p[:, 1] - mirror * other.p[:, 1]).max() < 1e-11
    assert path.p[-1, 1, 2] > HALF + 1e-3
    assert path.energy_drift < 1e-10
    coarse = glass(1.2, azimuth, tip + 0.12, ELLIPSE, Accuracy.balanced())
    assert np.abs(path.p[:, 1] - coarse.p[:, 1]).max() < 1e-8


@pytest.mark.slow
def test_a_cup_that_falls_on_its_side_passes_where_that_is_parallel_to_the_table() -> None:
    """Its straight side has no closest points of its own there; it comes to lie on both of its rims."""
    top = make.fixed("table", make.box(2.0, 2.0, 0.1), position=[0, 0, -0.05])
    scene = make.scene(
        "falling_cup", [top, standing(ELLIPSE)], contact=[{"between": ["body", "table"], "friction": 0.5}],
        force=[{"body": "body", "force": ["0", "2.0*t", "0"], "point": [0, 0, ABOVE]}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=1.2, samples=60, accuracy=Accuracy.balanced(), estimate=False)
    assert path.outcome.name == "DONE"
    assert path.energy_drift < 1e-9
    _, x, y, _ = path.quaternion[-1, 1]
    assert abs(1 - 2 * (x * x + y * y)) < 0.3
    assert path.p[-1, 1, 2] > 0.025
