"""Cans, tubes, pucks, columns and boxes that spin upright, and may slide, until friction stops them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from modelgen import Accuracy, simulate, start
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Event, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.planar.scenes import events, table
from tests.planar.spun_faces import NEARLY_TIPPING, Disc, G, Polygon, Spun, course, ending
from tests.running import library_of

KINDS = ("can", "tube", "puck", "column", "box")
SLIDES = (-2, 1)  # decades of the sliding velocity over that of the rim by the spin
NEAREST = 1e-6  # margin of the centre of pressure, in radii, near which a run tips
EARLY = {"can": 0.0, "tube": 0.0, "column": 1e-5, "box": 1e-5}  # part of the time by which it may be before
ABOVE = [seed for seed in range(25) if KINDS[seed % 5] != "puck"]
ALLOWED = {"tight": 1e-8, "balanced": 1e-6}


class Member(NamedTuple):
    body: Spun
    shape: Shape
    mass: float
    part: (
        float  # mu h over the distance of the nearest edge from the middle: from 1 on it tips while it slides
    )
    v: np.ndarray  # (2,) m/s
    w: float  # rad/s


def member(seed: int, parts: tuple[float, float], slides: tuple[float, float] | None) -> Member:
    """Radius, friction, height, inertia, mass, spin and sliding velocity by decades; `slides`: those of the
    sliding velocity over that of the rim by the spin."""
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    radius, mu, inertia = 10 ** random.uniform(-2, -0.7), random.uniform(0.1, 0.9), random.uniform(0.3, 0.9)
    part = random.uniform(0, 0.1) if kind == "puck" else random.uniform(*parts)
    edge = radius  # distance of the nearest edge
    if kind == "column":
        n = int(random.integers(3, 8))
        angle = 2 * np.pi * np.arange(n) / n + random.uniform(0, 6)
        corners, edge = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1), radius * np.cos(np.pi / n)
    elif kind == "box":
        edge = radius * random.uniform(0.3, 1)
        corners = np.array([[radius, edge], [-radius, edge], [-radius, -edge], [radius, -edge]])
    height = part * edge / mu
    if kind == "tube":
        bore = radius * random.uniform(0.2, 0.95)
        pieces, inertia = ((1, Disc(radius)), (-1, Disc(bore))), (1 + (bore / radius) ** 2) / 2
        shape = make.tube(radius, bore, 2 * height)
    elif kind == "column":
        pieces, shape = ((1, Polygon(corners)),), make.extrusion(2 * height, points=corners.tolist())
    elif kind == "box":
        pieces, shape = ((1, Polygon(corners)),), make.box(2 * radius, 2 * edge, 2 * height)
    else:
        pieces, shape = ((1, Disc(radius)),), make.cylinder(radius, 2 * height)
    w = random.choice([-1, 1]) * np.sqrt(G / radius) * 10 ** random.uniform(-0.7, 0.7)
    way = random.uniform(0, 2 * np.pi)
    speed = abs(w) * radius * 10 ** random.uniform(*slides) if slides else 0.0
    mass = 10 ** random.uniform(-2, 1)
    return Member(
        Spun(pieces, mu, height, inertia, radius),
        shape,
        mass,
        part,
        speed * np.array([np.cos(way), np.sin(way)]),
        w,
    )


def library_with(of: Member) -> Library:
    body, m = of.body, of.mass
    about = m * body.inertia * body.radius**2
    across = m * body.height**2 / 3 + about
    upright = make.dynamic(
        "body", of.shape, mass=m, inertia=[across, across, about],
        position=[0, 0, body.height], velocity=[*of.v, 0], angular_velocity=[0, 0, of.w],
    )  # fmt: skip
    touch = {"between": ["body", "table"], "friction": body.mu}
    return library_of(make.scene("spun", [table(), upright], contact=[touch]))


def run_of(of: Member, until: float, accuracy: str) -> Trajectory:
    return simulate(
        library_with(of), until=until, samples=300, accuracy=Accuracy.named(accuracy), estimate=False
    )


def first_events(of: Member, begin: float, end: float, accuracy: str) -> tuple[Event, ...]:
    """The first events after the time `begin`, of a hundredth of the time up to `end`, s."""
    run = start(library_with(of), accuracy=Accuracy.named(accuracy))
    run.step(begin)
    found = (run.step(t) for t in np.linspace(begin, end, 101)[1:])
    return next((each for each in found if each), ())


def check(of: Member, t: float, place: np.ndarray, accuracy: str) -> None:
    """It stops at the time t at a place, for good; no energy is gained on the way."""
    run = run_of(of, 1.2 * t, accuracy)
    allowed, way = ALLOWED[accuracy], of.body.radius + np.hypot(*place)
    assert run.doubts == ()
    (ended,) = events(run, "slip-stop")
    assert ended.t == pytest.approx(t, rel=allowed)
    assert np.abs(run.p[-1, 1, :2] - place).max() < allowed * way
    assert np.abs(run.v[-1, 1]).max() < 1e-9
    assert np.abs(run.w[-1, 1]).max() < 1e-9
    assert np.diff(run.energy).max() < 1e-14 * run.energy[0]


def area_and_distance(piece: Disc | Polygon) -> np.ndarray:
    """Area of a disc, a rectangle or a regular polygon; the distance from the middle, integrated over it."""
    if isinstance(piece, Disc):
        return np.array([np.pi * piece.radius**2, 2 * np.pi * piece.radius**3 / 3])
    n = len(piece.vertices)
    if n != 4:
        inner, half = np.hypot(*piece.vertices[0]) * np.cos(np.pi / n), np.tan(np.pi / n)
        return n * np.array([inner**2 * half, inner**3 / 3 * (half * np.hypot(1, half) + np.arcsinh(half))])
    a, b = np.hypot(*(piece.vertices[1:3] - piece.vertices[:2]).T) / 2
    mean = (2 * np.hypot(a, b) + a**2 / b * np.arcsinh(b / a) + b**2 / a * np.arcsinh(a / b)) / 6
    return 4 * a * b * np.array([1.0, mean])


@pytest.mark.cases(3)
@pytest.mark.parametrize("accuracy", ALLOWED)
@pytest.mark.parametrize("seed", range(50))
def test_bodies_that_spin_in_place_stop_in_closed_form(seed: int, accuracy: str) -> None:
    """The pressure stays uniform, so that the torque is mu m g times the mean distance from the axis: a can
    stops at 3 R w/(4 mu g). This is so too far above the height from which it would tip while it slides."""
    of = member(seed, (0.02, 3.0), None)
    area, distance = sum(sign * area_and_distance(piece) for sign, piece in of.body.pieces)
    t = of.body.inertia * of.body.radius**2 * abs(of.w) / (of.body.mu * G * distance / area)
    check(of, t, np.zeros(2), accuracy)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(50))
def test_slip_that_ends_while_spinning_is_that_of_an_independent_integration(seed: int) -> None:
    """Up to 0.99 of the height at which it tips."""
    of = member(seed, (0.02, 0.99), SLIDES)
    end = ending(of.body, of.v, of.w)
    assert end.margin > 2 * NEARLY_TIPPING
    for accuracy in ALLOWED:
        check(of, end.t, end.place, accuracy)


def test_a_can_tips_as_the_loaded_point_of_its_rim_comes_to_rest_and_gains_no_energy_before() -> None:
    """In the integration the centre of pressure is 2e-6 of the radius from the rim at 0.224 s, and by the
    rate of the root of that distance it is at the rim at 0.22487 s."""
    of = member(25, (1.05, 2.0), (-1, 0.1))
    run = run_of(of, 0.224, "balanced")
    assert run.doubts == ()
    assert {event.kind for event in run.events} == {"face-contact"}
    assert np.diff(run.energy).max() < 1e-14 * run.energy[0]
    assert first_events(of, 0.224, 0.2249, "balanced")[0].kind == "tipping"


def test_a_column_tips_over_its_straight_edge_as_an_integration_does() -> None:
    """In the integration the centre of pressure is 9.8e-6 of the radius from an edge at 0.06843076 s, and at
    its last rate it is at the edge at 0.06843460 s."""
    of = member(13, (1.05, 2.0), (-1, 0.1))
    for accuracy in ALLOWED:
        over = first_events(of, 0.0684, 0.0685, accuracy)[0]
        assert over.kind == "tipping"
        assert over.t == pytest.approx(0.06843460, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", ABOVE)
def test_above_the_height_of_tipping_it_tips_or_stops_as_an_independent_integration_does(seed: int) -> None:
    """Until it nearly tips it is at one place at both accuracies. It tips after the integration ends near the
    edge, and before the root of the margin vanishes at its last rate; at once if no pressure begins."""
    of = member(seed, (1.05, 2.0), (-1, 0.1))
    try:
        reached = course(of.body, of.v, of.w, NEARLY_TIPPING, NEAREST, 1e-11)
    except ArithmeticError:
        at_once = run_of(of, 1e-3 * np.sqrt(of.body.height / G), "balanced")
        assert {event.kind for event in at_once.events if event.t == 0} & {"tipping", "lift-off"}
        return
    nearly, end = reached[0], reached[-1]
    for accuracy in ALLOWED:
        if end.margin > 2 * NEARLY_TIPPING:
            check(of, end.t, end.place, accuracy)
            continue
        run = run_of(of, nearly.t, accuracy)
        assert run.doubts == ()
        assert {event.kind for event in run.events} == {"face-contact"}
        way = of.body.radius + np.hypot(*nearly.place)
        assert np.abs(run.p[-1, 1, :2] - nearly.place).max() < ALLOWED[accuracy] * way
        assert np.diff(run.energy).max() < 1e-14 * run.energy[0]
    if end.margin < NEARLY_TIPPING:
        roots = [np.sqrt(each.margin) for each in reached[-2:]]
        latest = end.t + 1.1 * (end.t - reached[-2].t) * roots[1] / (roots[0] - roots[1])
        over = first_events(of, nearly.t, latest, "balanced")[0]
        assert over.kind == "tipping"
        assert over.t > (1 - EARLY[KINDS[seed % 5]]) * end.t
