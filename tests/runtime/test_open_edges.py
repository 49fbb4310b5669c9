"""Bodies that pass over an edge at which a chart or a spline is open, and those that do not."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from modelgen import simulate, start
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.oracles.pieces import TABLE, ball
from tests.running import library_of

END, RADIUS = 0.3, 0.05  # of the sheets, along x and y, and of the ball, m
KNOTS = [-END, -0.1, 0.1, END]
TUBE = ("0.1*cos(u)*(1 + 0.1*cos(3*u))", "0.1*sin(u)", "v")
SHEETS = {
    "chart": make.chart("u", "v", "0.1*u*v", domain=((-END, END), (-END, END))),
    "height field": make.height_field(KNOTS, KNOTS, [[0.0] * 4] * 4),
    "spline": make.bspline([[[x, y, 0.0] for y in KNOTS] for x in KNOTS]),
}
NAMES = ["chart", *(pytest.param(name, marks=pytest.mark.slow) for name in list(SHEETS)[1:])]


def run(a: Body, b: Body, until: float = 0.4) -> Trajectory:
    scene = make.scene("edges", [a, b], contact=[{"between": [a.name, b.name]}])
    return simulate(library_of(scene), until=until, samples=20, estimate=False)


def fallen(name: str, x: float, speed: float = 0.0) -> Trajectory:
    """A ball that falls on a sheet near its edge x = END."""
    start = ball("ball", [x, 0.0, 0.06], RADIUS, velocity=[speed, 0.0, 0.0])
    return run(make.fixed("sheet", SHEETS[name]), start)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("x", "speed"), [(0.31, 0.0), (0.345, 0.0), (0.2, 0.5)], ids=["beside", "at its rim", "rolls off"]
)
def test_a_ball_that_an_edge_enters_is_told_and_not_trusted(name: str, x: float, speed: float) -> None:
    path = fallen(name, x, speed)
    (passage,) = path.over_edges
    assert path.outcome is Outcome.DONE
    assert passage.between == ("sheet", "ball")
    assert any("an open edge or end of sheet" in doubt for doubt in path.doubts)
    assert any("an open edge or end of sheet passes through ball" in each for each in path.warnings)
    assert path.summary()["over_edges"] == [{"between": ["sheet", "ball"], "t": passage.t}]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("x", [0.0, 0.2499, 0.36])
def test_a_ball_that_no_edge_enters_is_trusted(name: str, x: float) -> None:
    path = fallen(name, x)
    assert not path.over_edges
    assert not path.doubts


def test_the_time_is_that_at_which_the_edge_enters() -> None:
    path = fallen("chart", 0.31)
    drop = 0.06 - (RADIUS**2 - 0.01**2) ** 0.5
    assert path.over_edges[0].t == pytest.approx((2 * drop / 9.81) ** 0.5, abs=5e-3)


@pytest.mark.parametrize("x", [0.0, 0.31])
def test_a_run_that_its_caller_drives_has_the_same_verdict(x: float) -> None:
    """As `simulate` with samples at the ends of its steps; also of pairs that no contact lists."""
    bodies = make.fixed("sheet", SHEETS["chart"]), ball("ball", [x, 0.0, 0.06], RADIUS), TABLE
    scene = make.scene("edges", list(bodies), contact=[{"between": ["sheet", "ball"]}])
    library = library_of(scene)
    sim = start(library, estimate=True)
    for k in range(20):
        sim.step(until=0.02 * (k + 1))
    driven, path = sim.trajectory(), simulate(library, until=0.4, samples=20)
    assert np.array_equal(driven.p[-1], sim.trajectory().p[-1])
    assert driven.t == pytest.approx(path.t)
    assert [each.between for each in driven.over_edges] == [each.between for each in path.over_edges]
    assert [each.between for each in driven.undeclared] == [each.between for each in path.undeclared]
    assert bool(driven.over_edges) == (x > END)
    assert driven.is_trusted == path.is_trusted
    assert [each.partition("(")[0] for each in driven.doubts] == [
        each.partition("(")[0] for each in path.doubts
    ]


def test_an_open_duct_is_wide_enough_for_one_ball_and_not_for_another() -> None:
    duct = make.chart(*TUBE, domain=((0.0, 2 * pi), (0.0, 0.3)), periodic=(True, False), cavity=True)
    seat = make.fixed("duct", duct)
    assert not run(seat, ball("ball", [0.0, 0.0, 0.5], 0.05), 0.6).over_edges
    assert run(seat, ball("ball", [0.0, 0.0, 0.5], 0.15), 0.6).over_edges


def test_a_wall_without_ends_falls_through_a_table_and_says_so() -> None:
    wall = make.profile_wall([[x / 10, (x / 10) ** 2] for x in range(-4, 4)], 0.6)
    body = make.dynamic("wall", wall, mass=1.0, inertia=[0.01] * 3, position=[0, 0, 0.4])
    path = run(TABLE, body)
    assert [each.between for each in path.over_edges] == [("wall", "table")]


def test_a_rim_is_no_open_edge() -> None:
    cone = make.revolution("0.03 + 2*t", "t", domain=(0.0, 0.1), cavity=True)
    path = run(make.fixed("funnel", cone), ball("ball", [0.0, 0.0, 0.06], RADIUS))
    assert not path.over_edges
    assert not path.doubts


WIRES = {
    "curve": make.curve("t", "0.0", "0.2*t**2", domain=(-0.1, 0.1)),
    "polyline": make.polyline([[-0.1, 0, 0], [0, 0, 0.02], [0.1, 0, 0]], 0.05),
    "spline": make.bspline_curve([[-0.1, 0, 0], [-0.05, 0, 0.01], [0.05, 0, 0.01], [0.1, 0, 0]]),
}


@pytest.mark.parametrize("name", WIRES)
@pytest.mark.parametrize("is_end", [False, True], ids=["middle", "end"])
def test_a_wire_that_falls_with_an_end_into_a_ball_is_told_and_not_trusted(name: str, is_end: bool) -> None:
    """It stands upright above the ball, or is level across it."""
    turn, height = (pi / 2, 0.16) if is_end else (pi, 0.08)
    low = make.fixed("low", make.sphere(0.05))
    pose = {"position": [0.0, 0.0, height], "rpy": [0.0, turn, 0.0]}
    wire = make.dynamic("wire", WIRES[name], mass=1.0, inertia=[0.1] * 3, **pose)
    path = run(wire, low, 0.12)
    assert [each.between for each in path.over_edges] == ([("wire", "low")] if is_end else [])
    assert bool(path.doubts) == is_end
