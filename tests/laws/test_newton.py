"""The extremality system: its residual stays zero along eta_dot, its Newton step converges quadratically."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from tests.laws.configurations import (
    Array,
    columns,
    eta_of,
    parameters,
    pose_of,
    random_pairs,
    rotation_of,
    turned,
)  # fmt: skip
from tests.laws.families import CASES, kind_of
from tests.laws.shapes import SPECIMENS

COUNT = 20
CARRIED = [(o, f, form) for o, f, form in CASES if eta_layout(kind_of(o, f, form)) != ("none", "none")]
SURFACES = [case for case in CARRIED if set(eta_layout(kind_of(*case))) <= {"chart", "point"}]


def along_the_motion(o: str, f: str, form: str) -> ca.Function:
    """Derivative of the Newton correction, which vanishes on extremal pairs only, along (q_dot, eta_dot)."""
    kernels = contact_kernels(kind_of(o, f, form))
    place = kernels.place
    arguments = [ca.SX.sym(place.name_in(i), place.size1_in(i)) for i in range(place.n_in())]
    pose_o, pose_f, eta, numbers = arguments
    twists = [ca.SX.sym("twist", 6) for _ in range(2)]
    eta_dot = kernels.rates(pose_o, twists[0], pose_f, twists[1], eta, numbers)[4]
    correction = place(*arguments)[0] - eta
    rate = ca.jtimes(correction, eta, eta_dot)
    for pose, twist in zip((pose_o, pose_f), twists, strict=True):
        R_dot = ca.reshape(pose[3:], 3, 3) @ ca.skew(twist[3:])
        rate += ca.jtimes(correction, pose, ca.vertcat(twist[:3], ca.vec(R_dot)))
    return ca.Function("drift", [pose_o, twists[0], pose_f, twists[1], eta, numbers], [rate, eta_dot])


def margins(o: str, f: str, form: str, eta: Array, poses: tuple[Array, Array]) -> Array:
    place = contact_kernels(kind_of(o, f, form)).place
    return np.abs(columns(place, *poses, eta, parameters(o, f, COUNT))[3])


@pytest.mark.cases(25)
@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_extremality_stays_zero_along_eta_dot(o: str, f: str, form: str) -> None:
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=21)
    eta = eta_of(eta_layout(kind_of(o, f, form)), at)
    drift, eta_dot = columns(
        along_the_motion(o, f, form),
        at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, parameters(o, f, COUNT),
    )  # fmt: skip
    fine = margins(o, f, form, eta, (at.pose_o, at.pose_f))[0] > 1e-2
    scale = 1 + np.linalg.norm(eta_dot, axis=0)
    assert (np.linalg.norm(drift, axis=0) / scale)[fine].max() < 1e-9


@pytest.mark.cases(50)
@pytest.mark.parametrize(("o", "f", "form"), CARRIED)
def test_newton_converges_quadratically(o: str, f: str, form: str) -> None:
    """From an error e the step leaves at most C e^2, off the surface and along it, one C for all sizes."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=22)
    eta = eta_of(eta_layout(kind_of(o, f, form)), at)
    fine = margins(o, f, form, eta, (at.pose_o, at.pose_f))[0] > 0.1
    away = np.random.default_rng(23).normal(size=eta.shape)
    constants = []
    for size in (1e-3, 1e-4, 1e-5):
        place = contact_kernels(kind_of(o, f, form)).place
        stepped = columns(place, at.pose_o, at.pose_f, eta + size * away, parameters(o, f, COUNT))[0]
        constants.append(np.linalg.norm(stepped - eta, axis=0)[fine].max() / size**2)
    assert max(constants) < 3000
    assert constants[2] < 3 * constants[0]


@pytest.mark.cases(30)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_place_reports_the_same_contact_in_every_form(o: str, f: str, form: str) -> None:
    """d, points, normal and margin are those of the construction and of the differentiated form; residuals
    vanish."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=24)
    numbers = parameters(o, f, COUNT)
    inputs = (at.pose_o, at.pose_f, eta_of(eta_layout(kind_of(o, f, form)), at), numbers)
    oracle = contact_kernels(kind_of(o, f, "differentiated")).place
    found = columns(contact_kernels(kind_of(o, f, form)).place, *inputs)
    wanted = columns(oracle, at.pose_o, at.pose_f, at.alpha, numbers)
    reached = np.cos(at.alpha[3]) > 0 if (f, form) == ("torus", "support") else np.ones(COUNT, dtype=bool)
    np.testing.assert_allclose(found[1][0][reached], at.d[reached], atol=1e-14)
    if form == "support":  # solves nothing: its mu tells flat from curved
        found[3][0], wanted[3][0] = 1.0, 1.0
    for index in (3, 4, 5, 6):
        np.testing.assert_allclose(found[index][:, reached], wanted[index][:, reached], rtol=1e-9, atol=1e-9)
    assert np.abs(found[2]).max() < 1e-14


@pytest.mark.cases(15)
@pytest.mark.parametrize(("o", "f", "form"), SURFACES)
def test_equal_normals_are_not_extremal(o: str, f: str, form: str) -> None:
    """Half a turn of body f about a tangent at its point keeps points in line and makes normals equal."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=25)
    eta, numbers = eta_of(eta_layout(kind_of(o, f, form)), at), parameters(o, f, COUNT)
    place = contact_kernels(kind_of(o, f, form)).place
    _, _, opposite, _, normal, _, point = columns(place, at.pose_o, at.pose_f, eta, numbers)
    tangent = np.cross(normal.T, np.eye(3)[np.abs(normal).argmin(axis=0)])
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    half_turn = 2 * np.einsum("ni,nj->nij", tangent, tangent) - np.eye(3)
    R = np.einsum("nij,njk->nik", half_turn, rotation_of(at.pose_f))
    flipped = pose_of(point - turned(R, at.x_f), R)
    equal = columns(place, at.pose_o, flipped, eta, numbers)[2]
    assert np.abs(opposite[1]).max() < 1e-14
    np.testing.assert_allclose(equal[1], 2, rtol=1e-14)
