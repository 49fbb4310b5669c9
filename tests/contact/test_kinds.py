"""The table of forms: what applies, what is regular, what is cheapest, and what it costs."""

from __future__ import annotations

from itertools import product

import casadi as ca
import numpy as np
import pytest

from modelgen.contact.form_table import (
    FORMS,
    choose_form,
    contact_kernels,
    eta_layout,
    instructions,
    order,
    regular_forms,
)
from modelgen.contact.kernels import PLACE_INPUTS, PLACE_OUTPUTS, RATES_INPUTS, RATES_OUTPUTS, SLIP_OUTPUTS
from modelgen.errors import SceneError
from modelgen.model import BodyMotion, ContactKind, Posing, Rows, ShapeKind, Side
from modelgen.notation import ETA_SIZE, notation
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Chart
from modelgen.scene.shape_catalogue import SHAPES

ROWS: tuple[Rows, ...] = (1, 3, 6)
X, Y, Z = (parse_expression(text, ("u", "v")) for text in ("u", "v", "u**2 + v**2"))
KINDS = {name: ShapeKind(name, name, spec.parameters) for name, spec in SHAPES.items()}
KINDS["sheet"] = ShapeKind("sheet", "chart", (), chart=Chart((X, Y, Z), ((-1.0, 1.0), (-1.0, 1.0))))
FLAT = ("plane", "line", "segment", "edge")  # a plane touches them nowhere or all along
PAIRS = [
    (a, b)
    for a, b in product(KINDS, repeat=2)
    if not order(KINDS[a], KINDS[b]) and not (a == "plane" and b in FLAT) and not a == b == "point"
]
CEILINGS = {  # instructions of the rates
    ("ellipsoid", "free", "general", "ellipsoid", "implicit"): 466,
    ("ellipsoid", "fixed", "identity", "ellipsoid", "implicit"): 335,
    ("ellipsoid", "fixed", "general", "ellipsoid", "implicit"): 389,
    ("plane", "fixed", "identity", "ellipsoid", "support"): 89,
    ("plane", "free", "general", "ellipsoid", "support"): 235,
    ("plane", "fixed", "identity", "ellipsoid", "implicit"): 143,
    ("ellipsoid", "free", "general", "ellipsoid", "mixed"): 568,
    ("ellipsoid", "free", "general", "ellipsoid", "block"): 649,
    ("ellipsoid", "free", "general", "ellipsoid", "paper"): 739,
    ("torus", "free", "general", "torus", "implicit"): 484,
    ("plane", "fixed", "identity", "circle", "support"): 67,
    ("plane", "free", "general", "circle", "support"): 206,
    ("plane", "free", "general", "helix", "curve_implicit"): 235,
    ("ellipsoid", "free", "general", "circle", "curve_implicit"): 426,
    ("ellipsoid", "free", "general", "line", "curve_implicit"): 390,
    ("ellipsoid", "free", "general", "ellipse_curve", "curve_block"): 550,
    ("circle", "fixed", "general", "circle", "curves_block"): 389,
    ("circle", "free", "general", "circle", "curves_block"): 500,
    ("line", "free", "general", "line", "curves_block"): 422,
    ("line", "free", "general", "line", "edge_edge"): 322,
    ("edge", "fixed", "general", "edge", "edge_edge"): 191,
    ("sphere", "free", "general", "ellipsoid", "centre_surface"): 267,
    ("sphere", "free", "general", "torus", "centre_surface"): 276,
    ("ellipsoid", "free", "general", "point", "centre_surface"): 364,
    ("sphere", "free", "general", "circle", "centre_curve"): 210,
    ("circle", "free", "general", "point", "centre_curve"): 306,
    ("plane", "free", "general", "point", "explicit"): 205,
    ("sphere", "free", "general", "point", "explicit"): 168,
}
SLIDING = {  # instructions of the rates with 1, 3 and 6 rows, in the cheapest form of each
    ("plane", "fixed", "identity", "ellipsoid"): (89, 164, 185),
    ("plane", "free", "general", "ellipsoid"): (235, 392, 448),
    ("ellipsoid", "fixed", "identity", "ellipsoid"): (335, 439, 476),
    ("ellipsoid", "free", "general", "ellipsoid"): (466, 645, 709),
    ("plane", "fixed", "identity", "sphere"): (16, 51, 75),
    ("sphere", "free", "general", "sphere"): (71, 368, 427),
    ("plane", "fixed", "identity", "circle"): (67, 131, 152),
    ("plane", "fixed", "identity", "point"): (62, 125, 146),
    ("edge", "free", "general", "edge"): (322, 582, 681),
}


def side(name: str, motion: BodyMotion = "free", pose: Posing = "general") -> Side:
    return Side(KINDS[name], motion, pose)


@pytest.mark.parametrize(("key", "ceiling"), CEILINGS.items())
def test_rates_cost_no_more_than_their_ceiling(
    key: tuple[str, BodyMotion, Posing, str, str], ceiling: int
) -> None:
    o, motion, pose, f, form = key
    assert instructions(ContactKind("count", form, side(o, motion, pose), side(f))) <= ceiling


@pytest.mark.cases(5)
@pytest.mark.parametrize(("key", "ceilings"), SLIDING.items())
def test_tangential_rows_cost_no_more_than_their_ceiling(
    key: tuple[str, BodyMotion, Posing, str], ceilings: tuple[int, int, int]
) -> None:
    o, motion, pose, f = key
    one, two = side(o, motion, pose), side(f)
    for rows, ceiling in zip(ROWS, ceilings, strict=True):
        kind = ContactKind("count", choose_form(one, two, rows), one, two, rows)
        assert instructions(kind) <= ceiling


def test_a_ball_on_the_ground_costs_next_to_nothing() -> None:
    """No orientation, no eta: d = z - r, J = e_z, gamma = 0."""
    kind = ContactKind("ball", "explicit", side("plane", "fixed", "identity"), side("sphere", "point"))
    assert instructions(kind) <= 13


@pytest.mark.cases(22)
@pytest.mark.parametrize(("o", "f"), PAIRS)
def test_the_cheapest_regular_form_is_chosen(o: str, f: str) -> None:
    names = regular_forms(side(o), side(f))
    costs = {name: instructions(ContactKind("candidate", name, side(o), side(f))) for name in names}
    assert costs[choose_form(side(o), side(f))] == min(costs.values())


@pytest.mark.parametrize(("o", "f"), PAIRS)
def test_no_chart_with_poles_is_regular_where_an_equation_exists(o: str, f: str) -> None:
    globes = ("sphere", "ellipsoid", "superellipsoid")
    for name in regular_forms(side(o), side(f)):
        layout = FORMS[name].layout(KINDS[o], KINDS[f])
        assert not any(
            each == "chart" and shape in globes for each, shape in zip(layout, (o, f), strict=True)
        )


@pytest.mark.parametrize(
    ("o", "f", "form"),
    [
        ("plane", "sphere", "explicit"), ("sphere", "sphere", "explicit"), ("plane", "torus", "support"),
        ("ellipsoid", "ellipsoid", "implicit"), ("ellipsoid", "sheet", "mixed"),
        ("plane", "ellipsoid", "support"), ("plane", "circle", "support"),
        ("plane", "helix", "curve_implicit"), ("sheet", "circle", "curve_block"),
        ("circle", "helix", "curves_block"), ("line", "edge", "edge_edge"),
        ("sphere", "helix", "centre_curve"),
        ("sphere", "ellipsoid", "centre_surface"), ("sphere", "sheet", "centre_surface"),
        ("plane", "point", "explicit"), ("sphere", "point", "explicit"), ("sheet", "point", "centre_surface"),
        ("edge", "point", "centre_curve"),
    ],
)  # fmt: skip
def test_expected_choices(o: str, f: str, form: str) -> None:
    assert choose_form(side(o), side(f)) == form


def test_two_user_charts_have_chart_forms_only() -> None:
    assert set(regular_forms(side("sheet"), side("sheet"))) == {"block", "paper", "differentiated"}


def test_planes_come_first_and_points_last() -> None:
    assert order(KINDS["sphere"], KINDS["plane"])
    assert not order(KINDS["plane"], KINDS["sphere"])
    assert all(order(KINDS["point"], kind) for name, kind in KINDS.items() if name != "point")
    assert not any(order(kind, kind) for kind in KINDS.values())


@pytest.mark.cases(5)
@pytest.mark.parametrize(
    ("o", "f"),
    [("plane", "ellipsoid"), ("ellipsoid", "sheet"), ("torus", "torus"), ("torus", "helix"),
     ("line", "circle"), ("line", "edge"), ("sphere", "sheet"), ("ellipsoid", "point"), ("helix", "point")],
)  # fmt: skip
def test_kernels_have_the_names_and_shapes_of_the_generated_code(o: str, f: str) -> None:
    for form in FORMS.values():
        if not form.applies(KINDS[o], KINDS[f]):
            continue
        kind = ContactKind(f"{o}_{f}_{form.name}", form.name, side(o, "fixed"), side(f, "driven"))
        kernels = contact_kernels(kind)
        n_eta = sum(ETA_SIZE[parametrisation] for parametrisation in eta_layout(kind))
        n_par = len(KINDS[o].parameter_names) + len(KINDS[f].parameter_names)
        assert (kernels.rates.name(), kernels.place.name()) == (
            f"mg_{kind.name}_rates",
            f"mg_{kind.name}_place",
        )
        assert signature(kernels.rates) == (
            dict(zip(RATES_INPUTS, (12, 0, 12, 6, n_eta, n_par), strict=True)),
            dict(zip(RATES_OUTPUTS, (1, 0, 6, 1, n_eta, 3), strict=True)),
        )
        assert signature(kernels.place) == (
            dict(zip(PLACE_INPUTS, (12, 12, n_eta, n_par), strict=True)),
            dict(zip(PLACE_OUTPUTS, (n_eta, 1, 2, 2, 3, 3, 3), strict=True)),
        )


@pytest.mark.parametrize("rows", ROWS[1:])
@pytest.mark.parametrize(("o", "f"), [("plane", "ellipsoid"), ("ellipsoid", "helix")])
def test_tangential_rows_stand_below_the_normal_one(o: str, f: str, rows: Rows) -> None:
    one, two = side(o, "point"), side(f, "driven")
    kind = ContactKind("sliding", choose_form(one, two, rows), one, two, rows)
    n_eta = sum(ETA_SIZE[parametrisation] for parametrisation in eta_layout(kind))
    wanted = (1, 3 * rows, 6 * rows, rows, n_eta, 3, 6)
    sizes = signature(contact_kernels(kind).rates)[1]
    assert sizes == dict(zip(SLIP_OUTPUTS, wanted, strict=True))


def signature(f: ca.Function) -> tuple[dict[str, int], dict[str, int]]:
    """Names and lengths; every argument and result is a dense column with an entry in the notation."""
    assert all(f.sparsity_in(i).is_dense() and f.size2_in(i) in (0, 1) for i in range(f.n_in()))
    assert all(f.sparsity_out(i).is_dense() and f.size2_out(i) == 1 for i in range(f.n_out()))
    assert all(notation(name).meaning for name in (*f.name_in(), *f.name_out()))
    return (
        {f.name_in(i): f.size1_in(i) for i in range(f.n_in())},
        {f.name_out(i): f.size1_out(i) for i in range(f.n_out())},
    )


def test_folded_numbers_leave_no_parameters_and_change_nothing() -> None:
    folded = Side(ShapeKind("egg", "ellipsoid", ("a", "b", "c"), folded=(1.0, 0.7, 0.5)), "free")
    ground = side("plane", "fixed", "identity")
    for form in ("support", "implicit", "block"):
        plain = contact_kernels(ContactKind("plain", form, ground, side("ellipsoid"))).rates
        fold = contact_kernels(ContactKind("fold", form, ground, folded)).rates
        assert fold.size1_in(5) == 0
        pose = [0.1, 0.2, 0.6, 0, 0.6, 0.8, 0, -0.8, 0.6, 1, 0, 0]
        twist, eta = np.linspace(-1, 1, 6), np.linspace(0.1, 0.4, plain.size1_in(4))
        for a, b in zip(
            plain([], [], pose, twist, eta, [1.0, 0.7, 0.5]), fold([], [], pose, twist, eta, []), strict=True
        ):
            np.testing.assert_allclose(np.array(a), np.array(b), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("form", ["support", "no_such_form"])
def test_a_form_that_does_not_apply_is_named_with_those_that_do(form: str) -> None:
    with pytest.raises(SceneError, match="implicit") as error:
        contact_kernels(ContactKind("pair", form, side("torus"), side("torus")))
    assert form in str(error.value)


@pytest.mark.parametrize("flat", FLAT)
def test_flat_on_flat_has_no_form(flat: str) -> None:
    with pytest.raises(SceneError, match="no form"):
        choose_form(side("plane"), side(flat))


def test_a_point_against_a_point_is_refused_with_the_reason() -> None:
    for refused in (
        lambda: choose_form(side("point"), side("point")),
        lambda: contact_kernels(ContactKind("pair", "explicit", side("point"), side("point"))),
    ):
        with pytest.raises(SceneError, match="no normal where they touch") as error:
            refused()
        assert "make it a sphere" in str(error.value)
