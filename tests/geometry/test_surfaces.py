"""A surface told three ways: equation, chart and support map agree, with two derivatives."""

from __future__ import annotations

from functools import cache
from itertools import product
from math import inf, isinf

import casadi as ca
import mpmath as mp
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from modelgen.geometry.curves import CURVES
from modelgen.geometry.frames import tangent_frame
from modelgen.geometry.surface_catalogue import SURFACES, exterior_sign, surface_of
from modelgen.geometry.surface_kernel import surface_kernel
from modelgen.model import ShapeKind
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Chart, Shape
from modelgen.scene.shape_catalogue import SHAPES

LENGTHS = {
    "plane": (), "sphere": (0.6,), "ellipsoid": (1.0, 0.7, 0.5), "torus": (1.0, 0.4), "cylinder": (0.6,),
    "cone": (0.5,), "conical_side": (0.6, 0.3),
    "paraboloid": (1.3, -0.8), "superellipsoid": (1.0, 0.8, 0.6, 2.6, 3.3),
    "bezier": tuple(np.random.default_rng(1).uniform(-1, 1, 48)),
    "bezier_graph": (0.3, 0.7, -0.2, 1.3, 0.5, *np.random.default_rng(2).uniform(-0.3, 0.3, 15)),
    "round_cap": (-1.0, 0.7, -0.3, 0.1, 0.2, 0.4, -0.2, 0.1),
    "cap": tuple(np.random.default_rng(3).uniform(-1, 1, 45)),
}  # fmt: skip
PIECES = {
    "conical_side",
    "bezier",
    "bezier_graph",
    "cap",
    "round_cap",
    "bezier_curve",
}  # of frusta and free forms; not written in scenes
IMPLICIT = [name for name, surface in SURFACES.items() if surface.implicit]
SUPPORTED = [name for name, surface in SURFACES.items() if surface.support]
INSIDE = st.tuples(st.floats(-0.95, 0.95), st.floats(-0.95, 0.95))


def coordinates(name: str, at: tuple[float, float]) -> np.ndarray:
    """A point of the chart's domain, or of [-1, 1] where it is infinite."""
    ends = [
        (max(low, -1.0), min(high, 1.0)) if isinf(low) else (low, high) for low, high in SURFACES[name].domain
    ]
    return np.array(
        [(low + high) / 2 + a * (high - low) / 2 for a, (low, high) in zip(at, ends, strict=True)]
    )


@cache
def jet_function(name: str) -> ca.Function:
    symbol = ca.SX.sym("uv", 2)
    values = SURFACES[name].jet(symbol, ca.SX(ca.DM(list(LENGTHS[name]))))
    return ca.Function("jet", [symbol], [ca.densify(x) for x in (values.x, values.first, values.second)])


def jet(name: str, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    x, first, second = (np.array(value) for value in jet_function(name)(uv))
    return x[:, 0], first, second


@cache
def equation_function(name: str, lengths: tuple[float, ...]) -> ca.Function:
    symbol = ca.SX.sym("x", 3)
    form = SURFACES[name].implicit
    assert form is not None
    phi = form(symbol, ca.SX(ca.DM(list(lengths))))
    hessian = phi.isotropic * ca.SX.eye(3) + phi.matrix
    return ca.Function("phi", [symbol], [ca.densify(entry) for entry in (phi.value, phi.gradient, hessian)])


def equation(name: str, x: np.ndarray, lengths: tuple[float, ...]) -> tuple[float, np.ndarray, np.ndarray]:
    value, gradient, bent = (np.array(entry) for entry in equation_function(name, lengths)(x))
    return value.item(), gradient[:, 0], bent


def test_the_catalogue_is_that_of_the_scene() -> None:
    assert set(SURFACES) - PIECES == {name for name, spec in SHAPES.items() if not (spec.curve or spec.point)}
    assert set(CURVES) - PIECES == {name for name, spec in SHAPES.items() if spec.curve}
    assert all(len(SHAPES[name].parameters) == len(LENGTHS[name]) for name in set(SURFACES) - PIECES)


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", IMPLICIT)
@given(at=INSIDE)
def test_the_chart_solves_the_equation_to_second_order(name: str, at: tuple[float, float]) -> None:
    """phi(c) = 0, phi' c_a = 0, c_a phi'' c_b + phi' c_ab = 0, and c_u x c_v points along phi'."""
    x, first, second = jet(name, coordinates(name, at))
    value, gradient, hessian = equation(name, x, LENGTHS[name])
    size = np.linalg.norm(gradient)
    assert abs(value) < 1e-12 * size
    np.testing.assert_allclose(gradient @ first, 0, atol=1e-12 * size)
    bent = [first[:, a] @ hessian @ first[:, b] for a, b in ((0, 0), (0, 1), (1, 1))]
    np.testing.assert_allclose(bent + gradient @ second, 0, atol=1e-11 * size)
    assert np.cross(first[:, 0], first[:, 1]) @ gradient > 0


@pytest.mark.parametrize("name", IMPLICIT)
def test_the_hessian_is_the_derivative_of_the_gradient(name: str) -> None:
    x = np.array([0.43, -0.31, 0.22])
    _, _, hessian = equation(name, x, LENGTHS[name])
    for k, step in product(range(3), (1e-5,)):
        shift = step * np.eye(3)[k]
        above, below = equation(name, x + shift, LENGTHS[name]), equation(name, x - shift, LENGTHS[name])
        np.testing.assert_allclose((above[1] - below[1]) / (2 * step), hessian[:, k], atol=1e-8)
        assert (above[0] - below[0]) / (2 * step) == pytest.approx(
            equation(name, x, LENGTHS[name])[1][k], abs=1e-8
        )


@pytest.mark.parametrize("exponents", [(2.0, 2.0), (2.0, 4.0), (4.0, 2.0), (2.5, 3.0), (8.0, 8.0)])
@pytest.mark.parametrize("x", [x for x in product((0.0, 0.5, -0.5), repeat=3) if any(x)])
def test_a_superellipsoid_is_defined_at_zero_coordinates(
    exponents: tuple[float, float], x: tuple[float, float, float]
) -> None:
    value, gradient, hessian = equation("superellipsoid", np.array(x), (1.0, 0.8, 0.6, *exponents))
    assert np.isfinite([value, *gradient, *hessian.ravel()]).all()
    assert all(gradient[k] == 0 for k in range(3) if x[k] == 0)


def test_a_superellipsoid_of_exponents_two_is_an_ellipsoid() -> None:
    x = np.array([0.3, -0.4, 0.2])
    value, gradient, hessian = equation("superellipsoid", x, (1.0, 0.7, 0.5, 2.0, 2.0))
    half, slope, bent = equation("ellipsoid", x, (1.0, 0.7, 0.5))
    np.testing.assert_allclose(
        [value, *gradient, *hessian.ravel()], 2 * np.array([half, *slope, *bent.ravel()]), atol=1e-14
    )


@cache
def support_function(name: str) -> ca.Function:
    """n, m -> the point, and how far height and second derivative are from those of the point."""
    lengths = ca.SX(ca.DM(list(LENGTHS[name])))
    n, m = ca.SX.sym("n", 3), ca.SX.sym("m", 3)
    form = SURFACES[name].support
    assert form is not None
    support = form(n, lengths)
    point = support.core + support.offset * n
    derivative = m.T @ ca.jtimes(support.core, n, m)
    wanted = [point, n.T @ support.core - support.height, derivative - support.form(m), derivative]
    return ca.Function("support", [n, m], [ca.densify(entry) for entry in wanted])


@pytest.mark.parametrize("name", SUPPORTED)
@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(at=INSIDE)
def test_the_support_map_inverts_the_normal(name: str, at: tuple[float, float]) -> None:
    """At the normal of a point of the convex hull stands that point; heights and derivatives follow."""
    uv = coordinates(name, at)
    if name == "torus":
        uv[1] *= 0.45  # the outer half
    x, first, _ = jet(name, uv)
    normal = np.cross(first[:, 0], first[:, 1])
    normal /= np.linalg.norm(normal)
    assume(name != "superellipsoid" or np.abs(normal).min() > 1e-3)  # flat where a coordinate is zero
    tangential = np.cross(normal, [0.3, 0.5, -0.2])
    values = support_function(name)(normal, tangential)
    found, height_error, form_error, turned = (np.array(value) for value in values)
    np.testing.assert_allclose(found[:, 0], x, atol=1e-9)
    assert abs(height_error.item()) < 1e-14
    assert abs(form_error.item()) < 1e-9 * (1 + abs(turned.item()))


@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda n: sum(x * x for x in n) > 1e-3))
def test_tangents_complete_any_normal_to_a_rotation(n: tuple[float, float, float]) -> None:
    unit = np.array(n) / np.linalg.norm(n)
    symbol = ca.SX.sym("n", 3)
    T = np.array(ca.Function("T", [symbol], [tangent_frame(symbol)])(unit))
    frame = np.column_stack([T, unit])
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=4e-15)
    assert np.linalg.det(frame) == pytest.approx(1.0)


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", [name for name in SURFACES if name != "plane"])
@given(at=INSIDE)
def test_no_point_lies_beyond_the_bounding_radius(name: str, at: tuple[float, float]) -> None:
    x, _, _ = jet(name, coordinates(name, at))
    assert np.linalg.norm(x) <= SURFACES[name].bounding(LENGTHS[name]) * (1 + 1e-12)


def bean() -> ShapeKind:
    names = ("u", "v", "r")
    x, y, z = (
        parse_expression(t, names)
        for t in ("r*cos(v)*cos(u)", "r*cos(v)*sin(u)", "0.5*r*sin(v) + 0.1*r*cos(u)")
    )
    chart = Chart((x, y, z), ((-3.2, 3.2), (-1.5, 1.5)), (True, False))
    return ShapeKind("bean", "chart", ("r",), chart=chart)


@given(at=INSIDE)
def test_a_user_chart_is_bounded_by_its_samples(at: tuple[float, float]) -> None:
    x = surface_kernel(bean())([3.2 * at[0], 1.5 * at[1]], [0.4])[0]
    radius = surface_of(bean()).bounding([0.4])
    assert float(ca.norm_2(x)) < radius < inf


def test_a_cavity_turns_the_normal_and_folding_removes_the_parameters() -> None:
    kind = ShapeKind("egg", "ellipsoid", ("a", "b", "c"))
    hollow = ShapeKind("hollow", "ellipsoid", ("a", "b", "c"), cavity=True, folded=(1.0, 0.7, 0.5))
    x, n = surface_kernel(kind)([0.3, 0.2], [1.0, 0.7, 0.5])
    y, inward = surface_kernel(hollow)([0.3, 0.2], [])
    np.testing.assert_allclose(np.array(x), np.array(y), atol=1e-16)
    np.testing.assert_allclose(np.array(n), -np.array(inward), atol=1e-16)
    assert exterior_sign(Shape("ellipsoid", cavity=True)) == -1


NEAR = [0.0, *(10.0**-k for k in range(1, 13))]


@cache
def bent_support() -> ca.Function:
    """n, m, lengths -> the second derivative of the support function of a superellipsoid along m."""
    n, m, p = ca.SX.sym("n", 3), ca.SX.sym("m", 3), ca.SX.sym("p", 5)
    support = SURFACES["superellipsoid"].support
    assert support is not None
    at = support(n, p)
    return ca.Function("bent", [n, m, p], [at.form(m), at.slope(m)])


def reach_along(n: list[mp.mpf], lengths: tuple[float, ...]) -> mp.mpf:
    """The support function of a superellipsoid."""
    p, q = (mp.mpf(each) / (mp.mpf(each) - 1) for each in lengths[3:])
    x, y, z = (abs(mp.mpf(a) * each) for a, each in zip(lengths, n, strict=False))
    return ((x**p + y**p) ** (q / p) + z**q) ** (1 / q)


@pytest.mark.parametrize(
    "exponents", [(2.0, 2.0), (2.5, 2.5), (3.0, 3.0), (4.0, 4.0), (4.0, 2.0), (2.0, 4.0)]
)
@pytest.mark.parametrize("pole", range(3))
def test_support_of_a_superellipsoid_bends_as_it_should_near_its_poles(
    pole: int, exponents: tuple[float, float]
) -> None:
    """The second derivative by differences in 100 digits; nothing bends where the normal rests."""
    lengths = (1.0, 0.8, 0.6, *exponents)
    with mp.workdps(100):
        for off in NEAR:
            n = np.roll([1.0, off, 0.7 * off], pole)
            form, slope = bent_support()(n, np.zeros(3), lengths)
            assert float(form) == 0.0
            assert not np.array(slope).any()
            m = np.roll([-0.3 * off, 0.4, 0.5], pole)
            form = float(bent_support()(n, m, lengths)[0])
            assert np.isfinite(form)
            if off == 0.0:
                continue
            step = mp.mpf(off) / mp.mpf(10) ** 15
            there = [
                reach_along([mp.mpf(a) + k * step * mp.mpf(b) for a, b in zip(n, m, strict=True)], lengths)
                for k in (-1, 0, 1)
            ]
            assert form == pytest.approx(float((there[0] - 2 * there[1] + there[2]) / step**2), rel=1e-9)
