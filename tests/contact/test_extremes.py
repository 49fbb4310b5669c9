"""Where charts have poles, tangent frames jump or curvature vanishes: right answers, or a margin of 0."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import ContactKind, ShapeKind, Side

SQUARE = ("a", "b", "c", "p", "q")
NAMES: dict[str, tuple[str, ...]] = {
    "plane": (), "sphere": ("radius",), "ellipsoid": ("a", "b", "c"), "torus": ("major", "minor"),
    "superellipsoid": SQUARE,
}  # fmt: skip
EYE = [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0]
TWISTS = np.random.default_rng(1).normal(size=(2, 6))


def kind(o: str, f: str, form: str) -> ContactKind:
    one, two = (Side(ShapeKind(name, name, NAMES[name]), "free") for name in (o, f))
    return ContactKind("extreme", form, one, two)


def values(function: Any, *arguments: Any) -> list[np.ndarray]:
    return [np.array(value)[:, 0] for value in function(*arguments)]


@pytest.mark.parametrize(("axis", "sign"), [*product(range(3), (1, -1))])
def test_point_forms_have_no_poles(axis: int, sign: int) -> None:
    """Two ellipsoids touching at their tips on any axis: J u, gamma by Euler's formula for the tips."""
    a, b = np.array([1.0, 0.7, 0.5]), np.array([0.6, 0.9, 0.8])
    tip = sign * np.eye(3)[axis]
    N = tip
    pose_f = [*(tip * (a[axis] + b[axis])), *EYE]
    eta = [*(a * tip), *(-b * tip)]
    contact = kind("ellipsoid", "ellipsoid", "implicit")
    kernels = contact_kernels(contact)
    d, J_o, J_f, gamma, eta_dot, normal = values(
        kernels.rates, [0.0] * 3 + EYE, TWISTS[0], pose_f, TWISTS[1], eta, [*a, *b]
    )
    across = [k for k in range(3) if k != axis]
    k_o, k_f = a[axis] / a[across] ** 2, b[axis] / b[across] ** 2
    w_o, w_f = TWISTS[0][3:], TWISTS[1][3:]
    r_o, r_f = a * tip, -b * tip
    V = TWISTS[1][:3] + np.cross(w_f, r_f) - TWISTS[0][:3] - np.cross(w_o, r_o)
    turn = np.cross(w_f - w_o, N)
    slide_f = (turn[across] - k_o * V[across]) / (k_o + k_f)
    slide_o = V[across] + slide_f
    N_dot = np.cross(w_o, N)
    N_dot[across] += k_o * slide_o
    pull = np.zeros(3)
    for w, r, slide, s in ((w_f, r_f, slide_f, 1), (w_o, r_o, slide_o, -1)):
        step = np.zeros(3)
        step[across] = slide
        pull += s * (np.cross(w, np.cross(w, r)) + np.cross(w, step))
    assert d[0] == pytest.approx(0, abs=1e-15)
    np.testing.assert_allclose(normal, N, atol=1e-15)
    assert gamma[0] == pytest.approx(N @ pull + N_dot @ V, rel=1e-12)
    np.testing.assert_allclose(eta_dot[:3][across], slide_o, atol=1e-13)
    np.testing.assert_allclose(eta_dot[3:][across], slide_f, atol=1e-13)
    assert J_o @ TWISTS[0] + J_f @ TWISTS[1] == pytest.approx(N @ V, abs=1e-13)


@pytest.mark.parametrize("tilt", [1e-3, 1e-9, 0.0, -1e-9])
def test_nothing_jumps_where_the_tangent_frame_does(tilt: float) -> None:
    """Two spheres with a level normal: the implicit form on both sides of n_z = 0 and the explicit one."""
    N = np.array([np.cos(tilt) * 0.6, np.cos(tilt) * 0.8, np.sin(tilt)])
    pose_f = [*(1.5 * N), *EYE]
    at = ([0.0] * 3 + EYE, TWISTS[0], pose_f, TWISTS[1])
    implicit = contact_kernels(kind("sphere", "sphere", "implicit")).rates(*at, [*N, *(-0.4 * N)], [1.0, 0.4])
    explicit = contact_kernels(kind("sphere", "sphere", "explicit")).rates(*at, [], [1.0, 0.4])
    for k in (0, 1, 2, 3, 5):
        np.testing.assert_allclose(np.array(implicit[k]), np.array(explicit[k]), atol=1e-14)


@pytest.mark.parametrize(
    ("shape", "lengths"), [("superellipsoid", [1.0, 0.8, 0.6, 4.0, 4.0]), ("torus", [1.0, 0.3])]
)
@pytest.mark.parametrize("form", ["support", "implicit"])
def test_flat_contact_has_margin_zero(shape: str, lengths: list[float], form: str) -> None:
    """A superellipsoid on its flat side and a ring lying down: gap and normal defined, margin 0, no NaN. The
    superellipsoid touches in one point all the same, which its support map finds."""
    height, x = {"superellipsoid": (0.6, [0.0, 0.0, -0.6]), "torus": (0.3, [1.0, 0.0, -0.3])}[shape]
    contact = kind("plane", shape, form)
    eta = x if eta_layout(contact) == ("none", "point") else []
    pose_f = [0.0, 0.0, height + 0.1, *EYE]
    kernels = contact_kernels(contact)
    _, d, residual, margin, normal, point_o, point_f = values(
        kernels.place, [0.0] * 3 + EYE, pose_f, eta, lengths
    )
    assert d[0] == pytest.approx(0.1)
    assert abs(margin[1]) < 1e-12
    assert margin[0] == pytest.approx(
        1.0 if (shape, form) == ("superellipsoid", "support") else 0.0, abs=1e-12
    )
    np.testing.assert_allclose(normal, [0, 0, 1])
    np.testing.assert_allclose(residual, 0, atol=1e-15)
    assert np.isfinite([*point_o, *point_f]).all()
    rates = values(kernels.rates, [0.0] * 3 + EYE, TWISTS[0], pose_f, TWISTS[1], eta, lengths)
    assert np.isfinite(np.concatenate([rates[0], rates[1], rates[2], rates[5]])).all()


def test_a_ball_conforming_to_its_cavity_has_margin_zero() -> None:
    one = Side(ShapeKind("bowl", "sphere", ("radius",), cavity=True), "free")
    two = Side(ShapeKind("ball", "sphere", ("radius",)), "free")
    place = contact_kernels(ContactKind("nest", "implicit", one, two)).place
    margin = values(place, [0.0] * 3 + EYE, [0.0] * 3 + EYE, [0, 0, 1.0, 0, 0, 1.0], [1.0, 1.0])[3]
    assert margin[0] < 1e-15


def test_the_margin_is_that_of_two_spheres() -> None:
    """A = (1/r + 1/R + d/(r R)) I: no cancellation for convex pairs, margin 1."""
    for d in (0.5, 0.0, -0.1):
        place = contact_kernels(kind("sphere", "sphere", "explicit")).place
        margin = values(place, [0.0] * 3 + EYE, [0.0, 0.0, 1.4 + d, *EYE], [], [1.0, 0.4])[3]
        scale = 1 + 2.5 + 2.5 * abs(d)
        np.testing.assert_allclose(margin, [(3.5 + 2.5 * d) / scale, 3.5 + 2.5 * d], rtol=1e-13)
