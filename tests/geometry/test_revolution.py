"""Surfaces of revolution: the exterior is outside, the curvature is that of the closed form."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.errors import SceneError
from modelgen.geometry.mass_properties import mass_properties
from modelgen.geometry.shape_features import is_composite
from modelgen.geometry.surface_kernel import surface_kernel
from modelgen.scene import python_scenes as build
from modelgen.scene.scene_types import Shape
from tests.geometry.joins import curvatures, jets, kind_of

HALF = (-pi / 2, pi / 2)
RING = build.revolution(
    "major + minor*cos(t)", "minor*sin(t)", domain=(-pi, pi), periodic=True,
    parameters={"major": 1.0, "minor": 0.4},
)  # fmt: skip


def outwards(shape: Shape, at: tuple[float, float]) -> np.ndarray:
    _, n = surface_kernel(kind_of(shape))(list(at), [value for _, value in shape.parameters])
    return np.array(n)[:, 0]


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_a_turned_circle_is_the_torus(u: float, v: float) -> None:
    at = np.array([[u], [v]])
    torus = build.torus(1.0, 0.4)
    np.testing.assert_allclose(jets(RING, at)[0], jets(torus, at)[0], atol=1e-15)
    for a, b in zip(curvatures(RING, at), curvatures(torus, at), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-13)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("r", "z", "domain", "periodic"),
    [
        ("cos(t)/3", "sin(t)/3", HALF, False),
        ("2 + cos(t)", "sin(t)", (-pi, pi), True),
        ("0.5", "t", (-1, 1), False),
        ("cosh(t)/2", "t", (-1, 1), False),
    ],
)  # fmt: skip
def test_the_exterior_is_outside_whichever_way_the_profile_runs(
    r: str, z: str, domain: tuple[float, float], periodic: bool, turned: bool
) -> None:
    texts = [text.replace("t", "(-t)") for text in (r, z)] if turned else [r, z]
    shape = build.revolution(*texts, domain=domain, periodic=periodic)
    for u in (-2.0, 0.1, 2.5):
        x, _, _ = jets(shape, np.array([[u], [0.0]]))
        assert outwards(shape, (u, 0.0))[:2] @ x[0, :2] > 0


def test_a_level_annulus_looks_up_and_a_bowl_down() -> None:
    """Away from the axis is below a bowl; its inside is the cavity."""
    for domain in ((0.2, 0.5), (-0.5, -0.2)):
        r = "t" if domain[0] > 0 else "-t"
        assert outwards(build.revolution(r, "0", domain=domain), (0.3, sum(domain) / 2))[2] == 1
    assert outwards(build.revolution("t", "t**2", domain=(0, 1)), (0.3, 0.5))[2] < 0
    assert outwards(build.revolution("t", "t**2", domain=(0, 1), cavity=True), (0.3, 0.5))[2] > 0


def test_mass_of_a_closed_profile() -> None:
    ball = build.revolution("R*cos(t)", "R*sin(t)", domain=HALF, parameters={"R": 0.3})
    mass, centre, inertia = mass_properties(ball, 2.0)
    assert mass == pytest.approx(2 * 4 / 3 * pi * 0.3**3, rel=1e-14)
    np.testing.assert_allclose(centre, 0, atol=1e-16)
    np.testing.assert_allclose(inertia, np.eye(3) * 0.4 * mass * 0.09, atol=1e-15)
    assert mass_properties(RING, 1.0)[0] == pytest.approx(2 * pi**2 * 0.4**2, rel=1e-14)


def test_ends_on_the_axis_are_poles() -> None:
    def poles(domain: tuple[float, float], r: str = "cos(t)") -> tuple[bool, bool]:
        chart = build.revolution(r, "sin(t)", domain=domain).chart
        assert chart is not None
        return chart.poles[1]

    assert poles(HALF) == (True, True)
    assert poles((-pi / 2, 0.3)) == (True, False)
    assert poles((-1.0, 1.0)) == (False, False)
    assert not is_composite(RING)


def test_a_revolution_is_a_chart_with_the_users_own_names() -> None:
    chart = RING.chart
    assert chart is not None
    assert RING.kind == "chart"
    assert RING.parameters == (("major", 1.0), ("minor", 0.4))
    assert chart.components[0].text == "(major + minor*cos(v))*cos(u)"


@pytest.mark.parametrize(
    ("keys", "found"),
    [
        ({"r": "t", "z": "1", "domain": [-1, 1]}, "r = -1 at t = -1"),
        ({"r": "1 - t**2", "z": "t", "domain": [-1, 2]}, "r = .* at t ="),
        ({"r": "t**2", "z": "t", "domain": [-1, 1]}, "r = 0 at t = 0"),
        ({"r": "cos(t)", "z": "sin(t)", "domain": [0, 1.5707]}, "9.63e-05 m from the axis"),
        ({"r": "1", "z": "2", "domain": [0, 1]}, "do not depend on t"),
        ({"r": "u", "z": "t", "domain": [0, 1]}, "unknown name 'u'"),
        ({"r": "1 + t", "z": "t", "domain": [1, 0]}, "the first number must be the smaller"),
        ({"r": "2 + cos(t)", "z": "t", "domain": [0, 1], "periodic": True}, "at the two ends of v"),
        ({"r": "1 + log(t)", "z": "t", "domain": [0, 1]}, "no finite value at t = 0"),
        ({"r": "1", "z": "t", "domain": [0, 1], "parameters": {"v": 1}}, "the name 'v'"),
        ({"r": "().__class__", "z": "t", "domain": [0, 1]}, "construct"),
    ],
)  # fmt: skip
def test_what_is_no_profile_is_refused(keys: dict[str, object], found: str) -> None:
    with pytest.raises(SceneError, match=found):
        build.shape("revolution", **keys)
