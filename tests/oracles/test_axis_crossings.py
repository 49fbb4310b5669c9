"""A ball whose centre crosses the axis of a shape of revolution, where the nearest point leaps across."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from math import cos, hypot, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from modelgen import Accuracy, simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import G, ball, ran, times
from tests.oracles.test_coaxial_contacts import ANGLE, BALL, FALL, RING, SEATS, TUBE
from tests.running import library_of

Place = tuple[float, float]  # distance from the axis, height, m
RESTITUTION = 0.3
SCAN, SHORTEST = 2e-5, 2e-3  # s: of gaps; a flight after which impacts are compared no more
IMPACTS = 4


@dataclass(frozen=True)
class Meridian:
    """Distance of a place from a profile, and the unit normal from there to the place."""

    distance: Callable[[Place], float]
    normal: Callable[[Place], Place]


def about(radius: float, height: float = 0.0, tube: float = 0.0) -> Meridian:
    """A circle about the axis, or a tube about it."""

    def normal(at: Place) -> Place:
        length = hypot(at[0] - radius, at[1] - height)
        return (at[0] - radius) / length, (at[1] - height) / length

    return Meridian(lambda at: hypot(at[0] - radius, at[1] - height) - tube, normal)


def wall(angle: float, radius: float = 0.0) -> Meridian:
    """The inside of a cone, at the radius in the plane z = 0."""
    inward = (-cos(angle), sin(angle))
    return Meridian(lambda at: (at[0] - radius) * inward[0] + at[1] * inward[1], lambda at: inward)


MERIDIANS = {
    "circle": about(RING),
    "torus": about(RING, tube=TUBE),
    "tube": about(RING, height=0.04),
    "cone": wall(ANGLE),
    "revolution": wall(np.pi / 4, 0.01),
}


def impacts(seat: Meridian, start: tuple[float, float, float]) -> list[float]:
    """Times of the first impacts of a frictionless ball, s, from its parabolas and reflections."""
    p, v, t, found = np.array(start), np.zeros(3), 0.0, list[float]()

    def at(s: float) -> np.ndarray:
        return p + v * s - [0.0, 0.0, G / 2 * s * s]

    def gap(s: float) -> float:
        x = at(s)
        return seat.distance((hypot(x[0], x[1]), x[2])) - BALL

    while len(found) < IMPACTS:
        first = SCAN if found else 0.0
        s = first
        while gap(s) > 0:
            s += SCAN
        if s == first:
            break
        s = brentq(gap, s - SCAN, s, xtol=1e-16)
        if found and s < SHORTEST:
            break
        p, v = at(s), v - [0.0, 0.0, G * s]
        across = hypot(p[0], p[1])
        n_across, n_up = seat.normal((across, p[2]))
        n = np.array([n_across * p[0] / across, n_across * p[1] / across, n_up])
        v -= (1 + RESTITUTION) * (v @ n) * n
        t += s
        found.append(t)
    return found


@pytest.mark.parametrize("accuracy", [Accuracy.fast, Accuracy.balanced], ids=["fast", "balanced"])
@pytest.mark.parametrize("aside", [0.0, 1e-9, 0.03, 0.3])
@pytest.mark.parametrize("offset", [1e-3, 3e-3])
@pytest.mark.parametrize("name", MERIDIANS)
def test_a_ball_that_crosses_the_axis_strikes_the_other_side(
    name: str, offset: float, aside: float, accuracy: Callable[[], Accuracy]
) -> None:
    start = (offset, aside * offset, SEATS[name].height + FALL)
    expected = impacts(MERIDIANS[name], start)
    path = ran(
        [SEATS[name].body(), ball("ball", start, BALL)],
        expected[-1] + SHORTEST / 4,
        [{"between": ["ball", "seat"], "restitution": RESTITUTION}],
        accuracy=accuracy(),
        samples=100,
    )
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-9
    np.testing.assert_allclose(times(path, "impact")[: len(expected)], expected, atol=1e-6)
    centres = path.p[:, -1].astype(float)
    inside = [MERIDIANS[name].distance((hypot(x, y), z)) - BALL for x, y, z in centres]
    assert min(inside) > -1e-8


@pytest.mark.parametrize("start", [(0.005, 0.0), (0.005, 2.5e-9), (0.005, 5e-7), (0.01, 1e-4)])
def test_a_ball_that_has_bounced_across_a_ring_comes_to_rest_on_it(start: tuple[float, float]) -> None:
    path = ran(
        [SEATS["torus"].body(), ball("ball", [*start, 0.12], RING)],
        0.6,
        [{"between": ["ball", "seat"], "restitution": RESTITUTION, "friction": 0.2}],
    )
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-8
    height = sqrt((RING + TUBE) ** 2 - RING**2)
    np.testing.assert_allclose(path.p[-1, -1].astype(float), [0.0, 0.0, height], atol=1e-8)


@pytest.mark.cases(8)
@pytest.mark.parametrize("aside", [0.0, 1e-12, 1e-8, 1e-5, 1e-3, 3e-3])
@pytest.mark.parametrize("name", ["torus", "tube", "cone", "revolution"])
def test_a_start_is_refused_however_little_deeper_than_start_gap(name: str, aside: float) -> None:
    """On the axis, where the ball is as deep all around, and beside it."""
    seat, middle = MERIDIANS[name], SEATS[name].height

    def told(depth: float) -> list[float]:
        """The depth and what is allowed, m, in the message that refuses a start; none if none does."""

        def overlap(height: float) -> float:
            return BALL - depth - seat.distance((aside, height))

        height = brentq(overlap, middle - BALL / 10, middle + BALL / 10, xtol=1e-16)
        bodies = [SEATS[name].body(), ball("ball", [aside, 0.0, height], BALL)]
        scene = make.scene("sunk", bodies, contact=[{"between": ["ball", "seat"]}])
        try:
            simulate(library_of(scene), until=1e-9, samples=1, estimate=False)
        except SimulationError as error:
            return [float(number) for number in re.findall(r"(\S+) m\b", str(error))[:2]]
        return []

    allowed = told(1e-4)[1]
    assert told(0.5 * allowed) == []
    for depth in np.multiply([1.5, 2.0, 2.5, 3.0, 3.5, 4.5, 6.0, 9.0, 15.0, 17.0, 40.0, 1e3], allowed):
        np.testing.assert_allclose(told(depth), [depth, allowed], rtol=0.01)


@pytest.mark.parametrize("flattening", [0.3, 0.1, 0.01, 1e-3])
@pytest.mark.parametrize("start", [(-1.3e-4, 1.4e-6), (-1.2e-4, 1.9e-5), (-1e-3, 7.8e-4)])
def test_a_ball_in_an_ellipse_strikes_where_a_nearest_point_begins(
    flattening: float, start: tuple[float, float]
) -> None:
    a, b, radius = RING, RING * (1 - flattening), 0.034
    path = ran(
        [make.fixed("seat", make.ellipse_curve(a, b)), ball("ball", [*start, 0.06], radius)],
        0.2,
        [{"between": ["ball", "seat"], "restitution": RESTITUTION}],
        accuracy=Accuracy.balanced(),
    )
    at = np.linspace(0.0, 2 * np.pi, 20001)
    curve = np.stack([a * np.cos(at), b * np.sin(at), 0 * at], axis=1)
    nearest = [np.linalg.norm(curve - centre, axis=1).min() for centre in path.p[:, -1].astype(float)]
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-9
    assert min(nearest) > radius - 1e-8
