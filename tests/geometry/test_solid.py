"""Mass properties by the divergence theorem against closed forms, and what has no volume."""

from __future__ import annotations

from math import gamma, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modelgen.errors import SceneError
from modelgen.geometry.closed_form_moments import surface_moments
from modelgen.geometry.mass_properties import mass_properties, moments_by_quadrature
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Chart, Shape

LENGTH = st.floats(1e-3, 1e2)


def shape(kind: str, cavity: bool = False, **parameters: float) -> Shape:
    return Shape(kind, tuple(parameters.items()), cavity)


def close(
    found: tuple[float, np.ndarray, np.ndarray], mass: float, moments: list[float], size: float
) -> None:
    assert found[0] == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(found[1], 0, atol=1e-13 * size)
    np.testing.assert_allclose(found[2], np.diag(moments), rtol=1e-12, atol=1e-13 * mass * size**2)


@settings(max_examples=25)
@given(LENGTH, LENGTH, LENGTH, st.floats(1, 1e4))
def test_ellipsoid(a: float, b: float, c: float, density: float) -> None:
    mass = density * 4 / 3 * pi * a * b * c
    moments = [mass / 5 * (p * p + q * q) for p, q in ((b, c), (a, c), (a, b))]
    close(mass_properties(shape("ellipsoid", a=a, b=b, c=c), density), mass, moments, max(a, b, c))


@settings(max_examples=25)
@given(LENGTH, st.floats(0.05, 0.95))
def test_torus(major: float, ratio: float) -> None:
    minor = ratio * major
    mass = 2 * pi**2 * major * minor**2
    across, along = mass * (major**2 / 2 + 5 / 8 * minor**2), mass * (major**2 + 3 / 4 * minor**2)
    found = mass_properties(shape("torus", major=major, minor=minor), 1.0)
    close(found, mass, [across, across, along], major + minor)


@pytest.mark.cases(3)
@pytest.mark.parametrize(
    ("p", "q"), [(2.0, 2.0), (2.1, 2.3), (2.5, 3.0), (4.0, 4.0), (8.0, 2.0), (16.0, 16.0)]
)
def test_superellipsoid(p: float, q: float) -> None:
    """Volume of the ball of the norm: base area by Beta functions, then layers (1 - z^q)^(2/q)."""
    found = mass_properties(shape("superellipsoid", a=1.0, b=0.8, c=0.5, p=p, q=q), 1.0)
    base = 4 * gamma(1 + 1 / p) ** 2 / gamma(1 + 2 / p)
    layers = 2 * gamma(1 + 1 / q) * gamma(1 + 2 / q) / gamma(1 + 3 / q)
    assert found[0] == pytest.approx(0.4 * base * layers, rel=1e-10)
    assert np.all(np.linalg.eigvalsh(found[2]) > 0)


@settings(max_examples=3)
@given(LENGTH, st.floats(0.2, 5), st.floats(0.2, 5), st.floats(2, 6), st.floats(2, 6))
def test_closed_forms_equal_the_quadrature(size: float, b: float, c: float, p: float, q: float) -> None:
    """Of round shapes both are exact; a superellipsoid has points without curvature, where the rule loses."""
    shapes = {
        shape("sphere", radius=size): 1e-12,
        shape("ellipsoid", a=size, b=b * size, c=c * size): 1e-12,
        shape("torus", major=size, minor=min(b, 1 / b) * size): 1e-12,
        shape("superellipsoid", a=size, b=b * size, c=c * size, p=p, q=q): 1e-6,
    }
    for each, tolerance in shapes.items():
        closed, rule = surface_moments(each), moments_by_quadrature(each)
        assert closed is not None
        assert closed.volume == pytest.approx(rule.volume, rel=tolerance)
        np.testing.assert_allclose(np.diag(closed.second), np.diag(rule.second), rtol=tolerance)
        atol = tolerance * closed.second.max()
        np.testing.assert_allclose(closed.second, rule.second, rtol=0, atol=atol)


def user(x: str, y: str, z: str, cavity: bool = False, v_max: float = pi / 2) -> Shape:
    components = [parse_expression(text, ("u", "v", "s")) for text in (x, y, z)]
    chart = Chart((components[0], components[1], components[2]), ((-pi, pi), (-pi / 2, v_max)), (True, False))
    return Shape("chart", (("s", 0.5),), cavity, chart=chart)


def test_a_user_chart_sheared_and_shifted() -> None:
    """The ball sheared by x -> x + s z and moved: volume kept, centre moved, moments by the linear map."""
    found = mass_properties(user("cos(v)*cos(u) + s*sin(v) + 2", "cos(v)*sin(u) - 1", "sin(v)"), 3.0)
    volume = 4 / 3 * pi
    shear = np.array([[1, 0, 0.5], [0, 1, 0], [0, 0, 1]])
    second = volume / 5 * shear @ shear.T
    assert found[0] == pytest.approx(3 * volume, rel=1e-12)
    np.testing.assert_allclose(found[1], [2, -1, 0], atol=1e-12)
    np.testing.assert_allclose(found[2], 3 * (np.trace(second) * np.eye(3) - second), atol=1e-11)


def test_an_inward_chart_is_a_cavity_of_the_outward_one() -> None:
    outward = user("cos(v)*cos(u)", "cos(v)*sin(u)", "sin(v)")
    inward = user("cos(v)*sin(u)", "cos(v)*cos(u)", "sin(v)", cavity=True)
    assert mass_properties(inward, 1.0)[0] == pytest.approx(mass_properties(outward, 1.0)[0], rel=1e-12)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (shape("plane"), "no finite volume"),
        (shape("cylinder", radius=1.0), "no finite volume"),
        (shape("sphere", cavity=True, radius=1.0), "outside of it"),
        (user("cos(v)*sin(u)", "cos(v)*cos(u)", "sin(v)"), "outside of it"),
        (user("cos(v)*cos(u)", "cos(v)*sin(u)", "sin(v)", v_max=0.5), "not closed"),
    ],
)
def test_what_bounds_no_material_is_refused(bad: Shape, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        mass_properties(bad, 1.0)
