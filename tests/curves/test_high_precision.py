"""The rates of contacts with curves are those of pairs solved to 60 digits and differenced in time."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels
from tests.curves.configurations import Pairs, Truth, columns, eta_dot_of, eta_of, lengths, random_pairs
from tests.curves.specimens import ALL, BENDS, CASES, ON_CURVES, Bend, kind_of
from tests.laws.differenced import (
    TANGENT_STEP,
    Quantities,
    assert_same,
    at_index,
    cross,
    differenced,
    frame,
    inner,
    moved,
)
from tests.laws.shapes import Specimen

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


def contact(o: str, f: str, at: Pairs, t: Any) -> Quantities:
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


@cache
def truth(o: str, f: str, seed: int) -> tuple[Pairs, Truth]:
    """One configuration, and the truth as doubles."""
    drawn = random_pairs(o, f, 30, seed=100 + seed)  # ten apart, ten touching, ten overlapping
    kind = kind_of(o, f, "curves_differentiated" if (o, f) in ON_CURVES else "curve_differentiated")
    place = contact_kernels(kind).place
    mu = np.abs(columns(place, drawn.pose_o, drawn.pose_f, eta_of(kind, drawn), lengths(o, f, 30))[3][0])
    chosen = int(np.argmax((mu > 0.1) & (np.arange(30) // 10 == seed % 3)))
    at = at_index(drawn, chosen)
    found = differenced(lambda t: contact(o, f, at, t), at.alpha[:, 0])
    value = {name: entries[:, None] for name, entries in found.items()}
    return at, Truth(
        found["d"], found["d_dot"], found["d_ddot"],
        value["alpha_dot"], value["x_o_dot"], value["N"], value["N_dot"],
    )  # fmt: skip


@pytest.mark.slow
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
    assert_same((
        (d[0], expected.d), (N, expected.normal), (N_dot, expected.normal_rate),
        (d_dot, expected.d_dot), (d_ddot, expected.d_ddot), (eta_dot, eta_dot_of(kind, expected)),
    ))  # fmt: skip
