"""Points, balls and spherical cavities against surfaces and curves obey the laws of all contacts."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import ContactKind, ShapeKind, Side
from tests.curves.configurations import eta_of as curve_eta_of
from tests.curves.configurations import lengths as curve_lengths
from tests.curves.configurations import random_pairs as pairs_of_curves
from tests.curves.specimens import STRAIGHT
from tests.curves.specimens import kind_of as curve_kind_of
from tests.explicit.configurations import Pairs, Truth, carried, lengths, random_pairs, truth
from tests.explicit.specimens import CASES, CENTRES, PAIRS, kind_of
from tests.laws.configurations import Array, columns, pose_of, rotation_of, rotation_taking, turned

TOLERANCE = 1e-9
MU = 1e-2
COUNT = 60
CARRIED = [case for case in CASES if case[2].startswith("centre")]
SWAPPED = [  # a sphere may stand on either side, where the other shape is no sphere
    (o, f, form) for o, f, form in CARRIED if CENTRES[f].radius != 0 and not o.startswith("sphere")
]


@cache
def case(o: str, f: str) -> tuple[Pairs, Truth]:
    at = random_pairs(o, f, COUNT, seed=len(o) * 31 + len(f))
    return at, truth(o, f, at)


def eta_of(o: str, f: str, form: str, at: Pairs) -> Array:
    return carried(eta_layout(kind_of(o, f, form)), at.alpha, at.x_o)


@cache
def placed(o: str, f: str, form: str) -> tuple[Array, ...]:
    at, _ = case(o, f)
    place = contact_kernels(kind_of(o, f, form)).place
    return columns(place, at.pose_o, at.pose_f, eta_of(o, f, form, at), lengths(o, f, COUNT))


def regular(o: str, f: str, form: str) -> Array:
    return np.abs(placed(o, f, form)[3][0]) > MU


def error(found: Array, expected: Array) -> Array:
    scale = np.maximum(1.0, np.linalg.norm(expected, axis=0))
    return np.linalg.norm(found - expected, axis=0) / scale


@pytest.mark.cases(25)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_rates_are_those_of_the_implicit_solution(o: str, f: str, form: str) -> None:
    at, expected = case(o, f)
    kind = kind_of(o, f, form)
    kernels = contact_kernels(kind)
    eta = eta_of(o, f, form, at)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths(o, f, COUNT)
    d, J_o, J_f, gamma, eta_dot, normal = columns(kernels.rates, *inputs)
    (normal_rate,) = columns(kernels.normal_rate, *inputs)
    d_dot = np.sum(J_o * at.twist_o + J_f * at.twist_f, axis=0)
    d_ddot = np.sum(J_o * at.accel_o + J_f * at.accel_f, axis=0) + gamma[0]
    fine = regular(o, f, form)
    assert fine.sum() > COUNT / 3
    for found, wanted in (
        (d, expected.d[None]), (normal, expected.normal), (d_dot[None], expected.d_dot[None]),
        (d_ddot[None], expected.d_ddot[None]), (normal_rate, expected.normal_rate),
        (eta_dot, carried(eta_layout(kind), expected.alpha_dot, expected.x_o_dot)),
    ):  # fmt: skip
        assert error(found, wanted)[fine].max() < TOLERANCE


def test_there_are_a_thousand_configurations_with_and_without_radius() -> None:
    chosen = {(o, f): form for o, f, form in CASES}
    for with_radius in (False, True):
        pairs = [pair for pair in PAIRS if (CENTRES[pair[1]].radius != 0) is with_radius]
        assert sum(int(regular(*pair, chosen[pair]).sum()) for pair in pairs) >= 1000
        assert {o for o, _ in pairs} >= set(STRAIGHT)
    signs = np.sign([case(*pair)[0].d for pair in PAIRS])
    assert {-1, 0, 1} == set(signs.ravel())


@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_place_reports_the_construction(o: str, f: str, form: str) -> None:
    at, expected = case(o, f)
    eta_next, d, residual, margin, normal, point_o, point_f = placed(o, f, form)
    np.testing.assert_allclose(eta_next, eta_of(o, f, form, at), atol=1e-12)
    np.testing.assert_allclose(d[0], at.d, atol=1e-13)
    assert residual.max() < 1e-13
    assert np.abs(margin[0]).max() <= 1 + 1e-12
    np.testing.assert_allclose(normal, expected.normal, atol=1e-12)
    on_surface = at.pose_o[:3] + turned(rotation_of(at.pose_o), at.x_o)
    np.testing.assert_allclose(point_o, on_surface, atol=1e-13)
    np.testing.assert_allclose(point_f, on_surface + at.d * normal, atol=1e-12)


@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_moving_the_world_changes_nothing(o: str, f: str, form: str) -> None:
    at, _ = case(o, f)
    random = np.random.default_rng(6)
    axes = [axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, COUNT))]
    G, g = rotation_taking(*axes, random.uniform(-3, 3, COUNT)), random.normal(size=(3, COUNT))

    def moved(pose: Array) -> Array:
        return pose_of(g + turned(G, pose[:3]), G @ rotation_of(pose))

    def turned_row(row: Array) -> Array:
        return np.concatenate([turned(G, row[:3]), row[3:]])

    rates, rest = contact_kernels(kind_of(o, f, form)).rates, (eta_of(o, f, form, at), lengths(o, f, COUNT))
    here = columns(rates, at.pose_o, at.twist_o, at.pose_f, at.twist_f, *rest)
    poses, twists = (moved(at.pose_o), moved(at.pose_f)), (turned_row(at.twist_o), turned_row(at.twist_f))
    there = columns(rates, poses[0], twists[0], poses[1], twists[1], *rest)
    expected = (here[0], turned_row(here[1]), turned_row(here[2]), here[3], here[4], turned(G, here[5]))
    fine = regular(o, f, form)
    for found, wanted in zip(there, expected, strict=True):
        assert error(found, wanted)[fine].max(initial=0.0) < TOLERANCE


@pytest.mark.parametrize(("o", "f", "form"), SWAPPED)
def test_swapping_the_bodies_changes_signs_only(o: str, f: str, form: str) -> None:
    at, _ = case(o, f)
    eta = eta_of(o, f, form, at)
    straight = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths(o, f, COUNT)
    back = at.pose_f, at.twist_f, at.pose_o, at.twist_o, eta, lengths(o, f, COUNT, swapped=True)
    d, J_o, J_f, gamma, eta_dot, N = columns(contact_kernels(kind_of(o, f, form)).rates, *straight)
    found = columns(contact_kernels(kind_of(o, f, form, swapped=True)).rates, *back)
    for value, wanted in zip(found, (d, J_f, J_o, gamma, eta_dot, -N), strict=True):
        assert error(value, wanted)[regular(o, f, form)].max() < TOLERANCE
    place = contact_kernels(kind_of(o, f, form, swapped=True)).place
    there, here = columns(place, back[0], back[2], *back[4:]), placed(o, f, form)
    for index, wanted in ((0, here[0]), (1, here[1]), (4, -here[4]), (5, here[6]), (6, here[5])):
        assert error(there[index], wanted).max() < TOLERANCE


@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_extremality_stays_zero_along_eta_dot(o: str, f: str, form: str) -> None:
    """The Newton correction vanishes on extremal pairs only; its derivative along the motion is zero."""
    at, _ = case(o, f)
    kernels = contact_kernels(kind_of(o, f, form))
    pose_o, pose_f, eta, numbers = (ca.SX.sym("a", kernels.place.size1_in(i)) for i in range(4))
    twists = [ca.SX.sym("twist", 6) for _ in range(2)]
    eta_dot = kernels.rates(pose_o, twists[0], pose_f, twists[1], eta, numbers)[4]
    correction = kernels.place(pose_o, pose_f, eta, numbers)[0] - eta
    rate = ca.jtimes(correction, eta, eta_dot)
    for pose, twist in zip((pose_o, pose_f), twists, strict=True):
        R_dot = ca.reshape(pose[3:], 3, 3) @ ca.skew(twist[3:])
        rate += ca.jtimes(correction, pose, ca.vertcat(twist[:3], ca.vec(R_dot)))
    drift = ca.Function("drift", [pose_o, twists[0], pose_f, twists[1], eta, numbers], [rate, eta_dot])
    motion = at.pose_o, at.twist_o, at.pose_f, at.twist_f
    found, speed = columns(drift, *motion, eta_of(o, f, form, at), lengths(o, f, COUNT))
    size = 1 + np.linalg.norm(speed, axis=0)
    assert (np.linalg.norm(found, axis=0) / size)[regular(o, f, form)].max() < TOLERANCE


@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_newton_converges_quadratically(o: str, f: str, form: str) -> None:
    """From an error e the step leaves at most C e^2, one C for all sizes."""
    at, _ = case(o, f)
    eta, fine = eta_of(o, f, form, at), np.abs(placed(o, f, form)[3][0]) > 0.1
    away = np.random.default_rng(23).normal(size=eta.shape)
    place, worst = contact_kernels(kind_of(o, f, form)).place, []
    for size in (1e-3, 1e-4):
        stepped = columns(place, at.pose_o, at.pose_f, eta + size * away, lengths(o, f, COUNT))[0]
        worst.append(float(np.linalg.norm(stepped - eta, axis=0)[fine].max(initial=0.0)) / size**2)
    assert max(worst) < 3000
    assert worst[1] < 3 * worst[0] + 1e-6


@pytest.mark.parametrize(
    ("o", "form"), [("plane", "explicit"), ("torus", "centre_surface"), ("helix", "centre_curve")]
)
def test_the_coordinates_of_a_point_are_a_placement_of_its_body(o: str, form: str) -> None:
    at, _ = case(o, "vertex")
    plain = kind_of(o, "vertex", form)
    vertex = CENTRES["vertex"]
    shape = ShapeKind("tip", "point", ("x", "y", "z"))
    other = ContactKind("placed", form, plain.o, Side(shape, "free", placement="general"))
    numbers = lengths(o, "vertex", COUNT)
    place = np.tile(np.array([0, 0, 0, *vertex.at, *np.eye(3).ravel()])[:, None], COUNT)
    eta = eta_of(o, "vertex", form, at)
    motion = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta
    here = columns(contact_kernels(plain).rates, *motion, numbers)
    there = columns(contact_kernels(other).rates, *motion, np.concatenate([numbers[:-3], place]))
    for found, wanted in zip(there, here, strict=True):
        assert error(found, wanted).max() < TOLERANCE


@pytest.mark.parametrize(
    ("o", "f"), [("sphere", "circle"), ("sphere", "helix"), ("sphere_cavity", "ellipse_curve")]
)
def test_the_margin_by_a_curve_is_that_of_the_curve_on_the_surface_of_the_sphere(o: str, f: str) -> None:
    at = pairs_of_curves(o, f, COUNT, seed=17)
    margins = []
    for form in ("centre_curve", "curve_implicit"):
        kind = curve_kind_of(o, f, form)
        inputs = at.pose_o, at.pose_f, curve_eta_of(kind, at), curve_lengths(o, f, COUNT)
        margins.append(columns(contact_kernels(kind).place, *inputs)[3])
    np.testing.assert_allclose(margins[0], margins[1], rtol=1e-9, atol=1e-12)
    assert {-1.0, 1.0} == set(np.sign(margins[0][0]))
