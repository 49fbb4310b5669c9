"""The tangential rows are those of pairs solved to 60 digits, of points and rotations differenced in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import ContactKind
from tests.curves import configurations as strands
from tests.curves import test_high_precision as of_curves
from tests.curves.specimens import ON_CURVES
from tests.curves.specimens import kind_of as kind_of_curves
from tests.explicit import configurations as centres
from tests.explicit import test_high_precision as of_centres
from tests.explicit.specimens import kind_of as kind_of_centres
from tests.laws import test_high_precision as of_surfaces
from tests.laws.configurations import Array, columns, eta_of, parameters
from tests.laws.differenced import (
    TANGENT_STEP,
    Found,
    assert_same,
    cross,
    differenced,
    inner,
    moved,
)
from tests.laws.families import kind_of as kind_of_surfaces
from tests.laws.shapes import SPECIMENS
from tests.laws.slip import times

FAMILY = [
    *(("surfaces", *case) for case in of_surfaces.FAMILY),
    *(("curves", *case) for case in of_curves.FAMILY),
    *(("centres", *case) for case in of_centres.FAMILY),
]
ONCE: list[Any] = []  # every pair and every form at least once
for case in FAMILY:
    known = {name for other in ONCE for name in (other[1:3], other[4])}
    ONCE += [case] if not {case[1:3], case[4]} <= known else []
SEAM = mp.mpf("-0.38")


def frame(n: Any) -> list[Any]:
    """e_x and +-e_y of the pole +-e_z turned with it to n."""
    side = 1 if n[2] >= SEAM else -1
    pole = mp.matrix([0, 0, side])
    axis, cosine = cross(pole, n), inner(pole, n)
    starts = mp.matrix([1, 0, 0]), mp.matrix([0, side, 0])
    return [e + cross(axis, e) + cross(axis, cross(axis, e)) / (1 + cosine) for e in starts]


def spin(before: Any, now: Any, after: Any) -> Any:
    W = (after - before) * now.T / (2 * TANGENT_STEP)
    return mp.matrix([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2


def rows_of(at: Any) -> Callable[[Any, Found], Found]:
    """At an instant "rows": N, t1, t2 times the velocity and the spin of f past o."""
    motions = [
        [each[:, 0] for each in side]
        for side in ((at.pose_o, at.twist_o, at.accel_o), (at.pose_f, at.twist_f, at.accel_f))
    ]

    def rows(t: Any, found: Found) -> Found:
        instants = [[moved(*side, t + s * TANGENT_STEP) for s in (-1, 0, 1)] for side in motions]
        w = [spin(*(R for _, R in side)) for side in instants]
        (p_o, R_o), (p_f, R_f) = (side[1] for side in instants)
        points = [found["x_o"], R_f.T * (p_o + R_o * found["x_o"] + found["d"] * found["N"] - p_f)]
        velocities = [
            (side[2][0] + side[2][1] * x - side[0][0] - side[0][1] * x) / (2 * TANGENT_STEP)
            for side, x in zip(instants, points, strict=True)
        ]
        axes = [found["N"], *(R_o * t for t in frame(R_o.T * found["N"]))]
        passing = velocities[1] - velocities[0], w[1] - w[0]
        return {"rows": mp.matrix([inner(e, v) for v in passing for e in axes])}

    return rows


@cache
def truth(family: str, o: str, f: str, seed: int) -> tuple[Any, dict[str, Array]]:
    """One configuration, apart, touching or overlapping, and its truth as doubles."""
    if family == "surfaces":
        at, _ = of_surfaces.truth(o, f, seed)
        one, two = SPECIMENS[o], SPECIMENS[f]
        return at, differenced(lambda t: of_surfaces.contact(one, two, at, t), at.alpha[:, 0], rows_of(at))
    if family == "curves":
        at, _ = of_curves.truth(o, f, seed)
        return at, differenced(lambda t: of_curves.contact(o, f, at, t), at.alpha[:, 0], rows_of(at))
    at = of_centres.chosen(o, f, seed)
    return at, differenced(lambda t: of_centres.contact(o, f, at, t), at.alpha[:, 0], rows_of(at))


def inputs_of(family: str, o: str, f: str, form: str, at: Any) -> tuple[ContactKind, Array, Array]:
    """The kind, eta and lengths."""
    if family == "surfaces":
        kind = kind_of_surfaces(o, f, form)
        return kind, eta_of(eta_layout(kind), at), parameters(o, f, 1)
    if family == "curves":
        kind = kind_of_curves(o, f, form)
        return kind, strands.eta_of(kind, at), strands.lengths(o, f, 1)
    kind = kind_of_centres(o, f, form)
    return kind, centres.carried(eta_layout(kind), at.alpha, at.x_o), centres.lengths(o, f, 1)


@pytest.mark.cases(8)
@pytest.mark.parametrize(
    ("family", "o", "f", "seed", "form"),
    [pytest.param(*case, marks=() if case in ONCE else pytest.mark.slow) for case in FAMILY],
)
def test_rows_are_those_of_solved_and_differenced_pairs(
    family: str, o: str, f: str, seed: int, form: str
) -> None:
    at, expected = truth(family, o, f, seed)
    kind, eta, lengths = inputs_of(family, o, f, form, at)
    inputs = at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths
    _, J_o, J_f, gamma, *_ = columns(contact_kernels(replace(kind, rows=6)).rates, *inputs)
    speed = times(J_o, at.twist_o, 6) + times(J_f, at.twist_f, 6)
    gained = times(J_o, at.accel_o, 6) + times(J_f, at.accel_f, 6) + gamma
    assert_same(((speed[:, 0], expected["rows"]), (gained[:, 0], expected["rows_dot"])))


@pytest.mark.slow
def test_there_are_gaps_and_overlaps_with_curves_and_centres() -> None:
    drawn = [truth(*case[:4])[1]["d"][0] for case in FAMILY[::5]]
    assert {int(np.sign(np.round(d, 12))) for d in drawn} == {-1, 0, 1}
    assert any((o, f) in ON_CURVES for _, o, f, *_ in FAMILY)
