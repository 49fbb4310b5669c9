"""Curves obey the laws of surfaces: implicit differentiation, invariance, swapping, extremality, Newton."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout, order
from tests.curves.configurations import Pairs, Truth, curve, eta_dot_of, eta_of, lengths, random_pairs, truth
from tests.curves.specimens import ALL, BENDS, CASES, EDGES, ON_CURVES, ON_SURFACES, PAIRS, STRAIGHT, kind_of
from tests.laws.configurations import Array, columns, pose_of, rotation_of, rotation_taking, turned

TOLERANCE = 1e-9
MU = 1e-2
COUNT = 140
CARRIED = [case for case in CASES if case[2] not in ("support", "edge_edge")]  # eta has parameters


@cache
def case(o: str, f: str) -> tuple[Pairs, Truth]:
    at = random_pairs(o, f, COUNT, seed=len(o) * 31 + len(f))
    return at, truth(o, f, at)


def oracle_form(o: str, f: str) -> str:
    return "curves_differentiated" if (o, f) in ON_CURVES else "curve_differentiated"


@cache
def regular(o: str, f: str) -> Array:
    at, _ = case(o, f)
    kind = kind_of(o, f, oracle_form(o, f))
    inputs = at.pose_o, at.pose_f, eta_of(kind, at), lengths(o, f, COUNT)
    return np.abs(columns(contact_kernels(kind).place, *inputs)[3][0]) > MU


def reached(form: str, at: Pairs, expected: Truth, f: str) -> Array:
    """Which contact points the form can have: a support map has the convex side of its curve."""
    if form != "support":
        return np.ones(at.n, dtype=bool)
    bent = -columns(curve(BENDS[f]), at.alpha[-1:])[0]  # c'' of an ellipse
    return np.sum(turned(rotation_of(at.pose_f), bent) * expected.normal, axis=0) > 0


def error(found: Array, expected: Array) -> Array:
    scale = np.maximum(1.0, np.linalg.norm(expected, axis=0))
    return np.linalg.norm(found - expected, axis=0) / scale


def worst_errors(o: str, f: str, form: str, at: Pairs, expected: Truth, fine: Array) -> dict[str, float]:
    """Largest errors of d, N, d_dot, d_ddot, N_dot and eta_dot over the configurations that are fine."""
    kind = kind_of(o, f, form)
    kernels = contact_kernels(kind)
    inputs = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(kind, at), lengths(o, f, at.n))
    d, J_o, J_f, gamma, eta_dot, normal = columns(kernels.rates, *inputs)
    (normal_rate,) = columns(kernels.normal_rate, *inputs)
    d_dot = np.sum(J_o * at.twist_o + J_f * at.twist_f, axis=0)
    d_ddot = np.sum(J_o * at.accel_o + J_f * at.accel_f, axis=0) + gamma[0]
    pairs = {
        "d": (d, expected.d[None]), "N": (normal, expected.normal),
        "d_dot": (d_dot[None], expected.d_dot[None]), "d_ddot": (d_ddot[None], expected.d_ddot[None]),
        "N_dot": (normal_rate, expected.normal_rate),
        "eta_dot": (eta_dot, eta_dot_of(kind, expected)),
    }  # fmt: skip
    return {name: float(error(*pair)[fine].max()) for name, pair in pairs.items()}


@pytest.mark.cases(20)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_rates_are_those_of_the_implicit_solution(o: str, f: str, form: str) -> None:
    at, expected = case(o, f)
    fine = regular(o, f) & reached(form, at, expected, f)
    assert fine.sum() > COUNT / 4
    assert max(worst_errors(o, f, form, at, expected, fine).values()) < TOLERANCE


def test_there_are_a_thousand_configurations_of_each_kind() -> None:
    for pairs in (ON_SURFACES, ON_CURVES):
        assert sum(int(regular(*pair).sum()) for pair in pairs) >= 1000
        assert any(f in STRAIGHT for _, f in pairs)
    assert sum(int(regular(*pair).sum()) for pair in EDGES) >= 700


@pytest.mark.parametrize(("o", "f"), [("circle", "circle"), ("helix", "ellipse_curve"), ("line", "helix")])
@pytest.mark.parametrize("form", ["curves_block", "curves_differentiated"])
def test_parallel_tangents_at_a_gap_are_regular(o: str, f: str, form: str) -> None:
    at = random_pairs(o, f, COUNT, seed=3, parallel=True)
    expected = truth(o, f, at, parallel=True)
    kind = kind_of(o, f, form)
    inputs = at.pose_o, at.pose_f, eta_of(kind, at), lengths(o, f, COUNT)
    fine = np.abs(columns(contact_kernels(kind).place, *inputs)[3][0]) > MU
    assert fine.sum() > COUNT / 4
    assert max(worst_errors(o, f, form, at, expected, fine).values()) < TOLERANCE


@pytest.mark.cases(20)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_moving_the_world_changes_nothing(o: str, f: str, form: str) -> None:
    at, _ = case(o, f)
    kind, n = kind_of(o, f, form), at.n
    random = np.random.default_rng(6)
    axes = [axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, n))]
    G, g = rotation_taking(*axes, random.uniform(-3, 3, n)), random.normal(size=(3, n))
    eta, numbers = eta_of(kind, at), lengths(o, f, n)

    def placed(pose: Array) -> Array:
        return pose_of(g + turned(G, pose[:3]), G @ rotation_of(pose))

    def carried(row: Array) -> Array:
        return np.concatenate([turned(G, row[:3]), row[3:]])

    rates = contact_kernels(kind).rates
    here = columns(rates, at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, numbers)
    there = columns(
        rates, placed(at.pose_o), carried(at.twist_o), placed(at.pose_f), carried(at.twist_f), eta, numbers
    )
    fine = regular(o, f)
    expected = (here[0], carried(here[1]), carried(here[2]), here[3], here[4], turned(G, here[5]))
    for found, wanted in zip(there, expected, strict=True):
        assert error(found, wanted)[fine].max(initial=0.0) < TOLERANCE


@pytest.mark.parametrize(("o", "f"), ON_CURVES)
def test_swapping_two_curves_changes_signs_only(o: str, f: str) -> None:
    at, _ = case(o, f)
    kind, other = kind_of(o, f, "curves_block"), kind_of(f, o, "curves_block")
    eta = eta_of(kind, at)
    back = np.stack([eta[1], eta[0], eta[2], eta[3]])  # -N against E_f x E_o has the same sign; so has d
    straight = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths(o, f, COUNT))
    turned_round = (at.pose_f, at.twist_f, at.pose_o, at.twist_o, back, lengths(f, o, COUNT))
    d, J_o, J_f, gamma, _, N = columns(contact_kernels(kind).rates, *straight)
    found = columns(contact_kernels(other).rates, *turned_round)
    fine = regular(o, f)
    for index, wanted in ((0, d), (1, J_f), (2, J_o), (3, gamma), (5, -N)):
        assert error(found[index], wanted)[fine].max() < TOLERANCE


@pytest.mark.cases(20)
@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_extremality_stays_zero_along_eta_dot(o: str, f: str, form: str) -> None:
    """The Newton correction vanishes on extremal pairs only; its derivative along the motion is zero."""
    at, _ = case(o, f)
    kernels = contact_kernels(kind_of(o, f, form))
    place = kernels.place
    pose_o, pose_f, eta, numbers = (ca.SX.sym("a", place.size1_in(i)) for i in range(4))
    twists = [ca.SX.sym("twist", 6) for _ in range(2)]
    n = eta.shape[0] - (2 if eta_layout(kind_of(o, f, form))[1] == "signed_curve" else 0)
    eta_dot = kernels.rates(pose_o, twists[0], pose_f, twists[1], eta, numbers)[4]
    correction = place(pose_o, pose_f, eta, numbers)[0][:n] - eta[:n]
    rate = ca.jtimes(correction, eta, eta_dot)
    for pose, twist in zip((pose_o, pose_f), twists, strict=True):
        R_dot = ca.reshape(pose[3:], 3, 3) @ ca.skew(twist[3:])
        rate += ca.jtimes(correction, pose, ca.vertcat(twist[:3], ca.vec(R_dot)))
    drift = ca.Function("drift", [pose_o, twists[0], pose_f, twists[1], eta, numbers], [rate, eta_dot])
    values = eta_of(kind_of(o, f, form), at)
    found, speed = columns(drift, at.pose_o, at.twist_o, at.pose_f, at.twist_f, values, lengths(o, f, COUNT))
    size = 1 + np.linalg.norm(speed, axis=0)
    assert (np.linalg.norm(found, axis=0) / size)[regular(o, f)].max() < TOLERANCE


@pytest.mark.cases(40)
@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_newton_converges_quadratically(o: str, f: str, form: str) -> None:
    """From an error e the step leaves at most C e^2, one C for all sizes."""
    at, _ = case(o, f)
    kind = kind_of(o, f, form)
    place, eta, numbers = contact_kernels(kind).place, eta_of(kind, at), lengths(o, f, COUNT)
    fine = np.abs(columns(place, at.pose_o, at.pose_f, eta, numbers)[3][0]) > 0.1
    away = np.random.default_rng(23).normal(size=eta.shape)
    if eta_layout(kind)[1] == "signed_curve":
        away[2:] = 0
    worst = []
    for size in (1e-3, 1e-4):
        stepped = columns(place, at.pose_o, at.pose_f, eta + size * away, numbers)[0]
        left = np.linalg.norm((stepped - eta)[: 2 if (o, f) in ON_CURVES else None], axis=0)
        worst.append(float(left[fine].max()) / size**2)
    assert max(worst) < 3000
    assert worst[1] < 3 * worst[0] + 1e-6


@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_place_reports_the_construction(o: str, f: str, form: str) -> None:
    at, expected = case(o, f)
    kind = kind_of(o, f, form)
    inputs = at.pose_o, at.pose_f, eta_of(kind, at), lengths(o, f, COUNT)
    fine = regular(o, f) & reached(form, at, expected, f)
    _, d, residual, margin, normal, point_o, point_f = (
        entry[:, fine] for entry in columns(contact_kernels(kind).place, *inputs)
    )
    np.testing.assert_allclose(d[0], at.d[fine], atol=1e-13)
    assert np.abs(residual).max() < 1e-13
    assert np.abs(margin[0]).max() <= 1 + 1e-12
    np.testing.assert_allclose(point_f - point_o, normal * d, atol=1e-12)


def test_every_pair_is_in_canonical_order() -> None:
    assert not [pair for pair in PAIRS if order(*(ALL[name].kind for name in pair))]
