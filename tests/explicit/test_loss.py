"""How contacts with centres and straight edges lose digits, by decades of what vanishes, against 50 digits.

Arithmetic at the same (q, eta): eps/mu at focal distances, where a centre meets a curve or stands on its axis
of curvature, and between touching edges that are nearly parallel.
Total, from the same pose to the extremal pair: eps/mu^2.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels
from modelgen.model import ContactKind, ShapeKind, Side
from tests.curves.test_loss import EPS, SEEDS, Case, decades, frame, margin, posed, slope, turn
from tests.laws.precise import evaluate
from tests.laws.shapes import SPECIMENS
from tests.laws.test_loss import local, relative_error, settled

CAVITY = SPECIMENS["ellipsoid_cavity"]
NAMES = {
    "point": ("x", "y", "z"), "sphere": ("radius",), "circle": ("radius",), "line": (), "edge": ("length",)
}  # fmt: skip
AT = np.array([0.3, -0.4, 0.5])
RADIUS = 0.5


def kind(o: ShapeKind | str, f: str, form: str) -> ContactKind:
    one, two = (ShapeKind(each, each, NAMES[each]) if isinstance(each, str) else each for each in (o, f))
    return ContactKind("loss", form, Side(one, "free"), Side(two, "free"))


def focal(fraction: float, seed: int, f: str, form: str) -> Case:
    """A centre in an ellipsoidal cavity at the fraction of a focal distance before its focus."""
    random = np.random.default_rng(seed)
    x_o, n, curvatures, _ = local(CAVITY, random.uniform(0.3, 1.0, 2), CAVITY.parameters)
    h, R_f = (fraction - 1) / curvatures[0], turn(random)
    radius = RADIUS if f == "sphere" else 0.0
    x_f = -radius * R_f.T @ n + (0 if radius else AT)
    eta = [*x_o, *(x_f if form == "implicit" else [])]
    lengths = [*CAVITY.parameters, *([radius] if radius else AT)]
    return posed(
        kind(CAVITY.kind, f, form), (x_o, x_f), (np.eye(3), R_f), (h - radius) * n, eta, lengths, random
    )


def beside(h: float, aim: float, seed: int, o: str) -> Case:
    """A centre at the distance h from a circle, the angle `aim` off the direction to the circle's centre."""
    random = np.random.default_rng(seed)
    t, r = random.uniform(-3, 3), 0.7
    x, z = r * np.array([np.cos(t), np.sin(t), 0]), np.array([0, 0, 1.0])
    towards = -np.cos(aim) * x / r + np.sin(aim) * z
    R = turn(random)
    if o == "point":
        contact, numbers = kind("circle", "point", "centre_curve"), [r, *AT]
        return posed(contact, (x, AT), (np.eye(3), R), h * towards, [t], numbers, random)
    x_o = -RADIUS * R.T @ towards
    return posed(
        kind("sphere", "circle", "centre_curve"), (x_o, x), (R, np.eye(3)), (RADIUS - h) * towards, [t],
        [RADIUS, r], random,
    )  # fmt: skip


def meeting(size: float, seed: int, o: str) -> Case:
    """A centre near a circle."""
    return beside(size, 0.8, seed, o)


def concentric(fraction: float, seed: int, o: str) -> Case:
    """A circle whose radius is longer by a fraction than that of the concentric one."""
    return beside(0.7 * (1 - fraction), 0.0, seed, o)


def crossed(sine: float, seed: int, d: float) -> Case:
    """A line and an edge at an angle, nearest off their middles."""
    random = np.random.default_rng(seed)
    z, angle = np.array([0, 0, 1.0]), np.arcsin(sine)
    R_o = frame(z, np.array([1.0, 0, 0]))  # its third column, the line, along x
    R_f = frame(np.array([np.cos(angle), np.sin(angle), 0]), z)
    t_o, t_f = random.uniform(0.3, 0.8, 2)
    x_o, x_f = np.array([0, 0, t_o]), np.array([t_f, 0, 0])
    return posed(kind("line", "edge", "edge_edge"), (x_o, x_f), (R_o, R_f), d * z, [1.0], [2.0], random)


DECADES = 10.0 ** np.arange(-1, -8.5, -1)
FOCAL = [("point", "centre_surface"), ("sphere", "centre_surface"), ("sphere", "implicit")]
LOSSES = [
    *(pytest.param(partial(focal, f=f, form=form), id=f"focal-{f}-{form}") for f, form in FOCAL),
    *(pytest.param(partial(meeting, o=o), id=f"meeting-{o}") for o in ("point", "sphere")),
    *(pytest.param(partial(concentric, o=o), id=f"concentric-{o}") for o in ("point", "sphere")),
    pytest.param(partial(crossed, d=0.0), id="parallel"),
]


@pytest.mark.cases(4)
@pytest.mark.parametrize("make", LOSSES)
def test_arithmetic_loses_eps_over_mu(make: Callable[[float, int], Case]) -> None:
    """Down to mu = 1e-8, with the (q, eta) that the kernel is given; median of the poses of a decade."""
    margins, errors = decades(make, DECADES)
    assert margins.min() < 2e-8
    assert 0.75 < slope(DECADES, margins) < 1.25
    assert (errors * margins < 10 * EPS).all()
    assert -1.25 < slope(margins, errors) < -0.75


def test_nothing_of_the_rates_is_lost_between_parallel_edges_at_a_gap() -> None:
    """N, N_dot and gamma; the nearest points, and with them the levers in J, lose eps/mu."""
    margins, errors = decades(partial(crossed, d=0.4), DECADES)
    assert margins.min() < 2e-8
    assert errors.max() < 1e-14
    rows = []
    with mp.workdps(50):
        for sine in DECADES:
            contact, inputs = crossed(float(sine), 1, 0.4)
            rates = contact_kernels(contact).rates
            found, wanted = rates(*inputs), evaluate(rates, *inputs)
            rows.append(float(mp.norm(mp.matrix(np.array(found[2])[:, 0]) - mp.matrix(wanted[2]))))
    assert (np.array(rows) * margins < 10 * EPS).all()
    assert -1.25 < slope(margins, np.array(rows)) < -0.75


@pytest.mark.cases(1)
@pytest.mark.parametrize("f", ["point", "sphere"])
def test_total_error_is_eps_over_mu_squared(f: str) -> None:
    """Near a focus, down to mu = 1e-5, both sides from the same pose in double precision."""
    margins, errors = [], []
    with mp.workdps(50):
        for fraction in 10.0 ** np.arange(-1, -5.1, -0.5):
            cases = [focal(float(fraction), seed, f, "centre_surface") for seed in SEEDS]
            pairs = [(each, settled(each, at, False), settled(each, at, True)) for each, at in cases]
            margins.append(float(np.median([margin((each, exact))[0] for each, _, exact in pairs])))
            errors.append(float(np.median([relative_error(*pair) for pair in pairs])))
    assert min(margins) < 1e-5
    assert all(lost * mu**2 < EPS for mu, lost in zip(margins, errors, strict=True))
    assert -2.3 < slope(np.array(margins), np.array(errors)) < -1.7
