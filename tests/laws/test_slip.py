"""Tangential rows of every pair of specimens in every form are those of material points that move."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen.contact.form_table import contact_kernels, eta_layout
from modelgen.model import ContactKind
from tests.curves import configurations as strands
from tests.curves import test_laws as of_curves
from tests.curves.specimens import CASES as CURVES
from tests.curves.specimens import kind_of as kind_of_curves
from tests.explicit import configurations as centres
from tests.explicit import test_laws as of_centres
from tests.explicit.specimens import CASES as CENTRES
from tests.explicit.specimens import kind_of as kind_of_centres
from tests.laws import test_differentiation as of_surfaces
from tests.laws.configurations import Array, columns, eta_of, parameters
from tests.laws.families import CASES as SURFACES
from tests.laws.families import kind_of as kind_of_surfaces
from tests.laws.slip import expected_rows, times

TOLERANCE = 1e-9
FAMILY = [
    *(("surfaces", *case) for case in SURFACES),
    *(("curves", *case) for case in CURVES),
    *(("centres", *case) for case in CENTRES),
]
Case = tuple[ContactKind, Any, Any, Array, Array, Array]


def case_of(family: str, o: str, f: str, form: str) -> Case:
    """The kind, its configurations with their truth, eta, lengths, and which of them are regular."""
    if family == "surfaces":
        at, truth = of_surfaces.case(o, f)
        kind, n = kind_of_surfaces(o, f, form), len(at.d)
        fine = of_surfaces.regular(o, f) & of_surfaces.reached(f, form, at)
        return kind, at, truth, eta_of(eta_layout(kind), at), parameters(o, f, n), fine
    if family == "curves":
        at, truth = of_curves.case(o, f)
        kind = kind_of_curves(o, f, form)
        fine = of_curves.regular(o, f) & of_curves.reached(form, at, truth, f)
        return kind, at, truth, strands.eta_of(kind, at), strands.lengths(o, f, at.n), fine
    at, truth = of_centres.case(o, f)
    kind, fine = kind_of_centres(o, f, form), of_centres.regular(o, f, form)
    eta = centres.carried(eta_layout(kind), at.alpha, at.x_o)
    return kind, at, truth, eta, centres.lengths(o, f, at.n), fine


def rates(kind: ContactKind, at: Any, eta: Array, lengths: Array) -> dict[str, Array]:
    function = contact_kernels(kind).rates
    found = columns(function, at.pose_o, at.twist_o, at.pose_f, at.twist_f, eta, lengths)
    return dict(zip(function.name_out(), found, strict=True))


@pytest.mark.cases(25)
@pytest.mark.parametrize(("family", "o", "f", "form"), FAMILY)
def test_rows_are_those_of_material_points(family: str, o: str, f: str, form: str) -> None:
    """J u, d/dt (J u) = J u_dot + gamma at gaps, in contact and overlapping, and the documented frame."""
    kind, at, truth, eta, lengths, fine = case_of(family, o, f, form)
    found = rates(replace(kind, rows=6), at, eta, lengths)
    speed = times(found["J_o"], at.twist_o, 6) + times(found["J_f"], at.twist_f, 6)
    gained = times(found["J_o"], at.accel_o, 6) + times(found["J_f"], at.accel_f, 6) + found["gamma"]
    values, slopes, tangents = expected_rows(at, truth)
    assert fine.sum() > len(fine) / 4
    for got, wanted in ((speed, values), (gained, slopes), (found["tangents"], tangents)):
        assert of_surfaces.error(got, wanted)[fine].max() < TOLERANCE


@pytest.mark.cases(12)
@pytest.mark.parametrize(("family", "o", "f", "form"), FAMILY[::7])
def test_fewer_rows_are_the_first_of_more(family: str, o: str, f: str, form: str) -> None:
    kind, at, _, eta, lengths, fine = case_of(family, o, f, form)
    whole = rates(replace(kind, rows=6), at, eta, lengths)
    for rows in (1, 3):
        part = rates(replace(kind, rows=rows), at, eta, lengths)  # type: ignore[arg-type]
        assert ("tangents" in part) == (rows > 1)
        for name, value in part.items():
            np.testing.assert_allclose(
                value[:, fine], whole[name][: len(value), fine], rtol=1e-11, atol=1e-11
            )


@pytest.mark.cases(32)
@pytest.mark.parametrize(("family", "o", "f", "form"), FAMILY[::3])
def test_the_frame_is_right_handed_and_orthonormal(family: str, o: str, f: str, form: str) -> None:
    kind, at, _, eta, lengths, _ = case_of(family, o, f, form)
    found = rates(replace(kind, rows=6), at, eta, lengths)
    t1, t2 = found["tangents"].reshape(2, 3, -1)
    for product, wanted in ((t1 * t1, 1), (t2 * t2, 1), (t1 * t2, 0)):
        np.testing.assert_allclose(product.sum(axis=0), wanted, atol=4e-15)
    np.testing.assert_allclose(np.cross(t1, t2, axis=0), found["normal"], atol=4e-15)
