"""Charts with poles: a cap is the same surface as the chart, and knows whether the pole is smooth."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from modelgen.errors import SceneError
from modelgen.geometry.composites.charts_with_ends import INNER
from modelgen.geometry.pole_caps import DEGREE, Pole, cap_at, poles_of
from modelgen.geometry.polynomial_pieces import cap_degree, cap_exponents
from modelgen.geometry.shape_features import features_of, is_composite, is_convex
from modelgen.scene import python_scenes as build
from modelgen.scene.scene_types import NO_POLES, Shape
from tests.geometry.joins import COUNT, change, curvatures, features, forms_of, jets
from tests.laws.configurations import Array

HALF = (-pi / 2, pi / 2)
TURN = (0.0, 2 * pi)
SIZES = {"a": 0.08, "b": 0.04, "c": 0.03, "bend": 0.02}
BEAN = ("a*sin({u})", "b*cos({u})*cos({v})", "bend*sin({u})**2 - c*cos({u})*sin({v})")


def bean(u: str, v: str, along_u: bool) -> Shape:
    """A bent ellipsoid without symmetry of revolution, its poles at the ends of u or of v."""
    domains, names = ([HALF, TURN], ["u_min", "u_max"]) if along_u else ([TURN, HALF], ["v_min", "v_max"])
    x, y, z = (text.format(u=u, v=v) for text in BEAN)
    return build.chart(
        x, y, z, domain=domains, periodic=[not along_u, along_u], poles=names, parameters=SIZES, name="bean"
    )


CHARTS = {
    "sphere": build.revolution("R*cos(t)", "R*sin(t)", domain=HALF, parameters={"R": 0.3}),
    "egg": build.revolution("0.3*sin(t)", "0.4*cos(t) + 0.05*cos(t)**2", domain=[0, pi]),
    "dish": build.revolution("t", "t**2/3 - t**4", domain=[0, 0.4]),
    "sparse": build.revolution("t", "t**20", domain=[0, 1]),
    "turned": build.chart(
        "sin(u)*sin(2*v)", "sin(u)*cos(2*v)", "2*cos(u) + u*u", domain=[(0, 1), (0.3, pi + 0.3)],
        periodic=[False, True], poles=["u_min"],
    ),
    "twisted": build.chart(
        "u*cos(v + u*u)", "u*sin(v + u*u)", "u**2", domain=[(0, 1), TURN], periodic=[False, True],
        poles=["u_min"],
    ),
    "bean along u": bean("u", "v", along_u=True),
    "bean along v": bean("v", "-u", along_u=False),
    "waves": build.chart(
        "u*cos(v)", "u*sin(v)", "0.1*exp(-u**2)*(1 + u**2*cos(2*v)) + u*sin(v)/5",
        domain=[(0, 1), (0, 2 * pi)], periodic=[False, True], poles=["u_min"],
    ),
}  # fmt: skip
POLES = [(name, pole) for name, shape in CHARTS.items() for pole in poles_of(shape.chart)]


def told_twice(
    name: str, pole: Pole, s: Array, theta: Array
) -> tuple[tuple[Shape, Array], tuple[Shape, Array]]:
    """The same points, at s of the cap's radius, on the chart and on the cap."""
    shape = CHARTS[name]
    assert shape.chart is not None
    parts, cap = features(shape), cap_at(shape, pole)
    start, stop = shape.chart.domain[1 - pole.axis]
    along = shape.chart.domain[pole.axis][pole.end] + (1 - 2 * pole.end) * s * cap.radius
    around = start + (stop - start) * theta / (2 * pi)
    chart = np.array([along, around] if pole.axis == 0 else [around, along])
    other = parts[f"pole_{pole.name}"].shape
    disc = s * np.array([np.cos(theta), pole.turn * np.sin(theta)])
    if other.kind == "round_cap":
        x, _, _ = jets(parts["sheet"].shape, chart)
        across = x[:, :2] / np.linalg.norm(x[:, :2], axis=1, keepdims=True)
        disc = s * across.T * [[1.0], [dict(other.parameters)["side"]]]
    return (parts["sheet"].shape, chart), (other, disc)


def test_a_revolution_has_round_caps() -> None:
    kinds = {name: features(CHARTS[name])[f"pole_{pole.name}"].shape.kind for name, pole in POLES}
    others = {name for name, kind in kinds.items() if kind == "cap"}
    assert others == {"twisted", "bean along u", "bean along v", "waves"}


@pytest.mark.parametrize(("name", "pole"), POLES, ids=str)
def test_a_cap_is_the_chart_to_second_order(name: str, pole: Pole) -> None:
    random = np.random.default_rng(1)
    one, other = told_twice(name, pole, random.uniform(0.3, 1, 500), random.uniform(0, 2 * pi, 500))
    size = np.abs(jets(*other)[1]).max()
    np.testing.assert_allclose(jets(*one)[0], jets(*other)[0], atol=1e-15, rtol=1e-14)
    for a, b in zip(curvatures(*one), curvatures(*other), strict=True):
        np.testing.assert_allclose(a, b, rtol=2e-13, atol=2e-13 / min(1, size))


@pytest.mark.cases(13)
@pytest.mark.parametrize(("name", "pole"), POLES, ids=str)
@pytest.mark.parametrize("form", ["mixed", "block"])
def test_a_change_of_chart_leaves_no_trace(name: str, pole: Pole, form: str) -> None:
    random = np.random.default_rng(3)
    s, theta = random.uniform(INNER, 1, COUNT), random.uniform(0, 2 * pi, COUNT)
    one, other = told_twice(name, pole, s, theta)
    assert form in forms_of(other[0])
    assert change(one, other, form, seed=5) < 1e-12


def test_the_poles_of_a_sphere_are_points_like_any_other() -> None:
    for pole, height in (("pole_v_min", -0.3), ("pole_v_max", 0.3)):
        cap = features(CHARTS["sphere"])[pole].shape
        at = np.array([[0.0, 0.3], [0.0, -0.2]])
        normals, mean, gauss = curvatures(cap, at)
        np.testing.assert_allclose(jets(cap, at)[0][0], [0, 0, height], atol=1e-16)
        np.testing.assert_allclose(normals * 0.3, jets(cap, at)[0], atol=1e-15)
        np.testing.assert_allclose(mean, 1 / 0.3, rtol=1e-14)
        np.testing.assert_allclose(gauss, 1 / 0.09, rtol=1e-14)


@pytest.mark.parametrize("name", CHARTS)
def test_hand_over_overlaps_and_leads_back(name: str) -> None:
    """The chart hands over at a smaller distance from the pole than the cap hands back."""
    shape, parts = CHARTS[name], features(CHARTS[name])
    assert shape.chart is not None
    assert is_composite(shape)
    assert not is_convex(shape)
    assert parts["sheet"].shape.chart == replace(shape.chart, poles=NO_POLES)
    for pole in poles_of(shape.chart):
        (disc,) = parts[f"pole_{pole.name}"].conditions
        (bound,) = (each for each in parts["sheet"].conditions if each.next == f"pole_{pole.name}")
        assert (disc.kind, disc.numbers, disc.next) == ("disc", (1.0,), "sheet")
        index, sign, value = bound.numbers
        end = shape.chart.domain[pole.axis][pole.end]
        assert (index, sign) == (pole.axis, 1 - 2 * pole.end)
        assert abs(value - end) == pytest.approx(INNER * cap_at(shape, pole).radius)


def test_an_open_end_of_a_revolution_leads_to_its_rim() -> None:
    parts = features(CHARTS["dish"])
    (end,) = [each for each in parts["sheet"].conditions if not (each.next or "").startswith("pole")]
    rim = parts["rim_v_max"]
    slope = np.array([1, 2 / 3 * 0.4 - 4 * 0.4**3])
    assert (end.numbers, end.next) == ((1.0, -1.0, 0.4), "rim_v_max")
    assert rim.shape.parameters == (("radius", 0.4),)
    assert rim.shape.pose.position == pytest.approx((0.0, 0.0, 0.4**2 / 3 - 0.4**4))
    assert [each.next for each in rim.conditions] == ["sheet", None]
    for wing in rim.conditions:
        np.testing.assert_allclose(wing.numbers, -slope / np.linalg.norm(slope), atol=1e-11)


def test_other_open_ends_lead_nowhere() -> None:
    ends = [each for each in features(CHARTS["twisted"])["sheet"].conditions if each.next is None]
    assert [each.numbers for each in ends] == [(0.0, -1.0, 1.0)]


def test_a_cavity_turns_chart_and_caps_round() -> None:
    shape = build.revolution("R*cos(t)", "R*sin(t)", domain=HALF, parameters={"R": 0.3}, cavity=True)
    assert all(feature.shape.cavity for feature in features_of(shape).features)


@pytest.mark.parametrize(
    ("r", "z", "found"),
    [
        ("t", "-t", "derivative 1 along v depends on u as at a tip"),
        ("t", "t**3", "derivative 3 along v"),
        ("t + t**2", "t**2", "derivative 2 along v"),
        ("t**2", "t**4", "no tangent plane at first order"),
        ("sqrt(t)", "t", "no power series"),
        ("t", "abs(t)", "no power series"),
        ("t", "exp(-(t/0.0001)**2)", "not its power series"),
    ],
)
def test_a_pole_that_is_not_smooth_is_refused(r: str, z: str, found: str) -> None:
    with pytest.raises(SceneError, match=found):
        features_of(build.revolution(r, z, domain=[0, 1]))


def test_the_degree_of_a_cap_follows_from_its_parameters() -> None:
    assert [cap_degree(3 * len(cap_exponents(degree))) for degree in range(1, 20)] == [*range(1, 20)]
    cap = features(CHARTS["waves"])["pole_u_min"].shape
    assert cap_degree(len(cap.parameters)) == DEGREE
