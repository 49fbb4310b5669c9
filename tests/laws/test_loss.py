"""Near conforming contact digits are lost by two laws, seen over decades of the margin mu.

Arithmetic at given (q, eta): eps/mu. Total, from a pose in double precision to its true extremal pair:
eps/mu^2, because rounding the pose moves the contact point by eps/mu and with it mu itself.

The family: a body in an ellipsoidal cavity, at points without symmetry, one pair of principal directions
aligned, scaled until these two curvatures differ by a fraction.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import ContactKind, contact_kernels, eta_layout
from tests.laws.configurations import Array, pose_of
from tests.laws.families import kind_of
from tests.laws.precise import evaluate
from tests.laws.shapes import SPECIMENS, Specimen

EPS = np.finfo(float).eps
FORMS = ("implicit", "mixed", "block", "paper", "differentiated")
CAVITY, BODY = "ellipsoid_cavity", "ellipsoid"
SEEDS = range(3)


def local(specimen: Specimen, uv: Array, parameters: tuple[float, ...]) -> tuple[Array, Array, Array, Array]:
    """Point, exterior normal, principal curvatures (ascending) and their directions as columns (3,2)."""
    alpha = ca.SX.sym("uv", 2)
    x = ca.vertcat(*specimen.chart(ca, alpha[0], alpha[1], parameters))
    E = ca.jacobian(x, alpha)
    n = specimen.sign * ca.cross(E[:, 0], E[:, 1])
    n = n / ca.norm_2(n)
    values = ca.Function("local", [alpha], [x, n, E, ca.jacobian(n, alpha)])(uv)
    point, normal, tangents, bend = (np.array(value) for value in values)
    axes, _ = np.linalg.qr(tangents)
    K = axes.T @ bend @ np.linalg.inv(axes.T @ tangents)
    curvatures, directions = np.linalg.eigh((K + K.T) / 2)
    return point[:, 0], normal[:, 0], curvatures, axes @ directions


@cache
def near_conforming(fraction: float, seed: int, form: str) -> tuple[ContactKind, list[Array]]:
    """Inputs of `rates` on a touching pair whose weaker relative curvature is about `fraction`."""
    random = np.random.default_rng(seed)
    uv_o, uv_f = random.uniform(0.3, 1.0, 2), random.uniform(0.3, 1.0, 2)
    o, f = SPECIMENS[CAVITY], SPECIMENS[BODY]
    x_o, n_o, k_o, t_o = local(o, uv_o, o.parameters)
    scale = local(f, uv_f, f.parameters)[2][0] / (-k_o[0] * (1 + fraction))
    lengths = tuple(scale * length for length in f.parameters)
    x_f, n_f, _, t_f = local(f, uv_f, lengths)
    frame_o = np.column_stack([t_o[:, 0], np.cross(n_o, t_o[:, 0]), n_o])
    frame_f = np.column_stack([t_f[:, 0], np.cross(-n_f, t_f[:, 0]), -n_f])
    R_o, _ = np.linalg.qr(random.normal(size=(3, 3)))
    R_o *= np.linalg.det(R_o)
    R_f = R_o @ frame_o @ frame_f.T
    p_o = random.normal(size=3)
    p_f = p_o + R_o @ x_o - R_f @ x_f
    kind = kind_of(CAVITY, BODY, form)
    carried = {"point": (x_o, x_f), "chart": (uv_o, uv_f)}
    layout = eta_layout(kind)
    eta = np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])
    poses = [pose_of(p[:, None], R[None])[:, 0] for p, R in ((p_o, R_o), (p_f, R_f))]
    twists = random.normal(size=(2, 6))
    return kind, [poses[0], twists[0], poses[1], twists[1], eta, np.array([*o.parameters, *lengths])]


def settled(kind: ContactKind, inputs: list[Array], precise: bool) -> list[Array]:
    """The inputs with eta on the extremal pair, in double or in the working precision of mpmath."""
    place = contact_kernels(kind).place
    eta = list(inputs[4])
    for _ in range(8):
        at = (inputs[0], inputs[2], eta, inputs[5])
        eta = evaluate(place, *at)[0] if precise else np.array(place(*at)[0])[:, 0]
    return [*inputs[:4], eta, inputs[5]]


def relative_error(kind: ContactKind, double: list[Array], exact: list[Array]) -> float:
    """Of (gamma, eta_dot), the double evaluation against 50 digits."""
    rates = contact_kernels(kind).rates
    found, wanted = rates(*double), evaluate(rates, *exact)
    got = np.concatenate([np.array(found[i])[:, 0] for i in (3, 4)])
    true = mp.matrix([*wanted[3], *wanted[4]])
    return float(mp.norm(mp.matrix(got) - true) / mp.norm(true))


def margin(kind: ContactKind, inputs: list[Array]) -> float:
    return float(evaluate(contact_kernels(kind).place, inputs[0], inputs[2], inputs[4], inputs[5])[3][0])


def slope(margins: list[float], errors: list[float]) -> float:
    return float(np.polyfit(np.log(margins), np.log(errors), 1)[0])


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS)
def test_arithmetic_loses_eps_over_mu(form: str) -> None:
    """Down to mu = 1e-8, with the (q, eta) that the kernel is given; median of the poses of a decade."""
    margins, errors = [], []
    with mp.workdps(50):
        for fraction in 10.0 ** np.arange(-1, -8.5, -1):
            cases = [near_conforming(float(fraction), seed, form) for seed in SEEDS]
            margins.append(float(np.median([margin(*case) for case in cases])))
            errors.append(float(np.median([relative_error(kind, at, at) for kind, at in cases])))
    assert min(margins) < 1e-8
    assert all(error * mu < 5 * EPS for mu, error in zip(margins, errors, strict=True))
    assert -1.25 < slope(margins, errors) < -0.75


@pytest.mark.cases(1)
@pytest.mark.parametrize("form", FORMS)
def test_total_error_is_eps_over_mu_squared(form: str) -> None:
    """Down to mu = 1e-5, both sides from the same pose in double precision."""
    margins, errors = [], []
    with mp.workdps(50):
        for fraction in 10.0 ** np.arange(-1, -5.1, -0.5):
            cases = [near_conforming(float(fraction), seed, form) for seed in SEEDS]
            pairs = [(kind, settled(kind, at, False), settled(kind, at, True)) for kind, at in cases]
            margins.append(float(np.median([margin(kind, exact) for kind, _, exact in pairs])))
            errors.append(float(np.median([relative_error(*pair) for pair in pairs])))
    assert min(margins) < 1e-5
    assert all(error * mu**2 < EPS for mu, error in zip(margins, errors, strict=True))
    assert -2.3 < slope(margins, errors) < -1.7
