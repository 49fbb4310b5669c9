"""Free forms as they are written: what is wrong is named with its place."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.errors import SceneError
from modelgen.scene import python_scenes as build
from modelgen.scene.free_shapes import FREE_SHAPES
from modelgen.scene.read import read_text

NET = [[[i, j, 0] for j in range(4)] for i in range(5)]
WIRE = [[i, 0, 0] for i in range(5)]
GRID = [0, 1, 2, 3]
FLAT = [[0] * 4] * 4


@pytest.mark.parametrize(
    ("kind", "keys", "found"),
    [
        ("bspline", {"points": []}, "points: 0 control points in a direction"),
        ("bspline", {"points": NET[:3]}, "3 control points in a direction; degree 3 needs at least 4"),
        ("bspline", {"points": [*NET[:4], NET[0][:2]]}, r"points\[4\]: a row of 2"),
        ("bspline", {"points": NET, "degree": 2}, "degree: .*from 3 to 5"),
        ("bspline", {"points": NET, "degree": 4}, "degree 4 needs at least 5"),
        ("bspline", {"points": NET, "knots": [[], [0, 1]]}, r"knots\[1\]: 2 knots; 4 control points .*8"),
        ("bspline", {"points": NET, "knots": [[0, 0, 0, 0, 2, *[1] * 4], []]}, r"\[0\]\[5\]: the knot 1"),
        ("bspline", {"points": [[[0, 0]] * 4] * 4}, "a list of 3"),
        ("bspline", {"points": [[[0, 0, float("nan")]] * 4] * 4}, "a number from"),
        ("bspline", {"points": [[[0, 0, 0]] * 101] * 100}, "10100 points; at most 10000"),
        ("bspline_curve", {"points": WIRE, "knots": [0, 0, 0, 0, 1, 1, 1, 1, 1]}, "the knot 1 after 1"),
        ("bspline_curve", {"points": WIRE, "periodic": True, "knots": [0, 1, 2]}, "need 6"),
        ("height_field", {"x": GRID[:3], "y": GRID, "heights": FLAT[:3]}, "x: 3 values; at least 4"),
        ("height_field", {"x": [0, 1, 1, 2], "y": GRID, "heights": FLAT}, r"x\[2\]: 1 after 1"),
        ("height_field", {"x": GRID, "y": GRID, "heights": FLAT[:2]}, "heights: 2 rows"),
        ("height_field", {"x": GRID, "y": GRID, "heights": [[0] * 3] * 4}, r"heights\[0\]: a row of 3"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(kind: str, keys: dict[str, Any], found: str) -> None:
    with pytest.raises(SceneError, match=found):
        build.shape(kind, **keys)


@pytest.mark.parametrize(
    ("poles", "periodic", "found"),
    [
        (["u_min"], [False, False], r"poles\[0\]: a pole at u_min with periodic = \[false, false\]"),
        (["u_min"], [True, True], "v turns about the pole and is periodic, u is not"),
        (["w_min"], [False, True], "allowed are u_min, u_max, v_min, v_max"),
        (["u_max"], [False, True], "at a pole x, y, z are one point"),
    ],
)
def test_a_pole_is_a_point_that_the_other_coordinate_turns_about(
    poles: list[str], periodic: list[bool], found: str
) -> None:
    with pytest.raises(SceneError, match=found):
        build.chart(
            "sin(u)*cos(v)*sin(v)**2", "sin(u)*sin(v)", "sin(v)**2*cos(u) + sin(u)**2", poles=poles,
            periodic=periodic, domain=[["-pi", "pi"] if periodic[0] else [0, 1], [0, "2*pi"]],
        )  # fmt: skip


@pytest.mark.parametrize("kind", FREE_SHAPES)
@given(
    value=st.none() | st.booleans() | st.floats() | st.text(max_size=5) | st.lists(st.integers(), max_size=3)
)
def test_nothing_but_a_scene_error_comes_of_nonsense(kind: str, value: object) -> None:
    keys = {field.key: value for field in FREE_SHAPES[kind].fields if field.required}
    with pytest.raises(SceneError):
        build.shape(kind, **keys)


SCENE = """
[[body]]
name = "hill"
motion = "fixed"
[[body.shape]]
kind = "height_field"
x = [0, 1, 2, 3]
y = [0, 1, 2, 3]
heights = [[0, 0, 0, 0], [0, 1, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0]]
[[body.shape]]
kind = "revolution"
r = "R*cos(t)"
z = "R*sin(t)"
domain = ["-pi/2", "pi/2"]
parameters = { R = 0.3 }
[[body.shape]]
kind = "surface_line"
surface = { kind = "torus", major = 1, minor = 0.2 }
u = 0
name = "meridian"
"""


def test_free_shapes_are_read_from_scene_files() -> None:
    shapes = read_text(SCENE).bodies[0].shapes
    assert [shape.name for shape in shapes] == ["height_field", "revolution", "meridian"]
    assert [shape.kind for shape in shapes] == ["height_field", "chart", "curve"]
