"""Shapes of the user's own are checked: regular inside, their exterior outside; weak places are declared."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from modelgen.errors import SceneError
from modelgen.geometry.shape_warnings import declared_limits
from modelgen.geometry.user_shape_checks import check_user_shape
from modelgen.scene import python_scenes as build
from modelgen.scene.scene_types import Shape

HALF, TURN = (-pi / 2, pi / 2), (0.0, 2 * pi)
BALL = ("cos(u)*cos(v)", "cos(u)*sin(v)", "sin(u)")


def ball(x: str = BALL[0], poles: tuple[str, ...] = ("u_min", "u_max"), **keys: object) -> Shape:
    return build.chart(
        x, *BALL[1:], domain=[HALF, TURN], periodic=[False, True], poles=[*poles], name="ball", **keys
    )


def ring(turn: float) -> Shape:
    """The control net of a torus, its second direction running either way."""
    phi, theta = np.meshgrid(np.arange(8) * pi / 4, turn * np.arange(6) * pi / 3, indexing="ij")
    out = 1 + 0.3 * np.cos(theta)
    points = np.stack([out * np.cos(phi), out * np.sin(phi), 0.3 * np.sin(theta)], axis=-1)
    return build.bspline(points.tolist(), periodic=[True, True])


FINE = [
    build.chart("u", "v", "u*v", domain=[(-1, 1), (-1, 1.1)]),
    build.chart("u + v", "v", "0.1*u**3", domain=[(-1, 1), (-1, 1.1)]),
    ball("-cos(u)*cos(v)"),
    ball("-cos(u)*cos(v)", cavity=True),
    build.revolution("cos(t)", "sin(t)", domain=HALF),
    build.curve("t", "t**3", "0", domain=(-1, 1)),
    build.bspline_curve([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]]),
    build.sphere(1),
    ring(1),
]  # fmt: skip


@pytest.mark.parametrize("shape", FINE)
def test_what_is_regular_passes_without_a_word(shape: Shape) -> None:
    assert check_user_shape(shape) == ()


def test_poles_that_are_not_declared_are_named() -> None:
    lower, upper = check_user_shape(ball("-cos(u)*cos(v)", poles=()))
    assert "shape 'ball': c_u x c_v vanishes at u = -1.5708" in lower
    assert 'poles = ["u_max"]' in upper


@pytest.mark.parametrize(
    ("shape", "found"),
    [
        (build.chart("u", "v**3", "v**2", domain=[(-1, 1), (-1, 1.1)]), "vanishes at u = .*, v = .*e-1"),
        (build.chart("u**3", "v**3", "0", domain=[(-1, 1.2), (-1, 1.1)]), "c_u x c_v vanishes"),
        (build.chart("u + v", "2*u + 2*v", "u + v", domain=[(0, 1), (0, 1)]), "c_u x c_v vanishes"),
        (ball(), "exterior side is the inside .volume -4"),
        (ring(-1), "exterior side is the inside"),
        (build.curve("t**2", "t**3", "0", domain=(-1, 1.1)), "stands still at t = "),
        (build.bspline_curve([[0, 0, 0]] * 4), "stands still"),
        (build.bspline([[[i, 0, 0] for _ in range(5)] for i in range(5)]), "no tangent plane in cell_"),
    ],
)  # fmt: skip
def test_what_is_not_is_refused(shape: Shape, found: str) -> None:
    with pytest.raises(SceneError, match=found):
        check_user_shape(shape)


def test_the_faces_of_a_solid_are_checked() -> None:
    fold = {"name": "fold", "shape": {"kind": "chart", "x": "u", "y": "v**3", "z": "v**2",
            "domain": [[-1, 1], [-1, 1.1]]}}  # fmt: skip
    with pytest.raises(SceneError, match="c_u x c_v vanishes"):
        check_user_shape(build.shape("solid", face=[fold]))


def test_exponents_that_take_curvature_away_are_declared() -> None:
    def texts(p: float, q: float) -> str:
        return " ".join(declared_limits(build.superellipsoid(1, 1, 1, p, q)))

    assert texts(2, 2) == ""
    assert "vanishes where x = 0, that along y where y = 0" in texts(4, 2)
    assert "no limit at x = y = 0" in texts(4, 2)
    assert "both vanish at x = y = 0" in texts(2, 4)
    assert "no limit" not in texts(4, 4)
    assert "p = 2.5: the rate of change" in texts(2.5, 4)
    assert declared_limits(build.sphere(1)) == ()
