"""The rates of two surfaces are those of extremal pairs solved to 60 digits and differenced in time."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from tests.laws.configurations import Array, Configurations, columns, eta_of, parameters, random_pairs
from tests.laws.differenced import Quantities, assert_same, at_index, differenced, frame, inner, moved
from tests.laws.families import CASES, ROUGH, kind_of
from tests.laws.shapes import SPECIMENS, Specimen

PAIRS = [
    ("ellipsoid", "ellipsoid", 0), ("ellipsoid", "torus", 1), ("ellipsoid", "superellipsoid", 2),
    ("ellipsoid", "patch", 3), ("torus", "torus", 4), ("torus", "superellipsoid", 5),
    ("torus", "patch", 6), ("superellipsoid", "superellipsoid", 7), ("superellipsoid", "patch", 8),
    ("patch", "patch", 9), ("plane", "ellipsoid", 10), ("ellipsoid", "torus_cavity", 11),
]  # fmt: skip
FAMILY = [(*pair, form) for pair in PAIRS for form in FORMS if (*pair[:2], form) in CASES]


def contact(o: Specimen, f: Specimen, at: Configurations, t: Any) -> Quantities:
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


@cache
def truth(o: str, f: str, seed: int) -> tuple[Configurations, dict[str, Array]]:
    """One configuration, and the truth as doubles."""
    one, two = SPECIMENS[o], SPECIMENS[f]
    drawn = random_pairs(one, two, 30, seed=100 + seed)  # ten apart, ten touching, ten overlapping
    moderate = np.abs(np.abs(_margins(o, f, drawn)) - 0.3) < 0.25
    chosen = int(np.argmax(moderate & (np.arange(30) // 10 == seed % 3)))
    at = at_index(drawn, chosen)
    return at, differenced(lambda t: contact(one, two, at, t), at.alpha[:, 0])


def _margins(o: str, f: str, at: Configurations) -> Array:
    place = contact_kernels(kind_of(o, f, "differentiated")).place
    return columns(place, at.pose_o, at.pose_f, at.alpha, parameters(o, f, at.alpha.shape[1]))[3][0]


@pytest.mark.slow
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
    assert_same((
        (d, expected["d"]), (normal, expected["N"]), (normal_rate, expected["N_dot"]),
        (J_o @ at.twist_o + J_f @ at.twist_f, expected["d_dot"]),
        (J_o @ at.accel_o + J_f @ at.accel_f + gamma, expected["d_ddot"]),
        (eta_dot, np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])),
    ))  # fmt: skip
