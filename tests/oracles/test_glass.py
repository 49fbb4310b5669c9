"""The glass after its base has left the table: the core against an own series and coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import atan2, cos, pi, sin

import numpy as np
import pytest
from mpmath import mp, mpf

from modelgen import Accuracy
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.flat_start import Rolling, rolled, scene_of_glass
from tests.oracles.glass_reference import DIGITS, G, Glass, Motion, Support, ellipse, harmonics, motion
from tests.oracles.power_series import Series

MASS, RADIUS, HEIGHT, ABOVE = 0.3, 0.04, 0.05, 0.03  # case P08: the force grows by 2 N/s
RAMP, START = 2.0, 1.962
TAU = np.linspace(0.0, 0.15, 16)[1:]
SERIES_UNTIL = 0.004  # s; where the series of order 24 has ended below rounding
ROUND = (4e-4, 4e-4, 3e-4)
PLANAR = Glass(
    harmonics(RADIUS), MASS, ROUND, HEIGHT, ABOVE, ((RAMP * START, RAMP), (0.0,)), velocity=(13.0, 0.0)
)
TURNING = replace(PLANAR, force=((RAMP * START, RAMP), (0.0, 20.0)))
TWISTED = replace(TURNING, torque=((0.0,), (0.0,), (0.02, 0.01)), spin=30.0)
CIRCLE = make.circle(RADIUS, position=[0.0, 0.0, -HEIGHT])
FEW_GLASSES = [
    pytest.param(PLANAR, id="one plane"),
    pytest.param(TURNING, id="turning", marks=pytest.mark.slow),
    pytest.param(TWISTED, id="turning and twisted"),
]


@cache
def reference(glass: Glass, start: float = SERIES_UNTIL) -> Motion:
    return motion(glass, TAU, start)


def errors(run: Rolling, motion: Motion) -> tuple[float, float]:
    """Of the position of the centre of mass, m, and of the rotation."""
    assert run.code == 0
    return float(abs(run.p - motion.p).max()), float(abs(run.rotation - motion.rotation).max())


@dataclass(frozen=True)
class Base:
    """A base, where the load leaves it, and the rims that have its shape, with eta there."""

    support: Support
    rims: dict[str, tuple[Shape, str, tuple[float, ...]]]
    normal: float  # angle of the outward normal

    @property
    def outward(self) -> tuple[float, float, float]:
        return (cos(self.normal), sin(self.normal), 0.0)

    def exit(self) -> np.ndarray:
        H, slope, _ = self.support(self.normal)
        n = np.array(self.outward[:2])
        return H * n + slope * np.array([-n[1], n[0]])

    def glass(self) -> Glass:
        """No symmetry left: three moments of inertia, a turning load, a torque, a spin."""
        push = self.exit() * MASS * G / ABOVE
        force = ((float(push[0]), 2.0), (float(push[1]), 5.0))
        torque = ((0.0,), (0.0,), (0.01, 0.02))
        return Glass(self.support, MASS, (4e-4, 4.6e-4, 3e-4), HEIGHT, ABOVE, force, torque, spin=3.0)


def elliptic() -> Base:
    a, b, normal = 0.04, 0.03, 0.6
    rim = make.ellipse_curve(a, b, position=[0.0, 0.0, -HEIGHT])
    t = atan2(b * sin(normal), a * cos(normal))
    rims = {
        "support": (rim, "support", ()),
        "curve": (rim, "curve_implicit", (t,)),
        "chart and curve": (rim, "curve_block", (a * cos(t), b * sin(t), t)),
    }
    return Base(ellipse(a, b), rims, normal)


def uneven() -> Base:
    """A closed curve of the user's own, by its support function."""
    H, slope = "(0.04 + 0.002*cos(2*t) + 0.001*cos(3*t))", "(-0.004*sin(2*t) - 0.003*sin(3*t))"
    x, y = f"{H}*cos(t) - {slope}*sin(t)", f"{H}*sin(t) + {slope}*cos(t)"
    place = {"periodic": True, "position": [0.0, 0.0, -HEIGHT]}
    rim = make.curve(x, y, "0", domain=(0.0, 2 * pi), **place)
    return Base(harmonics(0.04, 0.002, 0.001), {"curve": (rim, "auto", (0.6,))}, 0.6)


BASES = {"ellipse": elliptic(), "own curve": uneven()}
HEAVY = {("own curve", "curve-curve"), ("ellipse", "support")}
KINDS = [
    pytest.param(base, rim, marks=[pytest.mark.slow] if (base, rim) in HEAVY else [])
    for base, of in BASES.items()
    for rim in of.rims
]


def imbalance_of(glass: Glass, order: int, tau: mpf) -> list[mpf]:
    """What Euler's equations leave of the series cut at an order."""

    def at(coefficients: tuple[float, ...]) -> tuple[mpf]:
        return (Series.of(coefficients, len(coefficients)).at(tau),)

    with mp.workdps(DIGITS):
        series = glass.series(order)
        once = [x.derivative() for x in series]
        numbers = [
            [Series((x.at(tau),)) for x in each] for each in (series, once, [x.derivative() for x in once])
        ]
        now = replace(glass, force=tuple(map(at, glass.force)), torque=tuple(map(at, glass.torque)))
        return [abs(x.c[0]) for x in now.imbalance(0.0, *numbers)]


def test_the_lean_begins_with_the_cube_of_the_time() -> None:
    """theta = h0 F'/(6 (I + m R^2)) tau^3, towards the load, whose direction the azimuth follows."""
    theta, phi, _ = TURNING.series(6)
    cube = ABOVE * RAMP / (6 * (ROUND[0] + MASS * RADIUS**2))
    assert [float(x) for x in theta.c[:4]] == pytest.approx([0.0, 0.0, 0.0, cube], abs=1e-12)
    assert [float(x) for x in phi.c[:2]] == pytest.approx([0.0, 20.0 / (RAMP * START)], abs=1e-12)


@pytest.mark.parametrize("glass", [TWISTED, BASES["own curve"].glass()], ids=["circle", "own curve"])
@pytest.mark.parametrize("order", [6, 8])
def test_the_series_solves_the_equations_to_its_order(glass: Glass, order: int) -> None:
    """Cut after tau^n, it leaves O(tau^(n - 1))."""
    coarse, fine = (imbalance_of(glass, order, mpf(tau)) for tau in ("1e-4", "5e-5"))
    for a, b in zip(coarse, fine, strict=True):
        assert a < mpf("1e-17") or mp.log(a / b, 2) > order - 1.5


@pytest.mark.slow
@pytest.mark.parametrize("glass", FEW_GLASSES)
def test_the_reference_keeps_its_energy_and_does_not_care_where_its_series_ends(glass: Glass) -> None:
    one, other = reference(glass), reference(glass, 1.5 * SERIES_UNTIL)
    assert max(one.imbalance, other.imbalance) < 1e-13
    assert abs(one.p - other.p).max() < 1e-13
    assert abs(one.rotation - other.rotation).max() < 1e-11


@pytest.mark.cases(1)
@pytest.mark.parametrize("glass", FEW_GLASSES)
def test_the_glass_rolls_as_the_reference_does(glass: Glass) -> None:
    run = rolled(scene_of_glass(glass, CIRCLE), (1.0, 0.0, 0.0), TAU, Accuracy.tight())
    position, rotation = errors(run, reference(glass))
    assert position < 1e-12
    assert rotation < 1e-11
    assert run.session.run.report.energy_error_max < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize(("base", "rim"), KINDS, ids=lambda x: str(x))
def test_any_smooth_base_rolls_as_the_reference_does(base: str, rim: str) -> None:
    """In every form of the contact: without eta, with a curve parameter, with a chart of the plane too."""
    of = BASES[base]
    shape, form, eta = of.rims[rim]
    glass = BASE_GLASSES[base]
    run = rolled(scene_of_glass(glass, shape, form), of.outward, TAU, Accuracy.tight(), eta)
    position, rotation = errors(run, reference(glass))
    assert position < 1e-13
    assert rotation < 1e-12
    assert run.session.run.report.energy_error_max < 1e-13


BASE_GLASSES = {name: base.glass() for name, base in BASES.items()}


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-7, 1e-9, 1e-11])
def test_the_error_of_the_whole_start_follows_the_tolerance(tolerance: float) -> None:
    glass, of = BASE_GLASSES["ellipse"], BASES["ellipse"]
    shape, form, eta = of.rims["curve"]
    run = rolled(scene_of_glass(glass, shape, form), of.outward, TAU, Accuracy.of(tolerance), eta)
    position, rotation = errors(run, reference(glass))
    assert position < 1e-2 * tolerance
    assert rotation < tolerance
