"""A body that starts in the material of another one is refused, however deep it is; one beside it is not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import pytest

from modelgen.errors import SimulationError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import ball, ran

RADII = (0.02, 0.2)  # of the ball, m: deep in the material, and across its surface
LEVEL = ((-1.0, 1.0), (-1.0, 1.0))
GRID = [-1.0, -0.3, 0.3, 1.0]


@dataclass(frozen=True)
class Container:
    """A shape, a place in its material and one outside of it, each farther from it than the small balls."""

    shape: Shape
    inside: Sequence[float]
    outside: Sequence[float]


def both(name: str, build: object, inside: Sequence[float], outside: Sequence[float]) -> dict[str, Container]:
    """A solid, and the cavity of its form, whose outside is its inside."""
    assert callable(build)
    return {
        name: Container(build(), inside, outside),
        f"hollow {name}": Container(build(cavity=True), outside, inside),
    }


WAIST = ("0.5*sin(t)*(1.2 + 0.5*cos(2*t))", "-0.5*cos(t)")
COMMON = {
    **both("sphere", lambda **k: make.sphere(0.5, **k), (0.1, 0.05, 0.2), (0.1, 0.05, 0.8)),
    **both("torus", lambda **k: make.torus(0.6, 0.3, **k), (0.63, 0.1, 0.05), (0.05, 0.1, 0.05)),
    **both("box", lambda **k: make.box(1.0, 0.8, 0.6, **k), (0.1, 0.05, 0.03), (0.1, 0.05, 0.7)),
    **both("cylinder", lambda **k: make.cylinder(0.4, 0.8, **k), (0.1, 0.05, 0.03), (0.7, 0.05, 0.03)),
    **both(
        "funnel", lambda **k: make.revolution("0.3 + 0.5*t", "t", domain=(0.0, 1.0), **k),
        (0.05, 0.1, 0.5), (0.9, 0.1, 0.5),
    ),
    **both(
        "funnel, on its axis", lambda **k: make.revolution("0.3 + 0.5*t", "t", domain=(0.0, 1.0), **k),
        (0.0, 0.0, 0.5), (0.9, 0.1, 0.5),
    ),
}  # fmt: skip
OTHERS = {
    "tube": Container(make.tube(0.8, 0.3, 0.6), (0.55, 0.05, 0.03), (0.0, 0.02, 0.0)),
    "height field": Container(
        make.height_field(GRID, GRID, [[0.01 * (i * j % 3) for j in range(4)] for i in range(4)]),
        (0.1, 0.05, -0.3), (0.1, 0.05, 0.3),
    ),
    **both("plane", make.plane, (0.1, 0.05, -0.3), (0.1, 0.05, 0.3)),
    **both("ellipsoid", lambda **k: make.ellipsoid(0.5, 0.4, 0.3, **k), (0.1, 0.05, 0.1), (0.1, 0.05, 0.7)),
    **both("endless cylinder", lambda **k: make.cylinder(0.4, **k), (0.1, 0.05, 0.3), (0.7, 0.05, 0.3)),
    **both("cone", lambda **k: make.cone(0.5, **k), (0.05, 0.05, -0.6), (0.6, 0.05, -0.4)),
    **both("paraboloid", lambda **k: make.paraboloid(0.3, 0.4, **k), (0.6, 0.05, 0.1), (0.05, 0.05, 0.6)),
    **both(
        "waist", lambda **k: make.revolution(*WAIST, domain=(0.0, pi), **k), (0.05, 0.1, 0.04), (0, 0.8, 0)
    ),
    **both(
        "chart", lambda **k: make.chart("u", "v", "0.1*u*v", domain=LEVEL, **k), (0, 0, -0.3), (0, 0, 0.3)
    ),
    "superellipsoid": Container(make.superellipsoid(0.5, 0.4, 0.3, 3, 3), (0.1, 0.05, 0.1), (0.1, 0.05, 0.7)),
    "capsule": Container(make.capsule(0.4, 0.5), (0.1, 0.05, 0.03), (0.7, 0.05, 0.03)),
    "frustum": Container(make.frustum(0.5, 0.3, 0.6), (0.1, 0.05, 0.03), (0.7, 0.05, 0.03)),
    "dome": Container(make.dome(0.5, 0.4), (0.1, 0.05, 0.2), (0.1, 0.05, 0.7)),
    "half torus": Container(make.half_torus(0.6, 0.3), (0.1, 0.6, 0.05), (0.1, 0.02, 0.05)),
    "polyhedron": Container(
        make.polyhedron([[1, 0, 0], [-0.5, 0.8, 0], [-0.5, -0.8, 0], [0, 0, 1], [0, 0, -0.6]]),
        (0.05, 0.05, 0.1), (0.9, 0.05, 0.6),
    ),
    "prism": Container(
        make.shape("extrusion", points=[[0, 0], [1, 0], [1, 0.8], [0.5, 0.3], [0, 0.8]], length=0.6),
        (0.5, 0.15, 0.05), (0.5, 0.9, 0.05),
    ),
    "smooth prism": Container(
        make.shape("extrusion", x="0.5*cos(t)", y="0.4*sin(t)", domain=[0, 2 * pi], length=0.6),
        (0.1, 0.05, 0.05), (0.8, 0.05, 0.05),
    ),
    "spline": Container(
        make.bspline([[[x, y, 0.1 * x * y] for y in GRID] for x in GRID]),
        (0.1, 0.05, -0.3), (0.1, 0.05, 0.3),
    ),
}  # fmt: skip
CONTAINERS = COMMON | OTHERS
CASES = [*COMMON, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)]


def start(name: str, at: Sequence[float], radius: float) -> None:
    seat = make.fixed("seat", CONTAINERS[name].shape)
    ran([seat, ball("ball", [float(x) for x in at], radius)], 1e-3, [{"between": ["ball", "seat"]}])


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("radius", RADII)
def test_a_ball_in_the_material_is_refused(name: str, radius: float) -> None:
    said = r"contact\[0\] \(contact 'ball-seat.*'\): the bodies interpenetrate at the start by .* m; at most "
    remedy = "leave cavity = true out of" if "hollow" in name else "set cavity = true in"
    with pytest.raises(SimulationError, match=rf"{said}.*move 'ball' by .*; if 'ball' belongs .*{remedy}"):
        start(name, CONTAINERS[name].inside, radius)


@pytest.mark.parametrize("name", CASES)
def test_a_ball_outside_of_it_is_not(name: str) -> None:
    start(name, CONTAINERS[name].outside, 0.02)


@pytest.mark.parametrize("apart", [0.9, 1.1, 2.0, 4.0])
def test_the_hole_of_a_link_is_no_material(apart: float) -> None:
    """Two links of a chain; the axes of their tubes are `apart` times the diameter from each other."""
    major, minor = 0.05, 0.005
    link = make.fixed("link", make.torus(major, minor))
    other = make.dynamic(
        "other", make.torus(major, minor), density=1000.0, position=[2 * (major - minor * apart), 0.0, 0.0],
        rpy=[pi / 2, 0.0, 0.0],
    )  # fmt: skip
    contact = [{"between": ["link", "other"]}]
    if apart < 1:
        with pytest.raises(SimulationError, match=r"interpenetrate at the start by 0\.001 m"):
            ran([link, other], 1e-3, contact)
    else:
        ran([link, other], 1e-3, contact)
