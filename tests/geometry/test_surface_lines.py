"""Lines on surfaces: the surface's own points, with one coordinate held."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.errors import SceneError
from modelgen.scene import python_scenes as build
from modelgen.scene.scene_types import Shape
from modelgen.scene.surface_lines import CHARTS
from tests.geometry.joins import jets

SURFACES: dict[str, dict[str, object]] = {
    "plane": {},
    "sphere": {"radius": 0.6},
    "ellipsoid": {"semi_axes": [1.0, 0.7, 0.5]},
    "torus": {"major": 1.0, "minor": 0.4},
    "cylinder": {"radius": 0.6},
    "cone": {"half_angle": 0.5},
    "paraboloid": {"radii": [1.3, -0.8]},
    "chart": {
        "x": "u", "y": "v", "z": "h*sin(k*u)*cos(v)", "domain": [[-2, 2], [-1, 1]],
        "parameters": {"h": 0.1, "k": 3},
    },
}  # fmt: skip
OPEN = ("plane", "cylinder", "cone", "paraboloid")


def points(shape: Shape, t: np.ndarray) -> np.ndarray:
    return jets(shape, t[None])[0]


@pytest.mark.parametrize("kind", SURFACES)
@pytest.mark.parametrize("held", ["u", "v"])
def test_a_line_has_the_points_of_its_surface(kind: str, held: str) -> None:
    surface = build.shape(kind, **SURFACES[kind])
    t = np.linspace(-0.9, -0.2, 7)
    line = build.surface_line({"kind": kind, **SURFACES[kind]}, domain=[-1, 0], **{held: -0.3})
    at = np.array([np.full(7, -0.3), t] if held == "u" else [t, np.full(7, -0.3)])
    np.testing.assert_allclose(points(line, t), jets(surface, at)[0], atol=1e-15)
    assert line.kind == "curve"
    assert line.parameters == surface.parameters


def test_every_surface_has_its_test() -> None:
    assert {*CHARTS, "chart"} == set(SURFACES)


@pytest.mark.parametrize(
    ("kind", "held", "domain", "periodic"),
    [
        ("torus", "u", (-np.pi, np.pi), True),
        ("sphere", "u", (-np.pi / 2, np.pi / 2), False),
        ("sphere", "v", (-np.pi, np.pi), True),
        ("cylinder", "v", (-np.pi, np.pi), True),
        ("chart", "u", (-1.0, 1.0), False),
    ],
)
def test_without_a_domain_the_line_runs_all_the_way(
    kind: str, held: str, domain: tuple[float, float], periodic: bool
) -> None:
    curve = build.surface_line({"kind": kind, **SURFACES[kind]}, **{held: 0.2}).curve
    assert curve is not None
    assert (curve.domain, curve.periodic) == (domain, periodic)


def test_a_parallel_of_a_sphere_is_a_circle() -> None:
    x = points(build.surface_line({"kind": "sphere", "radius": 2}, v="pi/6"), np.linspace(-3, 3, 9))
    np.testing.assert_allclose(np.linalg.norm(x[:, :2], axis=1), np.sqrt(3), rtol=1e-15)
    np.testing.assert_allclose(x[:, 2], 1, rtol=1e-15)


TIMED = SURFACES["chart"] | {"parameters": {"h": 0.1, "k": 3, "t": 1}}


@pytest.mark.parametrize(
    ("keys", "found"),
    [
        ({"surface": {"kind": "torus", "major": 1, "minor": 0.4}}, "neither u nor v"),
        ({"surface": {"kind": "torus", "major": 1, "minor": 0.4}, "u": 0, "v": 0}, "'u' and 'v' together"),
        ({"surface": {"kind": "torus", "major": 1, "minor": 2}, "u": 0}, "major 1 is not larger"),
        ({"surface": {"kind": "plane"}, "u": 0}, "no domain, while v has no ends"),
        ({"surface": {"kind": "plane"}, "u": 0, "domain": [1, 0]}, "the first number must be the smaller"),
        ({"surface": {"kind": "helix", "radius": 1}, "u": 0}, "allowed are plane"),
        ({"surface": {"kind": "chart", **TIMED}, "u": 0}, "a parameter named 't'"),
        ({"surface": {"kind": "plane", "cavity": True}, "u": 0}, "unknown key 'cavity'"),
        ({"surface": 3, "u": 0}, "a table is allowed"),
    ],
)
def test_what_is_no_line_is_refused(keys: dict[str, object], found: str) -> None:
    with pytest.raises(SceneError, match=found):
        build.shape("surface_line", **keys)
