"""The other independent route, without any differentiation of formulas: 60-digit Newton and differences.

The extremal pair is solved for at three instants of an exact motion, tangents by differences of the charts,
and d, N and the contact points are differenced in time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.kinds import FORMS, contact_kernels, eta_layout
from tests.laws.configurations import Array, Configurations, columns, eta_of, parameters, random_pairs
from tests.laws.families import CASES, ROUGH, kind_of
from tests.laws.shapes import SPECIMENS, Specimen

DIGITS = 60
TANGENT_STEP = mp.mpf(10) ** -20
NEWTON_STEP = mp.mpf(10) ** -14
TIME_STEP = mp.mpf(10) ** -8
TOLERANCE = 1e-9
PAIRS = [
    ("ellipsoid", "ellipsoid", 0), ("ellipsoid", "torus", 1), ("ellipsoid", "superellipsoid", 2),
    ("ellipsoid", "patch", 3), ("torus", "torus", 4), ("torus", "superellipsoid", 5),
    ("torus", "patch", 6), ("superellipsoid", "superellipsoid", 7), ("superellipsoid", "patch", 8),
    ("patch", "patch", 9), ("plane", "ellipsoid", 10), ("ellipsoid", "torus_cavity", 11),
]  # fmt: skip
FAMILY = [(*pair, form) for pair in PAIRS for form in FORMS if (*pair[:2], form) in CASES]


def column(values: Any) -> Any:
    return mp.matrix([mp.mpf(value) for value in values])


def cross(a: Any, b: Any) -> Any:
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def inner(a: Any, b: Any) -> Any:
    return (a.T * b)[0]


def moved(pose: Array, twist: Array, accel: Array, t: Any) -> tuple[Any, Any]:
    """p + v t + a t^2/2 and R exp(hat(w t + w_dot t^2/2)) by the exponential series."""
    p, R = column(pose[:3]), mp.matrix(3, 3)
    for k in range(9):
        R[k % 3, k // 3] = mp.mpf(pose[3 + k])
    v, w = column(twist[:3]), column(twist[3:])
    h = w * t + column(accel[3:]) * t**2 / 2
    hat = mp.matrix([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
    return p + v * t + column(accel[:3]) * t**2 / 2, R * mp.expm(hat)


def frame(shape: Specimen, alpha: Any) -> tuple[Any, list[Any], Any]:
    """Point, tangents by central differences, and exterior normal, shape frame."""

    def at(u: Any, v: Any) -> Any:
        return mp.matrix(shape.chart(mp, u, v, [mp.mpf(p) for p in shape.parameters]))

    u, v, h = alpha[0], alpha[1], TANGENT_STEP
    tangents = [(at(u + h, v) - at(u - h, v)) / (2 * h), (at(u, v + h) - at(u, v - h)) / (2 * h)]
    normal = cross(*tangents) * shape.sign
    return at(u, v), tangents, normal / mp.norm(normal)


def contact(o: Specimen, f: Specimen, at: Configurations, t: Any) -> Callable[[Any], dict[str, Any]]:
    """alpha -> extremality residual, d, N and points at the instant t."""
    p_o, R_o = moved(at.pose_o[:, 0], at.twist_o[:, 0], at.accel_o[:, 0], t)
    p_f, R_f = moved(at.pose_f[:, 0], at.twist_f[:, 0], at.accel_f[:, 0], t)

    def quantities(alpha: Any) -> dict[str, Any]:
        x_o, E_o, n_o = frame(o, alpha[:2])
        x_f, E_f, _ = frame(f, alpha[2:])
        N = R_o * n_o
        between = p_f + R_f * x_f - p_o - R_o * x_o
        g = [inner(R_o * e, between) for e in E_o] + [inner(R_f * e, N) for e in E_f]
        return {"g": mp.matrix(g), "d": inner(N, between), "N": N, "x_o": x_o, "x_f": x_f}

    return quantities


def solved(quantities: Callable[[Any], dict[str, Any]], alpha: Any) -> dict[str, Any]:
    """The extremal pair near alpha, by Newton with differences."""
    for _ in range(5):
        g = quantities(alpha)["g"]
        G = mp.matrix(4, 4)
        for k in range(4):
            shifted = alpha.copy()
            shifted[k] += NEWTON_STEP
            G[:, k] = (quantities(shifted)["g"] - g) / NEWTON_STEP
        alpha = alpha - mp.lu_solve(G, g)
    found = quantities(alpha)
    assert mp.norm(found["g"]) < mp.mpf(10) ** -38
    return found | {"alpha": alpha}


@cache
def truth(o: str, f: str, seed: int) -> tuple[Configurations, dict[str, Any]]:
    """One configuration, and the truth as doubles."""
    one, two = SPECIMENS[o], SPECIMENS[f]
    drawn = random_pairs(one, two, 30, seed=100 + seed)  # ten apart, ten touching, ten overlapping
    moderate = np.abs(np.abs(_margins(o, f, drawn)) - 0.3) < 0.25
    chosen = int(np.argmax(moderate & (np.arange(30) // 10 == seed % 3)))
    fields = {name: getattr(drawn, name)[..., chosen : chosen + 1] for name in drawn.__dataclass_fields__}
    at = replace(drawn, **fields)
    with mp.workdps(DIGITS):
        h, start = TIME_STEP, column(at.alpha[:, 0])
        before, now, after = (solved(contact(one, two, at, t), start) for t in (-h, mp.mpf(0), h))
        rate = {name: (after[name] - before[name]) / (2 * h) for name in before}
        second = (after["d"] - 2 * now["d"] + before["d"]) / h**2
        numbers = {f"{name}_dot": doubles(value) for name, value in rate.items()}
        return at, numbers | {"d": doubles(now["d"]), "N": doubles(now["N"]), "d_ddot": doubles(second)}


def doubles(value: Any) -> Array:
    entries = list(value) if hasattr(value, "rows") else [value]
    return np.array([float(entry) for entry in entries])


def _margins(o: str, f: str, at: Configurations) -> Array:
    place = contact_kernels(kind_of(o, f, "differentiated")).place
    return columns(place, at.pose_o, at.pose_f, at.alpha, parameters(o, f, at.alpha.shape[1]))[3][0]


def test_the_configurations_span_rough_pairs_and_gaps() -> None:
    assert {name for o, f, _ in PAIRS for name in (o, f)} >= set(ROUGH)
    assert len(PAIRS) == 12
    assert {int(np.sign(np.round(truth(*pair)[1]["d"][0], 12))) for pair in PAIRS} == {-1, 0, 1}


@pytest.mark.parametrize(("o", "f", "seed", "form"), FAMILY)
def test_rates_are_those_of_solved_and_differenced_pairs(o: str, f: str, seed: int, form: str) -> None:
    at, expected = truth(o, f, seed)
    kind = kind_of(o, f, form)
    layout, kernels = eta_layout(kind), contact_kernels(kind)
    inputs = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(layout, at), parameters(o, f, 1))
    d, J_o, J_f, gamma, eta_dot, normal = (value[:, 0] for value in columns(kernels.rates, *inputs))
    normal_rate = columns(kernels.normal_rate, *inputs)[0][:, 0]
    none = np.zeros(0)
    carried = {
        "none": (none, none), "point": (expected["x_o_dot"], expected["x_f_dot"]),
        "chart": (expected["alpha_dot"][:2], expected["alpha_dot"][2:]),
    }  # fmt: skip
    for found, wanted in (
        (d, expected["d"]), (normal, expected["N"]), (normal_rate, expected["N_dot"]),
        (J_o @ at.twist_o + J_f @ at.twist_f, expected["d_dot"]),
        (J_o @ at.accel_o + J_f @ at.accel_f + gamma, expected["d_ddot"]),
        (eta_dot, np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])),
    ):  # fmt: skip
        assert np.linalg.norm(found - wanted) < TOLERANCE * max(1.0, float(np.linalg.norm(wanted)))
