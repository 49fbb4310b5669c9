"""The rates of the explicit kinds are those of pairs solved to 60 digits and differenced in time."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from tests.curves.specimens import ALL
from tests.curves.test_high_precision import along
from tests.explicit.configurations import Pairs, carried, lengths, random_pairs
from tests.explicit.specimens import CASES, CENTRES, is_surface, kind_of
from tests.laws.configurations import columns
from tests.laws.differenced import Quantities, assert_same, at_index, column, differenced, frame, inner, moved

PAIRS = [
    ("ellipsoid", "vertex", 0), ("patch", "vertex", 1), ("sphere", "vertex", 2), ("plane", "vertex", 0),
    ("superellipsoid", "ball", 1), ("torus", "ball", 2), ("ellipsoid", "hollow", 0), ("patch", "hollow", 1),
    ("helix", "vertex", 0), ("rod", "vertex", 1), ("wave", "ball", 2), ("ellipse_curve", "hollow", 1),
]  # fmt: skip
FAMILY = [(*pair, form) for pair in PAIRS for o, f, form in CASES if (o, f) == pair[:2]]


def contact(o: str, f: str, at: Pairs, t: Any) -> Quantities:
    """alpha -> extremality residual, d, N and the point of o at the instant t."""
    p_o, R_o = moved(at.pose_o[:, 0], at.twist_o[:, 0], at.accel_o[:, 0], t)
    p_f, R_f = moved(at.pose_f[:, 0], at.twist_f[:, 0], at.accel_f[:, 0], t)
    one, two = ALL[o], CENTRES[f]
    centre = p_f + R_f * column(two.at)

    def quantities(alpha: Any) -> dict[str, Any]:
        if is_surface(o):
            x_o, tangents, n_o = frame(one, alpha)  # type: ignore[arg-type]
            N = R_o * n_o
        else:
            x_o, tangent = along(one, alpha[0])  # type: ignore[arg-type]
            tangents, N = [tangent], (centre - p_o - R_o * x_o) * (-1 if two.radius < 0 else 1)
            N = N / mp.norm(N)
        between = centre - p_o - R_o * x_o
        g = mp.matrix([inner(R_o * each, between) for each in tangents])
        return {"g": g, "d": inner(N, between) - mp.mpf(two.radius), "N": N, "x_o": x_o}

    return quantities


def chosen(o: str, f: str, seed: int) -> Pairs:
    """One regular configuration: apart, touching or overlapping as the seed says."""
    drawn = random_pairs(o, f, 30, seed=100 + seed)  # ten of each
    form = next(form for one, two, _, form in FAMILY if (one, two) == (o, f))
    kind = kind_of(o, f, form)
    eta = carried(eta_layout(kind), drawn.alpha, drawn.x_o)
    mu = np.abs(
        columns(contact_kernels(kind).place, drawn.pose_o, drawn.pose_f, eta, lengths(o, f, 30))[3][0]
    )
    return at_index(drawn, int(np.argmax((mu > 0.1) & (np.arange(30) // 10 == seed))))


@pytest.mark.cases(8)
@pytest.mark.parametrize(("o", "f", "seed", "form"), FAMILY)
def test_rates_are_those_of_solved_and_differenced_pairs(o: str, f: str, seed: int, form: str) -> None:
    at, kind = chosen(o, f, seed), kind_of(o, f, form)
    layout, kernels = eta_layout(kind), contact_kernels(kind)
    expected = differenced(lambda t: contact(o, f, at, t), at.alpha[:, 0])
    eta = carried(layout, at.alpha, at.x_o)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths(o, f, 1)
    d, J_o, J_f, gamma, eta_dot, N = (value[:, 0] for value in columns(kernels.rates, *inputs))
    N_dot = columns(kernels.normal_rate, *inputs)[0][:, 0]
    assert_same((
        (d, expected["d"]), (N, expected["N"]), (N_dot, expected["N_dot"]),
        (J_o @ at.twist_o + J_f @ at.twist_f, expected["d_dot"]),
        (J_o @ at.accel_o + J_f @ at.accel_f + gamma, expected["d_ddot"]),
        (eta_dot, carried(layout, expected["alpha_dot"], expected["x_o_dot"])),
    ))  # fmt: skip
