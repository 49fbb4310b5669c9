"""Friction between faces: against integration by other ways, and what holds of every limit surface."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad
from scipy.special import ellipe, ellipk

from modelgen.runtime.area_friction import AreaFriction, area_friction
from modelgen.runtime.region_overlap import Arc, overlap
from tests.core.conftest import CoreBuild
from tests.core.planar import (
    FRAME,
    LETTER,
    Array,
    annulus,
    disc,
    ellipse,
    facing,
    polygon,
    rectangle,
    stadium,
)
from tests.core.rays import friction_along_rays, resultant_along_rays

HOLED = [
    np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]),
    np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]]),
]
CORNERS = {
    "rectangle": [np.array([[-0.6, -0.3], [0.6, -0.3], [0.6, 0.3], [-0.6, 0.3]])],
    "letter": [np.array(LETTER, dtype=float)],
    "frame": HOLED,
    "triangle": [np.array([[0.0, 0.0], [1.0, 0.1], [0.3, 0.9]])],
}
ARCS = {
    "rectangle": rectangle(0.6, 0.3),
    "letter": polygon(LETTER),
    "frame": FRAME,
    "triangle": polygon(CORNERS["triangle"][0]),
}
ROUND = {
    "disc": disc(0.7),
    "ring": annulus(1.0, 0.4),
    "ellipse": ellipse(1.0, 0.5),
    "stadium": stadium(0.5, 0.4),
}
EPS = float(np.finfo(float).eps)
unit, share = st.floats(-1, 1), st.floats(0.02, 0.98)


def centre_in(core: CoreBuild, arcs: list[Arc], x: float, y: float) -> Array:
    """A point inside the hull, from two numbers in -1..1."""
    hull = overlap(core, [], arcs).hull
    middle = hull.mean(axis=0)
    at = middle + 0.98 * np.array([x, y]) * np.abs(hull - middle).max(axis=0)
    assume(overlap(core, [], arcs, points=at[None]).margin[0] > 1e-3)
    return at


def rubbed(
    core: CoreBuild, arcs: list[Arc], at: Array, twist: Array, wrench: Array | None = None
) -> AreaFriction:
    given_wrench = None if wrench is None else wrench[None]
    return area_friction(core, [], arcs, np.array([[2.0, *at]]), np.array([twist]), wrench=given_wrench)


@settings(max_examples=25, deadline=None)
@example("letter", 0.0, 0.859375, 0.0, 0.0, 0.0, 0.5)
@given(
    st.sampled_from(sorted(CORNERS)),
    unit,
    unit,
    unit,
    unit,
    st.sampled_from([0.0, 0.3, 1.0, 4.0, 30.0, 300.0]),
    share,
)
def test_friction_is_that_along_rays(
    plane_core: CoreBuild, name: str, x: float, y: float, cx: float, cy: float, far: float, w: float
) -> None:
    at = centre_in(plane_core, ARCS[name], x, y)
    twist = np.array([w * far * cy, -w * far * cx, w])
    found = rubbed(plane_core, ARCS[name], at, twist)
    wanted, off = friction_along_rays(CORNERS[name], found.pressure[0], at, twist)
    slope = float(np.hypot(*found.pressure[0][1:]))  # steep where little is pressed, of sums that cancel
    allowed = 10 * off + 1e-11 * (1 + far) ** 2 + EPS / 16 * slope
    assert found.friction[0] == pytest.approx(wanted, abs=allowed)


@pytest.mark.cases(2)
@pytest.mark.parametrize("where", ["inside", "on the edge", "at a corner", "far away"])
def test_friction_is_that_of_direct_quadrature(plane_core: CoreBuild, where: str) -> None:
    turning = {
        "inside": (0.2, 0.1),
        "on the edge": (0.6, 0.1),
        "at a corner": (0.6, 0.3),
        "far away": (7.0, 3.0),
    }[where]
    at = np.array([0.1, 0.05])
    twist = np.array([0.8 * (turning[1] - at[1]), -0.8 * (turning[0] - at[0]), 0.8])
    found = rubbed(plane_core, ARCS["rectangle"], at, twist)
    a, b, c = found.pressure[0]

    def density(y: float, x: float, row: int) -> float:
        d, p = (x - at[0], y - at[1]), max(0.0, a + b * (x - at[0]) + c * (y - at[1]))
        v = twist[0] - twist[2] * d[1], twist[1] + twist[2] * d[0]
        u = np.array(v) / max(np.hypot(*v), 1e-300)
        return float(-p * (u[0], u[1], d[0] * u[1] - d[1] * u[0])[row])

    parts = (
        [(-0.6, min(turning[0], 0.6)), (min(turning[0], 0.6), 0.6)],
        [(-0.3, min(turning[1], 0.3)), (min(turning[1], 0.3), 0.3)],
    )
    for row in range(3):
        total = sum(
            dblquad(density, *xs, *ys, args=(row,), epsabs=1e-9, epsrel=1e-9)[0]
            for xs in parts[0] for ys in parts[1] if xs[0] < xs[1] and ys[0] < ys[1]
        )  # fmt: skip
        assert found.friction[0, row] == pytest.approx(total, abs=1e-7)


@pytest.mark.parametrize("ratio", [1e-6, 0.1, 0.653, 0.999, 1.0001, 1.7, 2.9, 3.1, 50.0, 1e7])
def test_a_uniform_disc_rubs_as_its_elliptic_integrals(plane_core: CoreBuild, ratio: float) -> None:
    """Farkas and others, Phys. Rev. Lett. 90 (2003), 248302; ratio: slip at the centre over the spin's."""
    e, m = ratio, min(ratio, 1 / ratio) ** 2
    E, K = ellipe(m), ellipk(m)
    if e <= 1:
        force = 4 / (3 * pi * e) * ((e * e + 1) * E + (e * e - 1) * K)
        torque = 4 / (9 * pi) * ((4 - 2 * e * e) * E + (e * e - 1) * K)
    else:
        force = 4 / (3 * pi) * ((e * e + 1) * E - (e * e - 1) * K)
        torque = 4 / (9 * pi) * e * ((4 - 2 * e * e) * E + (2 * e * e - 5 + 3 / (e * e)) * K)
    found = rubbed(plane_core, disc(0.7), np.zeros(2), np.array([0.0, ratio * 0.7, 1.0])).friction[0]
    noise = 1e-15 * (1 / e if e < 1 else e**4)  # of the closed forms
    assert found == pytest.approx([0.0, -2 * force, -2 * 0.7 * torque], abs=1e-14 + noise)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(sorted(ARCS | ROUND)), unit, unit, st.tuples(unit, unit, unit))
def test_friction_is_the_gradient_of_what_it_wears(
    plane_core: CoreBuild, name: str, x: float, y: float, twist: tuple[float, float, float]
) -> None:
    arcs = (ARCS | ROUND)[name]
    assume(np.linalg.norm(twist) > 0.1)
    at = centre_in(plane_core, arcs, x, y)

    def gradient(step: float) -> Array:
        steps = np.array([np.array(twist) + s * step * e for e in np.eye(3) for s in (1, -1)])
        found = area_friction(plane_core, [], arcs, np.tile([2.0, *at], (6, 1)), steps).friction
        power = np.einsum("ij,ij->i", found, steps)
        return (power[::2] - power[1::2]) / (2 * step)

    friction = area_friction(plane_core, [], arcs, np.array([[2.0, *at]]), np.array([twist])).friction[0]
    fine, coarse = gradient(5e-6), gradient(1e-5)
    assert np.all(np.abs(fine - friction) <= 1e-6 + 2 * np.abs(coarse - fine))


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(sorted(ARCS | ROUND)), unit, unit, st.tuples(unit, unit, unit))
def test_friction_lies_on_its_limit_surface(
    plane_core: CoreBuild, name: str, x: float, y: float, twist: tuple[float, float, float]
) -> None:
    arcs = (ARCS | ROUND)[name]
    assume(np.linalg.norm(twist) > 0.1)
    at = centre_in(plane_core, arcs, x, y)
    force = rubbed(plane_core, arcs, at, np.array(twist)).friction[0]
    assert rubbed(plane_core, arcs, at, np.array(twist), -0.3 * force).needed[0] == pytest.approx(
        0.3, abs=1e-9
    )


@pytest.mark.parametrize("name", sorted(ARCS | ROUND))
def test_a_wrench_needs_the_most_that_any_twist_asks_for(plane_core: CoreBuild, name: str) -> None:
    """Maximum dissipation: what holds a wrench is the largest wrench.twist over the power of that twist."""
    rng, arcs = np.random.default_rng(len(name)), (ARCS | ROUND)[name]
    at = overlap(plane_core, [], arcs).hull.mean(axis=0) + np.array([0.05, -0.03])
    load = np.array([[2.0, *at]])

    def asked(twists: Array, wrench: Array) -> Array:
        friction = area_friction(plane_core, [], arcs, np.repeat(load, len(twists), axis=0), twists).friction
        return -(twists @ wrench) / np.einsum("ij,ij->i", friction, twists)

    for _ in range(3):
        wrench = rng.normal(size=3)
        held = rubbed(plane_core, arcs, at, np.array([1.0, 0, 0]), wrench)
        needed = held.needed[0]
        assert np.abs(asked(held.limiting, wrench)) == pytest.approx(needed, rel=1e-8)
        twists = rng.normal(size=(200, 3))
        ratios = asked(twists, wrench)
        for spread in 10.0 ** -np.arange(0.5, 5.5, 0.25):
            best = twists[np.argmax(ratios)] / np.linalg.norm(twists[np.argmax(ratios)])
            twists = np.vstack([best, best + spread * rng.normal(size=(30, 3))])
            ratios = asked(twists, wrench)
        assert ratios.max() <= needed * (1 + 1e-9)
        assert ratios.max() == pytest.approx(needed, rel=1e-7)


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(sorted(CORNERS)), unit, unit)
def test_pressure_has_its_resultant_and_centre_and_does_not_pull(
    plane_core: CoreBuild, name: str, x: float, y: float
) -> None:
    at = centre_in(plane_core, ARCS[name], x, y)
    found = rubbed(plane_core, ARCS[name], at, np.array([0.6, 0.8, 0.0]))
    resultant, off = resultant_along_rays(CORNERS[name], found.pressure[0], at)
    assert resultant == pytest.approx([2.0, 0.0, 0.0], abs=10 * off + 1e-11)
    assert found.friction[0] == pytest.approx([-1.2, -1.6, 0.0], abs=1e-12)


def test_friction_does_not_depend_on_whose_face_is_cut(plane_core: CoreBuild) -> None:
    a, b = rectangle(0.6, 0.5), disc(0.5)
    load, twist = np.array([[2.0, 0.25, 0.05]]), np.array([[0.3, -0.2, 1.5]])
    one = area_friction(plane_core, a, b, load, twist, pose=facing(0.4, 0.1, 0.3)).friction[0]
    turn = np.array([[1, 0], [0, -1.0]])
    at = turn @ (load[0, 1:] - [0.4, 0.1])
    v = turn @ twist[0, :2]
    other = area_friction(
        plane_core, b, a, np.array([[2.0, *at]]), np.array([[*v, -1.5]]), pose=facing(-0.4, 0.1)
    ).friction[0]
    assert [*(turn @ other[:2]), -other[2]] == pytest.approx(list(one), abs=1e-13)


def test_a_centre_outside_the_hull_has_no_pressure(plane_core: CoreBuild) -> None:
    assert np.isnan(rubbed(plane_core, disc(0.5), np.array([0.6, 0.0]), np.array([1.0, 0, 0])).friction).all()


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(sorted(ARCS | ROUND)), unit, unit, st.tuples(unit, unit), st.tuples(unit, unit, unit))
def test_a_turn_tells_how_much_holds_easily(
    plane_core: CoreBuild,
    name: str,
    x: float,
    y: float,
    off: tuple[float, float],
    wrench: tuple[float, float, float],
) -> None:
    """Half the mean distance of the pressure is left of it while its centre moves by an eighth of that."""
    arcs = (ARCS | ROUND)[name]
    at = centre_in(plane_core, arcs, x, y)
    spread = -rubbed(plane_core, arcs, at, np.array([0.0, 0.0, 1.0])).friction[0, 2] / 2
    near = at + spread / 8 * np.array(off) / max(1.0, float(np.hypot(*off)))
    assume(overlap(plane_core, [], arcs, points=near[None]).margin[0] > 1e-3)
    needed = rubbed(plane_core, arcs, near, np.array([1.0, 0, 0]), np.array(wrench)).needed[0]
    assert needed <= (np.hypot(*wrench[:2]) + 4 * abs(wrench[2]) / spread) / 2 * (1 + 1e-9)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([0.02, 0.1, 0.3, 1.0]),
    st.tuples(st.floats(-0.2, 0.2), st.floats(-0.05, 0.05), st.floats(-pi, pi)),
    st.tuples(unit, unit),
    st.tuples(unit, unit, unit),
)
def test_a_region_in_parts_side_by_side_rubs_as_the_whole(
    plane_core: CoreBuild,
    width: float,
    place: tuple[float, float, float],
    centre: tuple[float, float],
    twist: tuple[float, float, float],
) -> None:
    """Of a plate with a narrower one beside it; where they adjoin, neither has a border."""
    w = width
    left, right = [[-2, -1], [0, -1], [0, 1], [-2, 1]], [[0, -w], [2, -w], [2, w], [0, w]]
    parts = polygon(left) + polygon(right, loop=2)
    whole = polygon([[-2, -1], [0, -1], [0, -w], [2, -w], [2, w], [0, w], [0, 1], [-2, 1]])
    face, pose = polygon([[-0.1, -0.1], [0.15, -0.05], [0.0, 0.12]]), facing(*place)
    hull = overlap(plane_core, whole, face, pose).hull
    assume(len(hull) > 2)
    middle = hull.mean(axis=0)
    at = middle + 0.9 * np.array(centre) * np.abs(hull - middle).max(axis=0)
    assume(overlap(plane_core, whole, face, pose, at[None]).margin[0] > 1e-3)
    load, moved = np.array([[1.0, *at]]), np.array([twist])
    one, other = (area_friction(plane_core, arcs, face, load, moved, pose=pose) for arcs in (whole, parts))
    assert other.pressure == pytest.approx(one.pressure, rel=1e-7, abs=1e-7 * np.abs(one.pressure).max())
    assert other.friction == pytest.approx(one.friction, abs=1e-9)
