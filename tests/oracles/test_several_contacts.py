"""Several contacts at once: forces in balance, redundant supports, and who lifts when."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran
from tests.running import library_of

CORNERS = [(0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)]
MASS = 2.0


def stool(feet: Sequence[tuple[float, float]], **keys: object):
    """A slab on spherical feet that touch the table."""
    shapes = [make.sphere(0.02, name=f"f{i}", position=[x, y, -0.1]) for i, (x, y) in enumerate(feet)]
    return make.dynamic("slab", *shapes, mass=MASS, inertia=[0.1, 0.1, 0.15], position=[0, 0, 0.12], **keys)


def stood(feet: Sequence[tuple[float, float]], until: float, **keys: object) -> Trajectory:
    contact = [{"between": [f"slab/f{i}", "table"]} for i in range(len(feet))]
    return ran([TABLE, stool(feet)], until, contact, **keys)


def load_at(x: float, y: float, force: str) -> list[dict[str, object]]:
    return [{"body": "slab", "point": [x, y, -0.12], "force": ["0.0", "0.0", force]}]


def test_three_feet_share_the_weight_by_their_levers() -> None:
    feet = [(0.3, 0.1), (-0.2, 0.25), (-0.1, -0.3)]
    path = stood(feet, 1.0, force=load_at(0.05, 0.02, "-5-3*sin(7*t)"))
    levers = np.vstack([np.ones(3), np.transpose(feet)])
    push = 5 + 3 * np.sin(7 * path.t)
    sums = np.outer([1, 0, 0], MASS * G + 0 * push) + np.outer([1, 0.05, 0.02], push)
    assert np.abs(path.force - np.linalg.solve(levers, sums).T).max() < 1e-10
    assert not path.events


@pytest.mark.parametrize("feet", [CORNERS, [*CORNERS, (0.1, 0.05)]], ids=["four", "five"])
def test_redundant_feet_carry_the_least_forces_that_balance(feet: list[tuple[float, float]]) -> None:
    path = stood(feet, 1.0, force=load_at(0.05, 0.02, "-5.0"))
    # the least norm of the forces weighed by sqrt(A_ii), A = J M^-1 J^T
    A = np.array([[1 / MASS + y * y / 0.1 + x * x / 0.1] for x, y in feet]).ravel()
    levers = np.vstack([np.ones(len(feet)), np.transpose(feet)])
    sums = np.array([MASS * G + 5, 5 * 0.05, 5 * 0.02])
    least = np.linalg.pinv(levers / np.sqrt(A)) @ sums / np.sqrt(A)
    assert np.abs(path.force - least).max() < 1e-9
    assert np.abs(path.p[:, 1] - [0, 0, 0.12]).max() < 1e-14


def test_a_load_beyond_the_edge_lifts_two_feet_when_their_moment_is_gone() -> None:
    path = stood(CORNERS, 2.2, force=load_at(0.6, 0, "-10*t"))
    lifts = [event for event in path.events if event.kind == "lift-off"]
    assert {event.contact.split("-")[0] for event in lifts} == {"slab/f1", "slab/f2"}
    assert [event.t for event in lifts] == pytest.approx([MASS * G / 10] * 2, abs=1e-7)
    before = path.t < 1.96
    assert np.abs(path.force[before, 0] - (MASS * G / 4 + 7.5 * path.t[before])).max() < 1e-10
    assert imbalance(path) < 1e-10


def test_a_foot_without_force_on_a_slab_at_rest_does_not_lift() -> None:
    # the least forces leave the far corner bare, long before the slab tips
    path = stood(CORNERS, 2.0, force=load_at(0.3, 0.3, "-20*sin(2*pi*t)**2"))
    assert path.force[:, 2].min() == 0
    assert not path.events
    assert np.abs(path.p[:, 1] - [0, 0, 0.12]).max() < 1e-13
    assert path.energy_drift < 1e-10
    levers = np.vstack([np.ones(4), np.transpose(CORNERS)])
    push = 20 * np.sin(2 * np.pi * path.t) ** 2
    sums = np.outer([MASS * G, 0, 0], 1 + 0 * push) + np.outer([1, 0.3, 0.3], push)
    assert np.abs(levers @ path.force.T - sums).max() < 1e-10


def test_a_load_on_the_diagonal_tips_a_slab_over_one_corner() -> None:
    path = stood(CORNERS, 2.1, force=load_at(0.6, 0.6, "-10*t"))
    lifts = {event.contact.split("-")[0]: event.t for event in path.events if event.kind == "lift-off"}
    assert set(lifts) == {"slab/f1", "slab/f2", "slab/f3"}
    assert list(lifts.values()) == pytest.approx([MASS * G / 10] * 3, abs=1e-7)
    assert imbalance(path) < 1e-10


def test_a_sliding_spinning_slab_on_redundant_feet_moves_freely() -> None:
    contact = [{"between": [f"slab/f{i}", "table"]} for i in range(4)]
    moving = stool(CORNERS, velocity=[0.5, 0.2, 0], angular_velocity=[0, 0, 3.0])
    path = ran([TABLE, moving], 5.0, contact)
    assert np.abs(path.p[:, 1] - np.outer(path.t, [0.5, 0.2, 0]) - np.array([0, 0, 0.12])).max() < 1e-11
    assert np.abs(path.force - MASS * G / 4).max() < 1e-8
    assert not path.events


def test_balls_stacked_in_a_tube_press_by_the_weight_above() -> None:
    # two dimensions: each ball touches the wall, centres zigzag at the angle asin of half the clearance
    radius, offset = 0.1, 0.05
    rise = float(np.sqrt(4 * radius**2 - 4 * offset**2))
    tube = make.fixed("tube", make.cylinder(radius + offset, cavity=True))
    balls = [ball(f"b{i}", [offset * (-1) ** i, 0, radius + rise * i], mass=1.0 + i) for i in range(4)]
    contact = [{"between": ["b0", "table"]}]
    contact += [{"between": [b.name, "tube"]} for b in balls]
    contact += [{"between": [f"b{i}", f"b{i + 1}"]} for i in range(3)]
    path = ran([TABLE, tube, *balls], 3.0, contact)
    above = np.array([G * sum(1.0 + k for k in range(i + 1, 4)) for i in range(3)])
    side = above * 2 * offset / rise
    force = {
        name: sum(
            force
            for each, force in zip(path.contact_names, path.force.T, strict=True)
            if each.split("#")[0] == name
        )
        for name in {each.split("#")[0] for each in path.contact_names}
    }
    assert np.abs(force["b0-table"] - 10 * G).max() < 1e-8
    for i in range(3):
        assert np.abs(force[f"b{i}-b{i + 1}"] - above[i] * 2 * radius / rise).max() < 1e-7
    assert np.abs(force["b3-tube"] - side[2]).max() < 1e-7
    assert np.abs(force["b1-tube"] - side[0] - side[1]).max() < 1e-7
    assert np.ptp(path.p, axis=0).max() < 1e-12


def test_a_ball_wedged_between_two_planes_is_held_by_both() -> None:
    left, right = ({"axis": [0, 1, 0], "angle": sign * 0.6} for sign in (1, -1))
    walls = [make.fixed("l", make.plane(), axis_angle=left), make.fixed("r", make.plane(), axis_angle=right)]
    height = 0.1 / np.cos(0.6)
    path = ran([*walls, ball("b", [0, 0, height])], 2.0, [{"between": ["b", side]} for side in "lr"])
    assert np.abs(path.force - G / (2 * np.cos(0.6))).max() < 1e-10
    assert np.abs(path.p[:, 2] - [0, 0, height]).max() < 1e-14


def test_bodies_that_fly_apart_take_no_more_steps_the_farther_they_are() -> None:
    """A box has faces without bound of their own, and is bounded."""
    block = make.fixed("block", make.box(0.3, 0.04, 0.01))
    puck = make.dynamic("puck", make.cylinder(0.015, 0.01), density=1000.0, position=[0.5, 0, 0])
    library = library_of(make.scene("away", [block, puck], contact=[{"between": ["puck", "block"]}]))
    near, far = (simulate(library, until=until, estimate=False) for until in (0.5, 8.0))
    assert near.steps < 20
    assert far.steps < near.steps + 20
    assert far.p[-1, far.body_names.index("puck"), 2] == pytest.approx(-9.81 * 32, rel=1e-12)


def turned(size: float, angle: np.ndarray) -> np.ndarray:
    """Corners (n, 4, 2) of a square about the origin."""
    corners = size / 2 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]])
    c, s = np.cos(angle), np.sin(angle)
    return np.einsum("nij,kj->nki", np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], 1), corners)


def are_apart(first: np.ndarray, second: np.ndarray, angles: Sequence[np.ndarray]) -> np.ndarray:
    """Whether a line divides squares (n, 4, 2) that are turned by these angles."""
    apart = np.zeros(len(first), dtype=bool)
    for angle in angles:
        for more in (0.0, np.pi / 2):
            way = np.stack([np.cos(angle + more), np.sin(angle + more)], -1)
            a, b = (np.einsum("nki,ni->nk", each, way) for each in (first, second))
            apart |= (a.min(1) > b.max(1)) | (b.min(1) > a.max(1))
    return apart


@pytest.mark.cases(1)
@pytest.mark.parametrize("bead", [False, True])
@pytest.mark.parametrize("spin", [10.0, 30.0, 300.0])
def test_the_head_of_a_long_arm_strikes_what_it_swings_into(spin: float, bead: bool) -> None:
    """However small it is, and whatever else there is; against the separating axes of two squares."""
    size = 0.03
    head = make.box(size, size, size, name="head", position=[1.0, 0, 0])
    arm = make.dynamic(
        "arm", head, mass=1.0, inertia=[1.0, 1.0, 1.0], position=[-1.2, 0.003, 0.002],
        velocity=[spin / 300, 0, 0], angular_velocity=[0, 0, spin], rpy=[0, 0, -1.5],
    )  # fmt: skip
    wall = make.fixed("wall", make.box(size, size, size))
    bodies, contact = [wall, arm], [{"between": ["arm/head", "wall"], "restitution": 1.0}]
    if bead:
        bodies.append(ball("bead", [5, 5, 5]))
        contact.append({"between": ["bead", "wall"]})
    t = np.arange(0, 60 / spin, 3e-4 / spin)
    angle = -1.5 + spin * t
    at = np.stack([-1.2 + spin / 300 * t + np.cos(angle), 0.003 + np.sin(angle)], -1)
    apart = are_apart(turned(size, angle) + at[:, None], turned(size, 0 * angle), [angle, 0 * angle])
    touches = t[np.argmin(apart)]
    scene = make.scene("swung", bodies, contact=contact, gravity=[0, 0, 0])
    path = simulate(
        library_of(scene), until=float(touches) + 1 / spin, accuracy="fast", samples=4, estimate=False
    )
    strikes = [event.t for event in path.events if event.kind == "impact"]
    assert not apart.all()
    assert strikes[0] == pytest.approx(touches, abs=4e-4 / spin)


@pytest.mark.parametrize("points", [1, 2])
def test_closest_points_that_no_contact_can_follow_are_told(points: int) -> None:
    """A bar falls across a ring, which it touches twice; with one contact it sinks in, which ends the run."""
    ring = make.fixed("ring", make.torus(0.3, 0.05))
    lying = {"axis": [0, 1, 0], "angle": 1.6}
    bar = make.dynamic(
        "bar",
        make.capsule(0.03, 1.0),
        mass=1.0,
        inertia=[0.1, 0.1, 0.01],
        position=[0, 0, 0.15],
        axis_angle=lying,
    )
    scene = make.scene("bar", [ring, bar], contact=[{"between": ["ring", "bar"], "points": points}])
    path = simulate(library_of(scene), until=0.4)
    told = [warning for warning in path.warnings if "more closest points within reach" in warning]
    assert (path.unfollowed_minima > 0) == (points == 1)
    assert len(told) == (points == 1)
    reasons = path.estimate.uncertified if path.estimate else ()
    assert any("no contact was free" in reason for reason in reasons) == (points == 1)
    assert all("points = 2" in warning for warning in told)
    assert path.outcome is (Outcome.PENETRATED if points == 1 else Outcome.DONE)
    assert (path.penetration_max > 1e-7) == (points == 1)
    assert path.outcome_contact == ("ring-bar" if points == 1 else "")
    sunk = [doubt for doubt in path.doubts if "penetrated by" in doubt]
    assert len(sunk) == (points == 1)
    assert all(f"(ring-bar, t = {path.t_end:.6g} s)" in doubt for doubt in sunk)
    assert not sunk or path.penetration_pair == "ring-bar"


def in_a_groove(places: Sequence[float]) -> Scene:
    """Balls that are thrown along a groove of two planes, in which each touches both."""
    walls = [
        make.fixed(name, make.plane(), rpy=[turn, 0, 0])
        for name, turn in (("left", np.pi / 4), ("right", -np.pi / 4))
    ]
    balls = [
        make.dynamic(
            f"ball{k}", make.sphere(0.1), density=1000.0, position=[place, 0, 0.1 * float(np.sqrt(2))],
            velocity=[1.0 + place, 0, 0],
        )
        for k, place in enumerate(places)
    ]  # fmt: skip
    contact = [
        {"between": [each.name, wall.name], "friction": 0.3, "restitution": 0.0}
        for each in balls
        for wall in walls
    ]
    return make.scene("groove", [*walls, *balls], contact=contact)


def test_balls_that_do_not_meet_have_motions_that_are_proved_one_by_one() -> None:
    """Each is held by more rows than are independent; no two of them share a body that forces move."""
    places = (0.0, 1.0, 2.0)
    alone = [simulate(library_of(in_a_groove([each])), until=0.5) for each in places]
    together = simulate(library_of(in_a_groove(places)), until=0.5)
    assert together.redundant_max > alone[0].redundant_max > 0
    for k, path in enumerate(alone):
        assert not path.doubts
        assert together.p[:, 2 + k] == pytest.approx(path.p[:, 2], abs=1e-9)
    assert not together.doubts
