"""Every form gives the d, N, J, gamma, eta_dot and N_dot of implicit differentiation, in all families.

A new form or shape joins by being listed in the table of forms or among the specimens.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from tests.laws.configurations import Array, Configurations, columns, eta_of, parameters, random_pairs
from tests.laws.families import CASES, PAIRS, ROUGH, kind_of
from tests.laws.oracle import Truth, eta_dot_of, truth
from tests.laws.shapes import SPECIMENS

TOLERANCE = 1e-9  # relative, where |mu| > 1e-2
MU = 1e-2
COUNT = 140  # random configurations per pair


@cache
def case(o: str, f: str) -> tuple[Configurations, Truth]:
    """Random extremal pairs and their truth."""
    at = random_pairs(SPECIMENS[o], SPECIMENS[f], COUNT, seed=len(o) * 31 + len(f))
    return at, truth(SPECIMENS[o], SPECIMENS[f], at)


def regular(o: str, f: str) -> Array:
    """Which configurations have |mu| > 1e-2."""
    at, _ = case(o, f)
    kernels = contact_kernels(kind_of(o, f, "differentiated"))
    margin = columns(kernels.place, at.pose_o, at.pose_f, at.alpha, parameters(o, f, COUNT))[3]
    return np.abs(margin[0]) > MU


def reached(f: str, form: str, at: Configurations) -> Array:
    """Which contact points the form can have: a support map reaches the outer half of a torus only."""
    if f != "torus" or form != "support":
        return np.ones(COUNT, dtype=bool)
    return np.cos(at.alpha[3]) > 0


def error(found: Array, expected: Array) -> Array:
    """Relative to the size of the expected column, or to 1 where that is smaller: all data are of order 1."""
    scale = np.maximum(1.0, np.linalg.norm(expected, axis=0))
    return np.linalg.norm(found - expected, axis=0) / scale


@pytest.mark.cases(40)
@pytest.mark.parametrize(("o", "f", "form"), CASES)
def test_rates_are_those_of_the_implicit_solution(o: str, f: str, form: str) -> None:
    at, expected = case(o, f)
    kind = kind_of(o, f, form)
    layout, kernels = eta_layout(kind), contact_kernels(kind)
    inputs = (at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta_of(layout, at), parameters(o, f, COUNT))
    d, J_o, J_f, gamma, eta_dot, normal = columns(kernels.rates, *inputs)
    (normal_rate,) = columns(kernels.normal_rate, *inputs)
    d_dot = np.sum(J_o * at.twist_o + J_f * at.twist_f, axis=0)
    d_ddot = np.sum(J_o * at.accel_o + J_f * at.accel_f, axis=0) + gamma[0]
    fine = regular(o, f) & reached(f, form, at)
    assert fine.sum() > COUNT / 3
    for found, wanted in (
        (d, expected.d[None]), (normal, expected.normal), (d_dot[None], expected.d_dot[None]),
        (d_ddot[None], expected.d_ddot[None]), (normal_rate, expected.normal_rate),
        (eta_dot, eta_dot_of(layout, expected)),
    ):  # fmt: skip
        assert error(found, wanted)[fine].max() < TOLERANCE


def test_there_are_a_thousand_configurations() -> None:
    rough = [pair for pair in PAIRS if set(pair) <= set(ROUGH)]
    assert len(rough) == 10
    assert sum(int(regular(*pair).sum()) for pair in rough) >= 1000
