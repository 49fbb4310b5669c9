"""Points, centres and straight edges through the whole pipeline, against references of their own."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import require
from modelgen.errors import SceneError, SimulationError
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import TABLE, G, ball, ran, rotations, times

BOWL = make.fixed("bowl", make.ellipsoid(0.5, 0.4, 0.3, cavity=True))


def same(path: Trajectory, other: Trajectory, tolerance: float) -> bool:
    """The moving body, the second of the scene, goes the same way."""
    return bool(np.abs(path.p[:, 1] - other.p[:, 1]).max() < tolerance)


def test_a_top_on_its_tip_is_a_heavy_symmetric_top_on_a_sliding_point() -> None:
    """T = m (l sin(a) a')^2/2 + A (a'^2 + (f' sin a)^2)/2 + C n^2/2, V = m g l cos a; L_z and n are kept."""
    m, length, A, C, tilt, n = 0.7, 0.2, 0.01, 0.004, 0.4, 60.0
    top = make.dynamic(
        "top", make.point(0, 0, -length), mass=m, inertia=[A, A, C], position=[0, 0, length * np.cos(tilt)],
        axis_angle={"axis": [1, 0, 0], "angle": tilt},
        angular_velocity=[0, -n * np.sin(tilt), n * np.cos(tilt)],
    )  # fmt: skip
    path = ran([TABLE, top], 2.0, [{"between": ["top", "table"]}])
    L = C * n * np.cos(tilt)

    def motion(t: float, x: np.ndarray) -> list[float]:
        s, c = np.sin(x[0]), np.cos(x[0])
        turning = (L - C * n * c) / (A * s * s)
        pull = A * turning**2 * s * c - C * n * turning * s + m * length * s * (G - length * c * x[1] ** 2)
        return [x[1], pull / (A + m * (length * s) ** 2)]

    found = solve_ivp(motion, (0, 2.0), [tilt, 0.0], "DOP853", path.t, rtol=1e-13, atol=1e-13).y[0]
    assert np.ptp(found) > 0.01
    assert np.abs(rotations(path, 1)[:, 2, 2] - np.cos(found)).max() < 1e-9
    assert path.energy_drift < 1e-11
    assert not path.events


def test_a_point_mass_leaves_a_fixed_sphere_at_two_thirds_of_its_height() -> None:
    rock = make.fixed("rock", make.sphere(0.5))
    start = 0.3
    bead = make.dynamic(
        "bead",
        make.point(),
        mass=0.2,
        inertia=[1e-4] * 3,
        position=[0.5 * np.sin(start), 0, 0.5 * np.cos(start)],
    )
    path = ran([rock, bead], 0.6, [{"between": ["bead", "rock"]}], samples=600)
    (lift,) = times(path, "lift-off")
    before = path.t < lift
    height = path.p[before, 1, 2][-1] / 0.5
    assert height == pytest.approx(2 / 3 * np.cos(start), abs=5e-3)
    bound = path.p[before, 1, 2] / 0.5
    force = 0.2 * G * (3 * bound - 2 * np.cos(start))
    assert np.abs(path.force[before, 0] - force).max() < 1e-10


@pytest.mark.parametrize("wall", [BOWL, make.fixed("bowl", make.paraboloid(0.4, 0.3))])
def test_a_ball_in_a_bowl_moves_alike_in_both_forms(wall: object) -> None:
    lifted = -0.1 if wall is BOWL else 0.3
    moving = ball("b", [0.1, 0.02, lifted], radius=0.08, velocity=[0.1, 0.4, 0])
    paths = [
        ran([wall, moving], 1.0, [{"between": ["b", "bowl"], "form": form}])  # type: ignore[list-item]
        for form in ("centre_surface", "implicit")
    ]
    assert paths[0].force.max() > 0
    assert same(*paths, tolerance=1e-9)


def test_a_ball_within_its_bowl_is_a_bowl_within_its_ball() -> None:
    """A hollow ball over a fixed egg: the cavity is the centre, and the surface lies within it."""
    egg = make.fixed("egg", make.ellipsoid(0.3, 0.2, 0.25))
    shell = make.dynamic(
        "shell", make.sphere(0.6, cavity=True), mass=1.0, inertia=[0.3] * 3, position=[0.05, 0.02, -0.3]
    )
    paths = [
        ran([egg, shell], 0.5, [{"between": ["shell", "egg"], "form": form}])
        for form in ("centre_surface", "implicit")
    ]
    assert paths[0].force.max() > 0
    assert same(*paths, tolerance=1e-9)


@pytest.mark.cases(1)
@pytest.mark.parametrize("kind", [make.line(), make.segment(2.0), make.edge(2.0)])
def test_crossed_rods_move_alike_in_both_forms(kind: object) -> None:
    rail = make.fixed("rail", kind, rpy=[0, np.pi / 2, 0] if kind.kind != "edge" else [0, 0, 0])  # type: ignore[attr-defined,arg-type]
    rod = make.dynamic(
        "rod",
        make.edge(1.0),
        mass=1.0,
        inertia=[1e-3, 0.1, 0.1],
        position=[0, 0.02, 0.1],
        rpy=[0.1, 0.05, 1.2],
    )
    paths = [
        ran([rail, rod], 0.5, [{"between": ["rod", "rail"], "form": form}])
        for form in ("edge_edge", "curves_block")
    ]
    assert len(paths[0].events) == 1
    assert paths[0].gap_max < 1e-12
    assert same(*paths, tolerance=1e-10)


def test_rods_that_touch_at_the_start_need_a_side() -> None:
    rail = make.fixed("rail", make.edge(2.0))
    rod = make.dynamic("rod", make.edge(1.0), mass=1.0, inertia=[1e-3, 0.1, 0.1], rpy=[0, 0, 1.2])
    with pytest.raises(SimulationError, match="give the contact a normal"):
        ran([rail, rod], 0.1, [{"between": ["rod", "rail"]}])
    above = ran([rail, rod], 0.1, [{"between": ["rod", "rail"], "normal": [0, 0, -1]}])
    assert above.force.min() > 0
    below = ran([rail, rod], 0.1, [{"between": ["rod", "rail"], "normal": [0, 0, 1]}])
    assert below.force.max() == 0
    assert below.p[-1, 1, 2] == pytest.approx(-G * 0.1**2 / 2)


def test_a_point_passes_a_rod_at_a_distance() -> None:
    tip = make.dynamic("tip", make.point(0, 0, -0.2), mass=1.0, inertia=[0.01] * 3, position=[0, 0.3, 0.5])
    path = ran([make.fixed("rod", make.edge(2.0)), tip], 0.4, [{"between": ["tip", "rod"]}])
    fallen = 0.3 - G * path.t**2 / 2
    assert np.abs(path.gap[:, 0] - np.hypot(0.3, fallen)).max() < 1e-12


def test_two_points_are_refused_with_the_reason() -> None:
    bodies = [
        make.fixed("pin", make.point()),
        make.dynamic("tip", make.point(), mass=1.0, inertia=[0.01] * 3, position=[0, 0, 1]),
    ]
    for form in ("auto", "explicit"):
        scene = make.scene("points", bodies, contact=[{"between": ["tip", "pin"], "form": form}])
        with pytest.raises(SceneError, match=r"no normal where they touch.*make it a sphere"):
            require(scene)


def test_a_segment_falls_on_a_table_as_its_two_ends_do() -> None:
    def fell(*shapes: Shape) -> Trajectory:
        rod = make.dynamic(
            "rod",
            *shapes,
            mass=0.3,
            inertia=[2e-3, 2e-3, 1e-5],
            position=[0, 0, 0.15],
            rpy=[0.3, 1.2, 0],
            angular_velocity=[1, 2, 0],
        )
        names = ["rod"] if len(shapes) == 1 else ["rod/low", "rod/high"]
        law = {"restitution": 0.4, "friction": 0.3}
        return ran([TABLE, rod], 0.5, [{"between": [name, "table"], **law} for name in names])

    whole = fell(make.segment(0.2))
    ends = fell(make.point(0, 0, -0.1, name="low"), make.point(0, 0, 0.1, name="high"))
    assert sum(event.kind == "impact" for event in whole.events) > 4
    assert same(whole, ends, tolerance=1e-9)
    assert whole.gap.min() > -1e-10
