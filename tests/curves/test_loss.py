"""How curves lose digits, by decades of what vanishes, against 50 digits at the same (q, eta).

Arithmetic: eps/mu on surfaces, eps/sin(psi)^2 between touching curves. Nothing is lost at parallel tangents
with a gap, nor where I + d K_o is singular and S is not.
"""

from __future__ import annotations

from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels
from modelgen.model import ContactKind, ShapeKind, Side
from tests.laws.configurations import Array
from tests.laws.precise import evaluate

EPS = np.finfo(float).eps
SEEDS = range(3)
Case = tuple[ContactKind, list[Array]]


def kind(o: str, f: str, form: str, cavity: bool = False) -> ContactKind:
    names = {
        "plane": (),
        "sphere": ("radius",),
        "cylinder": ("radius",),
        "circle": ("radius",),
        "ellipse_curve": ("a", "b"),
    }
    one, two = ShapeKind(o, o, names[o], cavity), ShapeKind(f, f, names[f])
    return ContactKind("loss", form, Side(one, "free"), Side(two, "free"))


def turn(random: np.random.Generator) -> Array:
    Q, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return Q * np.linalg.det(Q)


def posed(
    contact: ContactKind,
    x: tuple[Array, Array],
    R: tuple[Array, Array],
    between: Array,
    eta: list[float],
    lengths: list[float],
    random: np.random.Generator,
) -> Case:
    """The inputs of rates with P_f - P_o = between in the axes that R turns to; the world at random."""
    G = turn(random)
    p_o = random.normal(size=3)
    p_f = p_o + G @ (R[0] @ x[0] + between - R[1] @ x[1])
    poses = [np.concatenate([p, (G @ each).ravel(order="F")]) for p, each in zip((p_o, p_f), R, strict=True)]
    twists = random.normal(size=(2, 6))
    return contact, [poses[0], twists[0], poses[1], twists[1], np.array(eta), np.array(lengths)]


def frame(x: Array, z: Array) -> Array:
    """Columns x, z x x, z."""
    return np.column_stack([x, np.cross(z, x), z])


def crossing(sine: float, d: float, seed: int) -> Case:
    """An ellipse and a circle whose tangents are `sine` from parallel, at the gap d along z."""
    random = np.random.default_rng(seed)
    t_o, t_f, a, b, r = random.uniform(0.3, 1.2), random.uniform(0.3, 1.2), 0.9, 0.5, 0.7
    x_o, e_o = (
        np.array([a * np.cos(t_o), b * np.sin(t_o), 0]),
        np.array([-a * np.sin(t_o), b * np.cos(t_o), 0]),
    )
    x_f, e_f = r * np.array([np.cos(t_f), np.sin(t_f), 0]), np.array([-np.sin(t_f), np.cos(t_f), 0])
    e_o /= np.linalg.norm(e_o)
    angle = np.arcsin(sine)
    R = []
    for e, heading, roll in ((e_o, 0.0, random.uniform(0.3, 1.0)), (e_f, angle, random.uniform(-2.5, -2.0))):
        lean = frame(np.array([np.cos(heading), np.sin(heading), 0]), np.array([0, 0, 1.0]))
        c, s = np.cos(roll), np.sin(roll)
        R.append(lean @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ frame(e, np.array([0, 0, 1.0])).T)
    eta, lengths = [t_o, t_f, 1.0, 1.0], [a, b, r]
    return posed(
        kind("ellipse_curve", "circle", "curves_block"),
        (x_o, x_f),
        (R[0], R[1]),
        np.array([0, 0, d]),
        eta,
        lengths,
        random,
    )


def rim(tilt: float, seed: int) -> Case:
    """A circle touching a plane, tilted by `tilt`; rolled about its axis at random."""
    random = np.random.default_rng(seed)
    t, r = random.uniform(-3, 3), 0.7
    x, along = r * np.array([np.cos(t), np.sin(t), 0]), np.array([-np.sin(t), np.cos(t), 0])
    lean = np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]])
    R = lean @ frame(along, np.array([0, 0, 1.0])).T
    contact = kind("plane", "circle", "curve_implicit")
    return posed(contact, (np.zeros(3), x), (np.eye(3), R), np.zeros(3), [t], [r], random)


def concentric(fraction: float, seed: int) -> Case:
    """A circle about a sphere, its radius R + d longer by `fraction` than the concentric one."""
    random = np.random.default_rng(seed)
    t, radius, d = random.uniform(-3, 3), 0.8, 0.3
    z = np.array([0, 0, 1.0])
    r = (radius + d) * (1 + fraction)
    x, along = r * np.array([np.cos(t), np.sin(t), 0]), np.array([-np.sin(t), np.cos(t), 0])
    R = frame(np.array([1.0, 0, 0]), z) @ np.column_stack([along, np.array([0, 0, -1.0]), x / r]).T
    contact = kind("sphere", "circle", "curve_implicit")
    return posed(contact, (radius * z, x), (np.eye(3), R), d * z, [*(radius * z), t], [radius, r], random)


def focal(fraction: float, seed: int) -> Case:
    """A circle near the axis of a cylindrical cavity, where 1 - d/R = fraction."""
    random = np.random.default_rng(seed)
    t, radius, r = random.uniform(-3, 3), 0.8, 0.2
    d, n = radius * (1 - fraction), np.array([-1.0, 0, 0])
    x, along = r * np.array([np.cos(t), np.sin(t), 0]), np.array([-np.sin(t), np.cos(t), 0])
    heading = np.array([0, np.cos(0.7), np.sin(0.7)])
    R = frame(heading, n) @ frame(along, x / r).T
    contact = kind("cylinder", "circle", "curve_implicit", cavity=True)
    return posed(contact, (-radius * n, x), (np.eye(3), R), d * n, [*(-radius * n), t], [radius, r], random)


def error(case: Case) -> float:
    """Of (gamma, eta_dot, N_dot), double against 50 digits at the same inputs."""
    contact, inputs = case
    kernels = contact_kernels(contact)
    found, wanted = kernels.rates(*inputs), evaluate(kernels.rates, *inputs)
    got = np.concatenate(
        [np.array(found[i])[:, 0] for i in (3, 4)] + [np.array(kernels.normal_rate(*inputs))[:, 0]]
    )
    true = mp.matrix([*wanted[3], *wanted[4], *evaluate(kernels.normal_rate, *inputs)[0]])
    return float(mp.norm(mp.matrix(got) - true) / mp.norm(true))


def margin(case: Case) -> tuple[float, float]:
    contact, inputs = case
    found = evaluate(contact_kernels(contact).place, inputs[0], inputs[2], inputs[4], inputs[5])[3]
    return abs(float(found[0])), abs(float(found[1]))


def decades(make: Callable[[float, int], Case], sizes: Array) -> tuple[Array, Array]:
    """Least margin (mu, or the second with a radius of 0.7 m) and error, medians over the seeds."""
    margins, errors = [], []
    with mp.workdps(50):
        for size in sizes:
            cases = [make(float(size), seed) for seed in SEEDS]
            margins.append(np.median([min(mu, 0.7 * flat) for mu, flat in map(margin, cases)]))
            errors.append(np.median([error(case) for case in cases]))
    return np.array(margins), np.array(errors)


def slope(sizes: Array, errors: Array) -> float:
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


@pytest.mark.parametrize("make", [rim, concentric])
def test_a_curve_on_a_surface_loses_eps_over_its_margin(make: Callable[[float, int], Case]) -> None:
    """A rim nearly flat on a plane, and a circle nearly concentric with a sphere."""
    sizes = 10.0 ** np.arange(-1, -9.5, -1)
    margins, errors = decades(make, sizes)
    assert 0.75 < slope(sizes, margins) < 1.25
    assert (errors * margins < 10 * EPS).all()


def test_touching_curves_lose_eps_over_the_squared_sine() -> None:
    sizes = 10.0 ** np.arange(-1, -6.1, -1)
    margins, errors = decades(lambda sine, seed: crossing(sine, 0.0, seed), sizes)
    assert 1.75 < slope(sizes, margins) < 2.25
    assert (errors * sizes**2 < 20 * EPS).all()
    assert -2.3 < slope(sizes, errors) < -1.5


def test_nothing_is_lost_at_parallel_tangents_with_a_gap() -> None:
    """N, N_dot and gamma by the difference of the points, at every angle."""
    margins, errors = decades(lambda sine, seed: crossing(sine, 0.4, seed), 10.0 ** np.arange(-1, -12.5, -1))
    assert margins.min() > 1e-2
    assert errors.max() < 1e-13


def test_nothing_is_lost_at_a_focal_distance_that_is_no_singularity() -> None:
    """I + d K_o becomes singular, S does not."""
    margins, errors = decades(focal, 10.0 ** np.arange(-1, -12.5, -1))
    assert margins.min() > 1e-2
    assert errors.max() < 1e-13
