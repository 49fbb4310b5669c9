"""Published numbers of a circle over a paraboloid and of an ellipse past a helix; angles; Corollary 4.5."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from modelgen.model import ContactKind, ShapeKind, Side
from tests.curves.configurations import columns, eta_of, lengths, random_pairs
from tests.curves.specimens import kind_of


@dataclass(frozen=True)
class Case:
    """A pair in constant motion, by a 50-digit Newton with five-point differences; world axes."""

    o: ShapeKind
    f: ShapeKind
    lengths: list[float]
    centres: tuple[list[float], list[float]]
    turns: tuple[list[float], list[float]]  # rotation vectors
    velocities: tuple[list[float], list[float]]
    spins: tuple[list[float], list[float]]
    d: float
    d_dot: float
    gamma: float
    N: list[float]
    N_dot: list[float]
    point_o: list[float]
    alpha: list[float]
    alpha_dot: list[float]
    psi: tuple[float, float]

    def arguments(self, layout: tuple[str, str]) -> list[list[float]]:
        sides = []
        for p, turn, v, w in zip(self.centres, self.turns, self.velocities, self.spins, strict=True):
            R = Rotation.from_rotvec(turn).as_matrix()
            sides += [[*p, *R.ravel(order="F")], [*v, *(R.T @ w)]]
        R_o = Rotation.from_rotvec(self.turns[0]).as_matrix()
        local = R_o.T @ (np.array(self.point_o) - self.centres[0])
        first = list(local) if layout[0] == "point" else self.alpha[:-1]
        signs = [1.0, float(np.sign(self.d))] if layout[1] == "signed_curve" else []
        return [*sides, [*first, self.alpha[-1], *signs], self.lengths]


def shape(kind: str, *names: str) -> ShapeKind:
    return ShapeKind(kind, kind, names)


ON_BOWL = Case(
    shape("paraboloid", "rho_x", "rho_y"), shape("circle", "radius"), [2.0, 5.0, 0.5],
    ([0, 0, 0], [0.2, -0.1, 0.9]), ([0.05, 0.1, 0], [0.9, 0.3, 0.2]),
    ([0, 0, 0.1], [0.3, -0.2, -0.6]), ([0.2, 0.1, -0.3], [1.0, -2.0, 0.5]),
    0.50277934778035125649, -0.62344037285696439123, -0.56739026699663175006,
    [-0.10599002112757549897, 0.019157359105808230198, 0.99418263463684941083],
    [0.082481319883476047077, -0.1414480898396063279, 0.011518978797241842946],
    [0.42176169326122870655, -0.35195192563952270076, -0.0034609493940036252937],
    [0.41912149125968525282, -0.3506318246387509739, -1.2528244950779486469],
    [0.048266408001980350613, -0.1321569620757281519, -2.6794377967260196871],
    (-0.497103596818, 0.750265870434),
)  # fmt: skip
PAST_HELIX = Case(
    shape("ellipse_curve", "a", "b"), shape("helix", "radius", "pitch"), [1.0, 0.6, 0.3, 0.15],
    ([0, 0, 0], [1.1, 0.35, 0.15]), ([0.2, 0, 0.1], [1.3, 0.3, -0.2]),
    ([0, 0.1, 0.2], [-0.2, 0.1, -0.4]), ([0.4, -0.3, 0.2], [-0.5, 0.8, 0.3]),
    -0.20540618492762935206, 0.15895488664924205406, -0.17996077433885945205,
    [-0.34160475473675943185, 0.46104948917730655166, -0.81898691080540665952],
    [-0.031946161434052706989, 0.55368280383149952418, 0.32502123172207712064],
    [0.87116586568267541655, -0.23071139119377521802, -0.055540325792438396462],
    [-0.56722408394423043997, 4.1779914106272796418],
    [-0.27010916082362980022, -0.41777144479669977069],
    (-1.63101007308, -0.747867132157),
)  # fmt: skip
FAMILY = [
    pytest.param(case, form.name, id=f"{case.f.kind}-{form.name}")
    for case in (ON_BOWL, PAST_HELIX)
    for form in FORMS.values()
    if form.applies(case.o, case.f)
]  # fmt: skip


def contact(case: Case, form: str) -> ContactKind:
    return ContactKind("case", form, Side(case.o, "free"), Side(case.f, "free"))


@pytest.mark.parametrize(("case", "form"), FAMILY)
def test_published_pairs_to_ten_digits(case: Case, form: str) -> None:
    kind = contact(case, form)
    at = case.arguments(eta_layout(kind))
    kernels = contact_kernels(kind)
    d, J_o, J_f, gamma, eta_dot, N = (np.array(value)[:, 0] for value in kernels.rates(*at))
    assert d[0] == pytest.approx(case.d, abs=1e-12)
    assert J_o @ at[1] + J_f @ at[3] == pytest.approx(case.d_dot, abs=1e-10)
    assert gamma[0] == pytest.approx(case.gamma, rel=1e-10)
    np.testing.assert_allclose(N, case.N, atol=1e-12)
    np.testing.assert_allclose(np.array(kernels.normal_rate(*at))[:, 0], case.N_dot, atol=1e-10)
    n = len(case.alpha)
    if eta_layout(kind)[0] != "point":
        np.testing.assert_allclose(eta_dot[:n], case.alpha_dot, rtol=1e-10)
    assert eta_dot[3 if eta_layout(kind)[0] == "point" else n - 1] == pytest.approx(
        case.alpha_dot[-1], rel=1e-10
    )


@pytest.mark.parametrize(("case", "form"), [(ON_BOWL, "curve_paper"), (PAST_HELIX, "curves_paper")])
def test_published_angles(case: Case, form: str) -> None:
    kind = contact(case, form)
    angle = FORMS[form].angle
    assert angle is not None
    psi, psi_dot, *_ = angle(kind)(*case.arguments(eta_layout(kind)))
    assert float(psi) == pytest.approx(case.psi[0], abs=1e-11)
    assert float(psi_dot) == pytest.approx(case.psi[1], abs=1e-10)


@pytest.mark.parametrize(
    ("o", "f", "form"),
    [
        ("ellipsoid", "helix", "curve_paper"), ("patch", "wave", "curve_paper"),
        ("helix", "helix", "curves_paper"), ("circle", "wave", "curves_paper"),
    ],
)  # fmt: skip
def test_the_rates_of_psi_and_phi_are_their_derivatives(o: str, f: str, form: str) -> None:
    kind = kind_of(o, f, form)
    build_angle = FORMS[form].angle
    assert build_angle is not None
    angle, rates = build_angle(kind), contact_kernels(kind).rates
    symbols = [ca.SX.sym("a", angle.size1_in(i)) for i in range(6)]
    pose_o, twist_o, pose_f, twist_f, eta, _ = symbols
    values = angle(*symbols)
    eta_dot = rates(*symbols)[4]
    errors = []
    for value, stated in zip(values[::2], values[1::2], strict=True):
        rate = ca.jtimes(value, eta, eta_dot)
        for pose, twist in ((pose_o, twist_o), (pose_f, twist_f)):
            R_dot = ca.reshape(pose[3:], 3, 3) @ ca.skew(twist[3:])
            rate += ca.jtimes(value, pose, ca.vertcat(twist[:3], ca.vec(R_dot)))
        errors.append((rate - stated) / (1 + ca.fabs(stated)))
    at = random_pairs(o, f, 60, seed=4)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(kind, at), lengths(o, f, 60)
    fine = np.abs(columns(contact_kernels(kind).place, inputs[0], inputs[2], *inputs[4:])[3][0]) > 0.05
    found = columns(ca.Function("errors", symbols, errors), *inputs)
    assert np.abs(np.stack(found))[:, 0, fine].max() < 1e-9


def test_touching_curves_move_by_the_corrected_corollary() -> None:
    """(4.19) to (4.25) at d = 0; the signs in print of (4.20), (4.22), (4.23) and (4.25) disagree."""
    o, f, n = "ellipse_curve", "helix", 90
    kind = kind_of(o, f, "curves_paper")
    at = random_pairs(o, f, n, seed=9)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(kind, at), lengths(o, f, n)
    steps = contact_kernels(kind).steps
    made = dict(zip(steps.name_out(), columns(steps, *inputs), strict=True))
    angle = FORMS["curves_paper"].angle
    assert angle is not None
    phi_o_dot, phi_f_dot = (columns(angle(kind), *inputs)[k][0] for k in (3, 5))
    (v_x, v_y), (w_x, w_y, _) = made["V"], made["w"]
    R = made["R_psi"].reshape(2, n, 2).transpose(1, 0, 2)
    cos, sin = R[:, 0, 0], -R[:, 0, 1]
    cot = cos / sin
    a, b, r, h = 0.9, 0.5, 0.5, 0.15
    speeds = np.hypot(a * np.sin(at.alpha[0]), b * np.cos(at.alpha[0])), np.hypot(r, h)
    l_o, l_f = made["eta_dot"][0] * speeds[0], made["eta_dot"][1] * speeds[1]
    touching = (at.d == 0) & (np.abs(sin) > 0.1)
    assert touching.sum() > 20

    def close(found: np.ndarray, wanted: np.ndarray) -> bool:
        return bool((np.abs(found - wanted)[touching] < 1e-9 * (1 + np.abs(wanted[touching]))).all())

    assert close(l_o, -v_y / sin)
    assert close(l_f, -v_x - cot * v_y)
    assert not close(l_f, -v_x + cot * v_y)
    tau_f = h / (r * r + h * h)
    turn_f = np.stack([made["K_f"][0] * l_f, -tau_f * l_f])
    turn_o = np.stack([made["K_o"][0] * l_o, 0 * l_o])  # an ellipse has no torsion
    turned = np.einsum("nij,jn->in", R, turn_o)
    xi = np.stack([w_y, -w_x]) + turn_f + turned
    assert close(phi_o_dot, -xi[0] / sin)
    assert close(phi_f_dot, xi[1] - cot * xi[0])
    assert not close(phi_f_dot, -xi[1] + cot * xi[0])
    printed = xi - 2 * turned
    assert not close(phi_o_dot, -printed[0] / sin)
    d_dot = np.sum(made["J_o"] * at.twist_o + made["J_f"] * at.twist_f, axis=0)
    N, between = made["normal"], made["velocity_f"] - made["velocity_o"]
    v_z = -np.sum(N * between, axis=0)
    assert close(d_dot, -v_z)
