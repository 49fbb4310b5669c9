"""The family under the laws: every pair of specimens with every form that applies to it."""

from __future__ import annotations

from itertools import combinations_with_replacement

import pytest

from modelgen.contact.form_table import FORMS, eta_layout, order
from modelgen.model import BodyMotion, ContactKind, Posing, Rows, Side
from tests.laws.shapes import SPECIMENS

ROUGH = ("ellipsoid", "torus", "superellipsoid", "patch")
_CONVEX = ("sphere", "ellipsoid", "torus", "superellipsoid", "paraboloid", "patch")
_MORE = [
    *(("plane", name) for name in _CONVEX),
    ("sphere", "sphere"),
    ("ellipsoid", "cylinder"),
    ("sphere", "paraboloid"),
    ("ellipsoid", "cone"),
    ("cone", "patch"),
    ("ellipsoid", "bezier"),
    ("ellipsoid", "bezier_graph"),
    ("paraboloid", "patch"),
    ("plane_cavity", "ellipsoid"),
    ("sphere", "sphere_cavity"),
    ("sphere_cavity", "ellipsoid"),
    ("ellipsoid_cavity", "ellipsoid"),
    ("ellipsoid_cavity", "superellipsoid"),
    ("ellipsoid", "torus_cavity"),
    ("ellipsoid", "patch_cavity"),
]


def _ordered(a: str, b: str) -> tuple[str, str]:
    return (b, a) if order(SPECIMENS[a].kind, SPECIMENS[b].kind) else (a, b)


PAIRS = [_ordered(*pair) for pair in [*combinations_with_replacement(ROUGH, 2), *_MORE]]
CASES = [
    (o, f, form.name)
    for o, f in PAIRS
    for form in FORMS.values()
    if form.applies(SPECIMENS[o].kind, SPECIMENS[f].kind)
]


def kind_of(
    o: str,
    f: str,
    form: str,
    motions: tuple[BodyMotion, BodyMotion] = ("free", "free"),
    pose: Posing = "general",
    placement: Posing = "identity",
    rows: Rows = 1,
) -> ContactKind:
    """A contact kind of two specimens; `pose` is that of o, `placement` that of both shapes."""
    one = Side(SPECIMENS[o].kind, motions[0], pose, placement)
    two = Side(SPECIMENS[f].kind, motions[1], "general", placement)
    return ContactKind("law", form, one, two, rows)


def one_of_each() -> set[tuple[str, str, str]]:
    """The first case of each form and way to carry eta, with a plane or not, with cavities or not."""
    found: dict[object, tuple[str, str, str]] = {}
    for o, f, form in CASES:
        sides = o.startswith("plane"), o.endswith("_cavity"), f.endswith("_cavity")
        found.setdefault((form, eta_layout(kind_of(o, f, form)), sides), (o, f, form))
    return set(found.values())


ONE_OF_EACH = one_of_each()
SPARSE = [  # for laws that a shape enters through its side of the pair alone
    pytest.param(*case, marks=() if case in ONE_OF_EACH else pytest.mark.slow) for case in CASES
]
