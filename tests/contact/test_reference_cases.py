"""Published numbers: Montana's sphere rolling on a plane, and a pair of ellipsoids with 20 digits."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.contact.contact_symbols import partner
from modelgen.contact.form_builders import build_angle
from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from modelgen.contact.surface_points import montana_frame
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Chart

# A sphere with the chart of the worked example: x = c_u/|c_u|, y = c_v/|c_v|, z outward.
RHO, U, PSI, W = 0.3, 0.4, 0.7, (1.1, -0.6, 0.0)
X, Y, Z = (
    parse_expression(text, ("u", "v", "rho"))
    for text in ("rho*cos(u)*cos(v)", "-rho*cos(u)*sin(v)", "rho*sin(u)")
)
GLOBE = ShapeKind("globe", "chart", ("rho",), chart=Chart((X, Y, Z), ((-1.5, 1.5), (-3.0, 3.0))))
PLANE = ShapeKind("plane", "plane", ())
ROLLING = {"u_f": 0.6, "v_f": 1.1942748712215627, "u_o": -0.07492024307723012, "v_o": -0.36835710550666556}
PSI_DOT = -0.465072540611978


def rolling_arguments() -> list[Any]:
    """A plane at rest and the sphere rolling on it with spin W in its contact frame, psi = PSI."""
    v = 0.2
    x = np.array([-np.sin(U) * np.cos(v), np.sin(U) * np.sin(v), np.cos(U)])
    y = np.array([-np.sin(v), -np.cos(v), 0.0])
    body = np.column_stack([x, y, np.cross(x, y)])
    x_f = np.array([np.cos(PSI), -np.sin(PSI), 0.0])
    z_f = np.array([0.0, 0.0, -1.0])
    world = np.column_stack([x_f, np.cross(z_f, x_f), z_f])
    R = world @ body.T
    lever = RHO * z_f
    w = world @ np.array(W)
    pose_f = [*(-lever), *R.ravel(order="F")]
    twist_f = [*(-np.cross(w, lever)), *(R.T @ w)]
    rest = [0.0] * 3 + list(np.eye(3).ravel())
    return [rest, [0.0] * 6, pose_f, twist_f, [0.0, 0.0, U, v], [RHO]]


def rolling_kind(form: str) -> ContactKind:
    return ContactKind("rolling", form, Side(PLANE, "free"), Side(GLOBE, "free"))


def test_metric_curvature_and_torsion_of_a_sphere() -> None:
    side = partner(Side(GLOBE, "free"), "f")
    uv = ca.SX.sym("uv", 2)
    frame = montana_frame(side, uv)
    forms = ca.Function(
        "forms", [uv, side.argument], [ca.densify(entry) for entry in (frame.M, frame.K, frame.T)]
    )
    M, K, T = (np.array(value) for value in forms([U, 0.2], [RHO]))
    np.testing.assert_allclose(M, np.diag([RHO, RHO * np.cos(U)]), atol=1e-12)
    np.testing.assert_allclose(K, np.eye(2) / RHO, atol=1e-12)
    np.testing.assert_allclose(T, [[0.0, -np.tan(U) / RHO]], atol=1e-12)


@pytest.mark.parametrize("form", ["paper", "block", "differentiated"])
def test_sphere_rolling_on_a_plane(form: str) -> None:
    eta_dot = np.array(contact_kernels(rolling_kind(form)).rates(*rolling_arguments())[4])[:, 0]
    expected = [ROLLING[name] for name in ("u_o", "v_o", "u_f", "v_f")]
    np.testing.assert_allclose(eta_dot, expected, atol=1e-12)


def test_contact_angle_of_the_rolling_sphere() -> None:
    psi, psi_dot = build_angle(rolling_kind("paper"))(*rolling_arguments())
    assert float(psi) == pytest.approx(PSI, abs=1e-12)
    assert float(psi_dot) == pytest.approx(PSI_DOT, abs=1e-12)


# Two ellipsoids apart, constant velocities; numbers from a 50-digit Newton with five-point differences.
ELLIPSOID = ShapeKind("ellipsoid", "ellipsoid", ("a", "b", "c"))
AXES = ((1.0, 0.8, 0.6), (0.7, 0.5, 0.9))
CENTRES = np.array([[0.0, 0.0, 0.0], [1.4, 0.9, 1.1]])
TURNS = np.array([[0.1, -0.2, 0.3], [-0.4, 0.25, 0.6]])
VELOCITIES = np.array([[0.1, 0.0, -0.2], [-0.3, 0.2, -0.1]])
SPINS = np.array([[0.3, -0.5, 0.2], [-0.7, 0.4, 1.1]])  # world
GAP, GAP_DOT, GAMMA = 0.23580623649593690, -0.19570438022585227462, 0.92000889160458799512
NORMAL = [0.70801612115641493862, 0.38789896391031558797, 0.59012504266462751749]
NORMAL_DOT = [0.05978883504364360461, -0.1813228572219483686, 0.047453484175395639985]
POINTS = (
    [0.82414069797569394836, 0.37615538250247805083, 0.35797554724741725048],
    [0.99109531488403944398, 0.46762437732284282165, 0.49713071262016726117],
)
ALPHA = [0.17177811415449299735, 0.25688615228537387024, -3.507011693822041382, -1.0317391971606579483]
ALPHA_DOT = [
    -0.31013110195611425007,
    -0.35317686822843032605,
    -1.9288835166714046775,
    -0.20105701328629489125,
]
ANGLE, ANGLE_DOT = -2.57123932763, 1.54073669467


def ellipsoid_arguments(layout: tuple[str, str]) -> list[Any]:
    rotations = [Rotation.from_rotvec(turn).as_matrix() for turn in TURNS]
    poses = [[*p, *R.ravel(order="F")] for p, R in zip(CENTRES, rotations, strict=True)]
    twists = [[*v, *(R.T @ w)] for v, w, R in zip(VELOCITIES, SPINS, rotations, strict=True)]
    eta: list[float] = []
    for each, uv, P, p, R in zip(layout, (ALPHA[:2], ALPHA[2:]), POINTS, CENTRES, rotations, strict=True):
        eta += uv if each == "chart" else list(R.T @ (np.array(P) - p))
    return [poses[0], twists[0], poses[1], twists[1], eta, [*AXES[0], *AXES[1]]]


@pytest.mark.parametrize("form", [form.name for form in FORMS.values() if form.applies(ELLIPSOID, ELLIPSOID)])
def test_two_ellipsoids_to_ten_digits(form: str) -> None:
    kind = ContactKind("pair", form, Side(ELLIPSOID, "free"), Side(ELLIPSOID, "free"))
    at = ellipsoid_arguments(eta_layout(kind))
    kernels = contact_kernels(kind)
    d, J_o, J_f, gamma, eta_dot, normal = (np.array(value)[:, 0] for value in kernels.rates(*at))
    assert d[0] == pytest.approx(GAP, abs=1e-12)
    np.testing.assert_allclose(normal, NORMAL, atol=1e-12)
    assert J_o @ at[1] + J_f @ at[3] == pytest.approx(GAP_DOT, abs=1e-10)
    assert gamma[0] == pytest.approx(GAMMA, rel=1e-10)
    np.testing.assert_allclose(np.array(kernels.normal_rate(*at))[:, 0], NORMAL_DOT, atol=1e-10)
    if eta_layout(kind) == ("chart", "chart"):
        np.testing.assert_allclose(eta_dot, ALPHA_DOT, rtol=1e-10)
    found = kernels.place(at[0], at[2], at[4], at[5])
    for value, expected in zip(found[5:7], POINTS, strict=True):
        np.testing.assert_allclose(np.array(value)[:, 0], expected, atol=1e-12)


def test_contact_angle_of_two_ellipsoids() -> None:
    kind = ContactKind("pair", "paper", Side(ELLIPSOID, "free"), Side(ELLIPSOID, "free"))
    psi, psi_dot = build_angle(kind)(*ellipsoid_arguments(("chart", "chart")))
    assert float(psi) == pytest.approx(ANGLE, abs=1e-11)
    assert float(psi_dot) == pytest.approx(ANGLE_DOT, abs=1e-10)
