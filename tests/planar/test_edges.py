"""When and where the centre of pressure leaves a face, against moment balance in closed form."""

from __future__ import annotations

import json
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from modelgen import simulate
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import rotations
from tests.planar.scenes import HEIGHT, MASS, RADIUS, TIGHT, G, events, pushed, resting, standing, table
from tests.running import library_of, run

RATE, ARM = 2.0, 0.03  # N/s of a force along x, its height above the centre of mass, m


def exit_time(reach: float) -> float:
    """When the centre of pressure F h/(m g) has come as far as `reach`."""
    return reach * MASS * G / (RATE * ARM)


def glass(until: float, samples: int = 50):
    return pushed(make.cylinder(RADIUS, HEIGHT), [f"{RATE}*t", "0", "0"], [0, 0, ARM], until, samples)


def test_the_papers_glass_reaches_the_rim_when_and_where_moment_balance_says() -> None:
    """The reference values of the public case: t* = 1.962 s, 8.39178792 m."""
    path = glass(1.962, 50)
    assert exit_time(RADIUS) == pytest.approx(1.962, abs=1e-12)
    assert path.p[-1, 1, 0] == pytest.approx(8.39178792, abs=1e-7)
    tip = events(glass(2.0), "tipping")
    assert [event.features for event in tip] == ["bottom"]
    assert tip[0].t == pytest.approx(1.962, abs=1e-10)


def test_the_shipped_glass_tips_when_its_force_and_torque_have_driven_the_pressure_to_the_rim() -> None:
    path = run("glass_on_table", TIGHT)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(RADIUS * MASS * G / np.hypot(RATE * ARM, 0.01), abs=1e-10)
    rim = path.feature_pair_names.index("rim_bottom")
    assert (path.force[path.t > tip.t, rim] > 0).all()


def test_the_pressure_follows_the_force_and_bears_the_weight() -> None:
    path = glass(1.9)
    assert len(resting(path)) == len(path.t)
    along = RATE * path.t * ARM / (MASS * G)
    assert path.patch_force[:, 0] == pytest.approx(np.full(len(path.t), MASS * G), rel=1e-12)
    assert path.patch_point[:, 0, 0] - path.p[:, 1, 0] == pytest.approx(along, abs=1e-12)
    assert not path.force.any()


def test_after_the_rim_is_reached_the_lowest_point_of_it_stays_on_the_table() -> None:
    path = glass(2.1, 400)
    after = path.t > 1.963
    rim = path.contact_names.index("body-table:rim_bottom")
    assert (path.force[after, rim] > 0).all()
    assert np.abs(path.gap[after, rim]).max() < 1e-14
    lean = np.arctan2(rotations(path, 1)[after][:, 0, 2], rotations(path, 1)[after][:, 2, 2])
    lowest = path.p[after, 1, 2] - (HEIGHT / 2 * np.cos(lean) + RADIUS * np.sin(lean))
    assert np.abs(lowest).max() < 1e-12
    assert (np.diff(lean) > 0).all()


def polygon_tips(n: int, turn: float) -> float:
    """When the run of a regular polygon tips towards a vertex (turn 0) or the middle of a side (pi/n)."""
    corners = [[RADIUS * cos(2 * pi * k / n), RADIUS * sin(2 * pi * k / n)] for k in range(n)]
    force = [f"{RATE * cos(turn)!r}*t", f"{RATE * sin(turn)!r}*t", "0"]
    path = pushed(make.extrusion(HEIGHT, points=corners), force, [0, 0, ARM], exit_time(RADIUS) + 0.01, 4)
    (tip,) = events(path, "tipping")
    return tip.t


@pytest.mark.cases(3)
@pytest.mark.parametrize("n", [3, 4, 5, 6, 8, 16, pytest.param(64, marks=pytest.mark.slow)])
def test_a_regular_polygon_tips_when_its_inscribed_circle_or_vertex_is_reached(n: int) -> None:
    """Towards a vertex at R, across the middle of a side at R cos(pi/n); both tend to the circle's time."""
    assert polygon_tips(n, 0.0) == pytest.approx(exit_time(RADIUS), abs=1e-10)
    assert polygon_tips(n, pi / n) == pytest.approx(exit_time(RADIUS * cos(pi / n)), abs=1e-10)


@pytest.mark.slow
def test_the_times_of_polygons_tend_to_that_of_the_circle_with_the_square_of_the_side() -> None:
    circle = events(glass(exit_time(RADIUS) + 0.01, 4), "tipping")[0].t
    short = [circle - polygon_tips(n, pi / n) for n in (16, 32)]
    assert short[0] == pytest.approx(circle * (pi / 16) ** 2 / 2, rel=0.01)
    assert np.log2(short[0] / short[1]) == pytest.approx(2, abs=0.02)


def test_a_book_tips_when_its_centre_of_mass_passes_the_edge() -> None:
    desk = make.fixed("desk", make.box(1.0, 1.0, 0.1, position=[-0.5, 0, -0.05]))
    speed, start = 0.13, -0.05
    book = make.dynamic(
        "book", make.box(0.3, 0.2, 0.03), density=700.0, position=[start, 0.02, 0.015], velocity=[speed, 0, 0]
    )
    scene = make.scene("book", [desk, book], contact=[{"between": ["desk", "book"]}])
    path = simulate(library_of(scene), until=0.45, samples=10, accuracy=TIGHT)
    (tip,) = events(path, "tipping")
    assert tip.t == pytest.approx(-start / speed, abs=1e-10)
    assert path.w[-1, 1, 1] > 0


def test_a_lifted_glass_lets_go_everywhere_at_once() -> None:
    """The pull reaches the weight at m g/k; from there on all is free flight under a growing pull."""
    rate = 1.5
    path = pushed(make.cylinder(RADIUS, HEIGHT), ["0", "0", f"{rate}*t"], [0, 0, ARM], 2.2, 50)
    (flat,), (lift,) = events(path, "face-contact"), events(path, "lift-off")
    assert (flat.t, lift.features) == (0.0, "bottom")
    assert lift.t == pytest.approx(MASS * G / rate, abs=1e-9)
    assert not events(path, "tipping")
    late = path.t > lift.t
    flight = rate * (path.t[late] - lift.t) ** 3 / (6 * MASS)
    assert path.p[late, 1, 2] - HEIGHT / 2 == pytest.approx(flight, abs=1e-11)
    assert not path.force.any()


@pytest.mark.parametrize("speed", [0.0, 1.0])
def test_a_can_that_comes_down_flat_rests_flat(speed: float) -> None:
    drop = 0.05
    body = standing(make.cylinder(RADIUS, HEIGHT), height=HEIGHT / 2 + drop, velocity=[speed, 0, 0])
    scene = make.scene("drop", [table(), body], contact=[{"between": ["body", "table"]}])
    path = simulate(library_of(scene), until=0.3, samples=10, accuracy=TIGHT)
    (flat,) = events(path, "face-contact")
    assert flat.t == pytest.approx((2 * drop / G) ** 0.5, abs=1e-11)
    assert path.patch_force[-1, 0] == pytest.approx(MASS * G, rel=1e-12)
    assert path.p[-1, 1] == pytest.approx([speed * 0.3, 0, HEIGHT / 2], abs=1e-12)


def test_the_case_file_agrees_with_the_closed_form_used_here() -> None:
    data = Path(__file__).parent / "data" / "planar_contact_circle.json"
    reference = json.loads(data.read_text(encoding="utf-8"))["reference"]
    assert exit_time(RADIUS) == pytest.approx(reference["t_star"], abs=1e-12)
    assert RATE * reference["t_star"] ** 3 / (6 * MASS) == pytest.approx(
        reference["com_x_at_t_star"], abs=1e-8
    )
