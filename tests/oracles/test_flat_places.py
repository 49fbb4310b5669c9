"""Bodies that rock over places where their curvature vanishes, or where two points of contact become one.

A body that swings in a plane on the floor has one angle a: with the height h(a) of its centre, its velocity
is h'(a) a_dot upwards, and h(a) a_dot along where it rolls, so that

    (I + m (h'^2 + [rolls] h^2)) a_dot^2 / 2 + m g h = m g h(a_0),

and the time between two angles is an integral. h' is continuous at these places, h'' is infinite or jumps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

MASS, INERTIA, GRAVITY = 0.7, 0.0011, 9.81
ROLLS = {"slides": 0, "rolls": 1}
NODES, WEIGHTS = np.polynomial.legendre.leggauss(80)


@dataclass(frozen=True)
class Rocker:
    """A body's shape, its height h and h' over its angle, where it starts, and where h'' is not smooth."""

    shape: str
    upright: float  # rad, its rotation about y at a = 0
    start: float  # rad
    bend: float  # rad
    height: Callable[[float], float]
    lever: Callable[[float], float]

    def speed(self, a: float, rolls: int) -> float:
        inertia = INERTIA + MASS * (self.lever(a) ** 2 + rolls * self.height(a) ** 2)
        return float(np.sqrt(2 * MASS * GRAVITY * (self.height(self.start) - self.height(a)) / inertia))

    def time(self, a: float, rolls: int) -> float:
        """From the start down to 0 <= a."""
        bend = max(self.bend, a)
        return sum(self._part(low, high, rolls) for low, high in ((bend, self.start), (a, bend)))

    def _part(self, low: float, high: float, rolls: int) -> float:
        c = (1 + NODES) / 2  # in which the integrand is smooth
        angles = low + (high - low) * (3 - 2 * c) * c * c
        rates = [self.speed(a, rolls) for a in angles]
        return float((high - low) * np.sum(WEIGHTS / 2 * 6 * c * (1 - c) / rates))


def superellipsoid() -> Rocker:
    """|x/A|^3 + |z/C|^3 = 1 in the plane of its motion; its support function to the power 3/2 is a sum."""
    A, C = 0.05, 0.08

    def total(a: float) -> float:
        return float((A * np.cos(a)) ** 1.5 + (C * abs(np.sin(a))) ** 1.5)

    def lever(a: float) -> float:
        along = C**1.5 * np.sqrt(abs(np.sin(a))) * np.cos(a) * np.sign(a)
        return float(total(a) ** (-1 / 3) * (along - A**1.5 * np.sqrt(np.cos(a)) * np.sin(a)))

    shape = f'kind = "superellipsoid", semi_axes = [{A}, 0.06, {C}], exponents = [2.0, 3.0]'
    return Rocker(shape, np.pi / 2, 0.3, 0.0, lambda a: total(a) ** (2 / 3), lever)


def wave() -> Rocker:
    """x = A cos t, z = C cos 2t: on the points cos t = A tan(a)/4C, or on t = 0 from where they meet."""
    A, C = 0.084, 0.0185
    bend = float(np.arctan(4 * C / A))

    def height(a: float) -> float:
        sine, cosine = np.sin(abs(a)), np.cos(a)
        single = A * sine - C * cosine
        return float(C * cosine + (A * sine) ** 2 / (8 * C * cosine) if abs(a) < bend else single)

    def lever(a: float) -> float:
        sine, cosine = np.sin(abs(a)), np.cos(a)
        double = -C * sine + A * A / (8 * C) * (2 * sine + sine**3 / cosine**2)
        return float(np.sign(a) * (double if abs(a) < bend else A * cosine + C * sine))

    turn = "domain = [0.0, 6.283185307179586], periodic = true"
    shape = f'kind = "curve", x = "{A} * cos(t)", y = "0.0432 * sin(t)", z = "{C} * cos(2 * t)", {turn}'
    return Rocker(shape, 0.0, 0.9, bend, height, lever)


def library(rocker: Rocker, name: str) -> Library:
    """Two of them, one on a smooth floor and one that rolls."""
    half = (rocker.upright + rocker.start) / 2
    quaternion = f"[{np.cos(half):.17g}, 0.0, {np.sin(half):.17g}, 0.0]"
    text = '[[body]]\nname = "floor"\nmotion = "fixed"\nshape = { kind = "plane" }\n'
    for body, rolls in ROLLS.items():
        text += (
            f'[[body]]\nname = "{body}"\nshape = {{ {rocker.shape} }}\nmass = {MASS}\n'
            f"inertia = [0.0013, {INERTIA}, 0.0009]\nquaternion = {quaternion}\n"
            f"position = [0.0, {0.5 * rolls}, {rocker.height(rocker.start):.17g}]\n"
        )
        text += f'[[contact]]\nbetween = ["{body}", "floor"]\n' + "friction = 5.0\n" * rolls
    return library_of(read_text(text, f"{name}.toml"))


def errors(rocker: Rocker, path: Trajectory, body: str) -> tuple[float, float]:
    """The largest error of the angle, rad, and of the energy, relative."""
    rolls, b = ROLLS[body], path.body_names.index(body)
    quarter = rocker.time(0.0, rolls)
    angle = energy = 0.0
    for t, q, w in zip(path.t[1:], path.quaternion[1:, b], path.w[1:, b, 1], strict=True):
        a = 2 * np.arctan2(q[2], q[0]) - rocker.upright
        since = rocker.time(min(abs(a), rocker.start * (1 - 1e-12)), rolls)
        since = since if a * w <= 0 else -since  # from the turning point on this side
        side = 0.0 if a > 0 else 2 * quarter
        late = (t - side - since + 2 * quarter) % (4 * quarter) - 2 * quarter
        kinetic = (INERTIA + MASS * (rocker.lever(a) ** 2 + rolls * rocker.height(a) ** 2)) * w * w / 2
        deep = MASS * GRAVITY * (rocker.height(rocker.start) - rocker.height(0.0))
        left = kinetic - MASS * GRAVITY * (rocker.height(rocker.start) - rocker.height(a))
        angle = max(angle, abs(late * w) if abs(w) > 0.3 else 0.0)
        energy = max(energy, abs(left) / deep)
    return angle, energy


@pytest.mark.parametrize(("accuracy", "bound"), [("balanced", 2e-8), ("tight", 2e-10)])
def test_rocks_over_a_place_without_curvature(accuracy: str, bound: float) -> None:
    rocker = superellipsoid()
    path = simulate(library(rocker, "rocker"), until=3.0, samples=61, accuracy=accuracy, estimate=False)
    assert path.outcome is Outcome.DONE
    assert any("37 times" in warning and "peaks" in warning for warning in path.warnings)
    for body in ROLLS:
        angle, energy = errors(rocker, path, body)
        assert angle < bound
        assert energy < bound / 5


@pytest.mark.parametrize(("accuracy", "bound"), [("balanced", 1e-9), ("tight", 1e-10)])
def test_rolls_from_one_point_to_two_and_back(accuracy: str, bound: float) -> None:
    rocker = wave()
    path = simulate(library(rocker, "wave"), until=0.25, samples=51, accuracy=accuracy, estimate=False)
    assert path.outcome is Outcome.DONE
    for body in ROLLS:
        closed = np.array([name.startswith(body) for name in path.contact_names])
        touching = (path.force[:, closed] > 0).sum(axis=1)
        assert touching.max() == 2
        assert touching[0] == touching[-1] == 1
        angle, energy = errors(rocker, path, body)
        assert angle < bound
        assert energy < bound
    assert np.nanmin(path.gap) > -1e-10


def test_coarse_runs_tell_their_error() -> None:
    rocker = superellipsoid()
    built = library(rocker, "rocker")
    path = simulate(built, until=1.0, samples=21, accuracy=Accuracy.of(1e-9), estimate=True)
    angle = max(errors(rocker, path, body)[0] for body in ROLLS)
    assert path.estimate is not None
    assert path.estimate.status == "estimated"
    assert angle < 3 * path.estimate.rotation[-1] < 1e-4
