"""The other independent route for curves: 60-digit Newton, tangents and time derivatives by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.kinds import contact_kernels
from tests.curves.configurations import Pairs, Truth, columns, eta_dot_of, eta_of, lengths, random_pairs
from tests.curves.specimens import ALL, BENDS, CASES, ON_CURVES, Bend, kind_of
from tests.laws.configurations import Array
from tests.laws.shapes import Specimen
from tests.laws.test_high_precision import (
    DIGITS,
    NEWTON_STEP,
    TANGENT_STEP,
    TIME_STEP,
    TOLERANCE,
    column,
    cross,
    doubles,
    frame,
    inner,
    moved,
)

PAIRS = [
    ("sphere", "circle", 0), ("ellipsoid", "segment", 1), ("ellipsoid", "helix", 2), ("torus", "edge", 3),
    ("patch", "wave", 4), ("cylinder", "helix", 5),
    ("line", "edge", 0), ("line", "circle", 1), ("circle", "circle", 2), ("ellipse_curve", "helix", 3),
    ("helix", "helix", 4), ("wave", "edge", 5),
]  # fmt: skip
FAMILY = [(*pair, form) for pair in PAIRS for o, f, form in CASES if (o, f) == pair[:2]]


def along(shape: Bend, t: Any) -> tuple[Any, Any]:
    """Point and derivative by central differences, shape frame."""

    def at(value: Any) -> Any:
        return mp.matrix(shape.curve(mp, value, [mp.mpf(p) for p in shape.parameters]))

    return at(t), (at(t + TANGENT_STEP) - at(t - TANGENT_STEP)) / (2 * TANGENT_STEP)


def contact(o: str, f: str, at: Pairs, t: Any) -> Callable[[Any], dict[str, Any]]:
    """alpha -> extremality residual, d, N and the point of o at the instant t."""
    p_o, R_o = moved(at.pose_o[:, 0], at.twist_o[:, 0], at.accel_o[:, 0], t)
    p_f, R_f = moved(at.pose_f[:, 0], at.twist_f[:, 0], at.accel_f[:, 0], t)
    one = ALL[o]

    def quantities(alpha: Any) -> dict[str, Any]:
        x_f, e_f = along(BENDS[f], alpha[len(alpha) - 1])
        E_f = R_f * e_f
        if isinstance(one, Specimen):
            x_o, tangents, n_o = frame(one, alpha[:2])
            E_o, N = [R_o * each for each in tangents], R_o * n_o
        else:
            x_o, tangent = along(one, alpha[0])
            E_o = [R_o * tangent]
            N = cross(E_o[0], E_f) * at.sign[0]
            N = N / mp.norm(N)
        between = p_f + R_f * x_f - p_o - R_o * x_o
        g = [inner(each, between) for each in E_o]
        g.append(inner(E_f, N if isinstance(one, Specimen) else between))
        return {"g": mp.matrix(g), "d": inner(N, between), "N": N, "x_o": x_o}

    return quantities


def solved(quantities: Callable[[Any], dict[str, Any]], alpha: Any) -> dict[str, Any]:
    """The extremal pair near alpha, by Newton with differences."""
    for _ in range(5):
        g = quantities(alpha)["g"]
        G = mp.matrix(len(alpha), len(alpha))
        for k in range(len(alpha)):
            shifted = alpha.copy()
            shifted[k] += NEWTON_STEP
            G[:, k] = (quantities(shifted)["g"] - g) / NEWTON_STEP
        alpha = alpha - mp.lu_solve(G, g)
    found = quantities(alpha)
    assert mp.norm(found["g"]) < mp.mpf(10) ** -38
    return found | {"alpha": alpha}


@cache
def truth(o: str, f: str, seed: int) -> tuple[Pairs, Truth]:
    """One configuration, and the truth as doubles."""
    drawn = random_pairs(o, f, 30, seed=100 + seed)  # ten apart, ten touching, ten overlapping
    kind = kind_of(o, f, "curves_differentiated" if (o, f) in ON_CURVES else "curve_differentiated")
    place = contact_kernels(kind).place
    mu = columns(place, drawn.pose_o, drawn.pose_f, eta_of(kind, drawn), lengths(o, f, 30))[3][0]
    chosen = int(np.argmax((mu > 0.1) & (np.arange(30) // 10 == seed % 3)))
    at = replace(
        drawn, **{entry.name: getattr(drawn, entry.name)[..., chosen : chosen + 1] for entry in fields(drawn)}
    )
    with mp.workdps(DIGITS):
        h, start = TIME_STEP, column(at.alpha[:, 0])
        before, now, after = (solved(contact(o, f, at, t), start) for t in (-h, mp.mpf(0), h))
        rate = {name: one_column((after[name] - before[name]) / (2 * h)) for name in before}
        second = one_column((after["d"] - 2 * now["d"] + before["d"]) / h**2)
        N, d = one_column(now["N"]), one_column(now["d"])
    return at, Truth(d[0], rate["d"][0], second[0], rate["alpha"], rate["x_o"], N, rate["N"])


def one_column(value: Any) -> Array:
    return doubles(value)[:, None]


def test_the_configurations_are_a_dozen_with_straight_edges_and_all_gaps() -> None:
    assert len(PAIRS) == 12
    assert {int(np.sign(np.round(truth(*pair)[1].d[0], 12))) for pair in PAIRS} == {-1, 0, 1}


@pytest.mark.parametrize(("o", "f", "seed", "form"), FAMILY)
def test_rates_are_those_of_solved_and_differenced_pairs(o: str, f: str, seed: int, form: str) -> None:
    at, expected = truth(o, f, seed)
    kind = kind_of(o, f, form)
    kernels = contact_kernels(kind)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(kind, at), lengths(o, f, 1)
    d, J_o, J_f, gamma, eta_dot, N = columns(kernels.rates, *inputs)
    (N_dot,) = columns(kernels.normal_rate, *inputs)
    d_dot = np.sum(J_o * at.twist_o + J_f * at.twist_f, axis=0)
    d_ddot = np.sum(J_o * at.accel_o + J_f * at.accel_f, axis=0) + gamma[0]
    for found, wanted in (
        (d[0], expected.d), (N, expected.normal), (N_dot, expected.normal_rate),
        (d_dot, expected.d_dot), (d_ddot, expected.d_ddot), (eta_dot, eta_dot_of(kind, expected)),
    ):  # fmt: skip
        assert np.linalg.norm(found - wanted) < TOLERANCE * max(1.0, float(np.linalg.norm(wanted)))
