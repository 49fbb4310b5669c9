"""Bodies that slide over the edges of tables, tip, and leave them: plane motion and first integrals."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.pieces import rotations
from tests.planar.scenes import HEIGHT, INERTIA, MASS, TIGHT, G, events, standing
from tests.running import library_of

RADIUS, SPEED = 0.04, 0.5  # m; m/s
EDGE = 0.2  # of a table, m from its middle


def slid(table: Shape, body: Body, until: float, samples: int = 100) -> Trajectory:
    scene = make.scene("over", [make.fixed("table", table), body], contact=[{"between": ["body", "table"]}])
    return simulate(library_of(scene), until=until, samples=samples, accuracy=TIGHT)


def over_a_corner(theta: float, rate: float, s: float, slip: float) -> tuple[float, float]:
    """Second rates of the lean of a base line that slides on a fixed corner, and of the corner's place on it.

    The centre of mass is at s e + h n from the corner, e along the base, n across it: Lagrange's equations of
    T = m ((s' + h theta')^2 + (s theta')^2)/2 + I theta'^2/2 and V = m g (h cos theta - s sin theta).
    """
    h, inertia = HEIGHT / 2, INERTIA[1]
    mass = np.array([[MASS, MASS * h], [MASS * h, MASS * (h * h + s * s) + inertia]])
    along = MASS * (s * rate * rate + G * sin(theta))
    turning = MASS * (G * (s * cos(theta) + h * sin(theta)) - 2 * s * slip * rate)
    slip_rate, rate_rate = np.linalg.solve(mass, [along, turning])
    return float(rate_rate), float(slip_rate)


@pytest.mark.slow
def test_a_glass_that_slides_off_a_straight_edge_is_left_by_it_where_its_rim_is() -> None:
    """The edge crosses the rim at two points, which come together a radius from the middle of the base."""
    start, begin = (EDGE - 0.1) / SPEED, 0.1
    glass = standing(make.cylinder(RADIUS, HEIGHT), position=[begin, 0, HEIGHT / 2], velocity=[SPEED, 0, 0])
    path = slid(make.box(2 * EDGE, 0.4, 0.05, position=[0, 0, -0.025]), glass, 0.4)

    def slope(_: float, x: np.ndarray) -> list[float]:
        theta, rate, s, slip = x
        return [rate, over_a_corner(theta, rate, s, slip)[0], slip, over_a_corner(theta, rate, s, slip)[1]]

    def left(_: float, x: np.ndarray) -> float:
        return float(x[2] - RADIUS)

    left.terminal = True  # type: ignore[attr-defined]
    done = solve_ivp(slope, (start, 0.4), [0, 0, 0, SPEED], "DOP853", rtol=1e-13, atol=1e-16, events=left)
    theta, rate, s, slip = done.y[:, -1]
    e, n, h = np.array([cos(theta), -sin(theta)]), np.array([sin(theta), cos(theta)]), HEIGHT / 2
    end = done.t[-1]
    assert events(path, "tipping")[0].t == pytest.approx(start, abs=1e-10)
    assert events(path, "vanish")[-1].t == pytest.approx(end, abs=1e-8)
    v = (slip + h * rate) * e - s * rate * n
    fall = path.t[path.t > end] - end
    flight = np.array([EDGE, 0.0]) + s * e + h * n + np.outer(fall, v) - 0.5 * G * np.outer(fall**2, [0, 1])
    assert np.abs(path.p[path.t > end, 1][:, [0, 2]] - flight).max() < 1e-8
    assert path.w[-1, 1] == pytest.approx([0, rate, 0], abs=1e-6)
    assert path.outcome.name == "DONE"
    assert path.energy_drift < 1e-12
    assert not path.warnings


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "velocity", "spin"),
    [((0.15, 0.0), (0.5, 0.0), 3.0), ((0.15, 0.1), (0.5, 0.05), 4.0), ((-0.1, 0.05), (-0.37, 0.25), -2.0)],
)
def test_a_plate_that_spins_over_the_rim_of_a_can_keeps_what_symmetry_keeps(
    place: tuple[float, float], velocity: tuple[float, float], spin: float
) -> None:
    """The can is round: momentum about its axis stays. The force is along the plate's normal, about which its
    inertia is round: its spin stays. It tips when its centre, which goes straight, has come to the rim."""
    mass, inertia, radius = 0.3, (1e-4, 1e-4, 1.6e-4), 0.25
    plate = make.dynamic(
        "body", make.box(0.08, 0.06, 0.02), mass=mass, inertia=list(inertia), position=[*place, 0.01],
        velocity=[*velocity, 0], angular_velocity=[0, 0, spin],
    )  # fmt: skip
    p, v = np.array(place), np.array(velocity)
    a, b, c = v @ v, p @ v, p @ p - radius**2
    time = float((-b + np.sqrt(b * b - a * c)) / a)
    path = slid(make.cylinder(radius, 0.1, position=[0, 0, -0.05]), plate, time + 0.04, 60)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(time, abs=1e-10)
    R, w = rotations(path, 1), path.w[:, 1]
    own = np.einsum("nji,nj->ni", R, w)
    assert np.abs(own[:, 2] - spin).max() < 1e-9
    inner = np.einsum("nij,nj->ni", R, own * inertia)
    about = mass * np.cross(path.p[:, 1], path.v[:, 1])[:, 2] + inner[:, 2]
    assert np.abs(about - about[0]).max() < 1e-10 * np.abs(about[0]) + 1e-13
    assert np.abs(R[-1, :, 2] - [0, 0, 1]).max() > 1e-3
    assert path.outcome.name == "DONE"
    assert path.energy_drift < 1e-11


OUTLINES = {
    "box": make.box(0.08, 0.06, 0.02),
    "triangle": make.extrusion(0.02, points=[[0.05, 0], [-0.03, 0.05], [-0.03, -0.05]]),
    "can": make.cylinder(0.05, 0.02),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", OUTLINES)
@pytest.mark.parametrize(
    "spin", [pytest.param(0.0, marks=pytest.mark.slow), 3.0, pytest.param(-2.0, marks=pytest.mark.slow)]
)
def test_a_plate_that_tips_over_a_straight_edge_moves_alike_whatever_its_outline(
    name: str, spin: float
) -> None:
    """While the edge lies in its bottom, it is all one where its sides cross it and which corners pass."""
    table = make.box(0.4, 0.4, 0.1, position=[0, 0, -0.05])
    paths = [
        slid(
            table,
            make.dynamic(
                "body",
                shape,
                mass=0.3,
                inertia=[1e-4, 1e-4, 1.6e-4],
                position=[0.1, 0.05, 0.01],
                velocity=[0.5, 0.1, 0],
                angular_velocity=[0, 0, spin],
            ),
            0.255,
        )
        for shape in (OUTLINES[name], make.box(0.3, 0.26, 0.02))
    ]
    (tip,) = events(paths[0], "tipping")
    assert tip.t == pytest.approx(0.2, abs=1e-10)
    assert np.abs(paths[0].p[:, 1] - paths[1].p[:, 1]).max() < 1e-9
    assert np.abs(paths[0].quaternion[:, 1] - paths[1].quaternion[:, 1]).max() < 1e-7
    assert not events(paths[0], "touch-down")
    assert max(path.energy_drift for path in paths) < 1e-12


@pytest.mark.cases(1)
@pytest.mark.parametrize(("place", "velocity"), [((0.1, 0.12), (0.5, 0.5)), ((0.1, 0.15), (0.6, 0.2))])
def test_a_glass_that_slides_over_the_corner_of_a_table_keeps_its_energy(
    place: tuple[float, float], velocity: tuple[float, float]
) -> None:
    glass = standing(
        make.cylinder(RADIUS, HEIGHT), position=[*place, HEIGHT / 2], velocity=[*velocity, 0],
        angular_velocity=[0, 0, 2.0],
    )  # fmt: skip
    path = slid(make.box(2 * EDGE, 2 * EDGE, 0.05, position=[0, 0, -0.025]), glass, 0.45)
    assert path.outcome.name == "DONE"
    assert path.energy_drift < 1e-11
    assert not events(path, "fallback-start")
