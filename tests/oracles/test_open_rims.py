"""The circles at which a surface of revolution is open are edges: bodies rest on them and roll over them."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.pieces import TABLE, ball, ran, rotations

SPOUT = 0.03  # radius of the narrow end, at z = 0, m
BALLS = (0.035, 0.05)  # radii, m
CONTACT = [{"between": ["ball", "seat"]}]
POINTS = [
    [0.03, 0.0], [0.04, 0.003], [0.05, 0.007], [0.06, 0.012], [0.07, 0.02], [0.08, 0.03], [0.09, 0.05],
]  # fmt: skip

SPOUTS = {
    "cone": make.revolution("0.03 + 2*t", "t", domain=(0.0, 0.1), cavity=True),
    "reversed": make.revolution("0.03 - 2*t", "-t", domain=(-0.1, 0.0), cavity=True),
    "washer": make.revolution("t", "0", domain=(0.03, 0.1)),
    "trumpet": make.revolution("0.03 + 0.1*t", "0.05*t**2", domain=(0.0, 1.0), cavity=True),
    "trunk": make.revolution("0.03 - 0.3*t", "-t", domain=(0.0, 0.05)),  # a frustum without its ends
    "points": make.shape("revolution", points=POINTS, cavity=True),
    "chart": make.chart(
        "(0.03 + 2*v)*cos(u)", "(0.03 + 2*v)*sin(u)", "v", domain=((-pi, pi), (0.0, 0.1)),
        periodic=(True, False), cavity=True,
    ),
}  # fmt: skip


def from_spout(path: Trajectory) -> np.ndarray:
    """The distance (n,) m of the centre of the ball from the edge."""
    x = path.p[:, 1].astype(float)
    return np.hypot(np.hypot(x[:, 0], x[:, 1]) - SPOUT, x[:, 2])


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", SPOUTS)
@pytest.mark.parametrize("radius", BALLS)
def test_a_ball_rests_on_the_edge_of_a_spout(name: str, radius: float) -> None:
    height = sqrt(radius**2 - SPOUT**2)
    path = ran([make.fixed("seat", SPOUTS[name]), ball("ball", [0, 0, height + 0.02], radius)], 0.3, CONTACT)
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-10
    np.testing.assert_allclose(path.p[-1, 1], [0, 0, height], atol=1e-10)


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", ["washer", "trumpet", "trunk", "points"])
def test_a_ball_that_circles_in_a_spout_keeps_its_distance_from_the_edge(name: str) -> None:
    radius = 0.05
    start = ball("ball", [0.015, 0.0, 0.05], radius, velocity=[0.0, 0.3, 0.0])
    path = ran([make.fixed("seat", SPOUTS[name]), start], 0.3, CONTACT, samples=300)
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-9
    assert radius - from_spout(path).min() < 1e-9
    assert "rim_v_" in " ".join(path.feature_pair_names[k] for k in np.unique(path.feature_pair) if k >= 0)


CUP = make.revolution("t", "3*t**2", domain=(0.0, 0.1), cavity=True)  # its rim at z = 0.03
ON_CUP: dict[str, tuple[Shape, float]] = {  # a body, and its height above the rim, m
    "box": (make.box(0.3, 0.3, 0.02), 0.01),
    "can": (make.cylinder(0.15, 0.02), 0.01),
    "torus": (make.torus(0.1, 0.02), 0.02),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ON_CUP)
def test_bodies_lie_on_the_rim_of_a_cup(name: str) -> None:
    shape, above = ON_CUP[name]
    off = 0.0 if name == "torus" else 0.01
    body = make.dynamic("ball", shape, density=500.0, position=[off, 0.0, 0.03 + above + 1e-3])
    path = ran([make.fixed("seat", CUP), body], 0.1, CONTACT)
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-10
    np.testing.assert_allclose(path.p[-1, 1], [off, 0, 0.03 + above], atol=1e-9)


@pytest.mark.parametrize("lean", [0.0, 0.1])
def test_a_cup_turned_over_stands_on_its_rim(lean: float) -> None:
    inertia = [1e-2] * 3
    cup = make.dynamic(
        "cup", CUP, mass=1.0, inertia=inertia, position=[0, 0, 0.06], rpy=[pi - lean, 0.0, 0.0]
    )
    path = ran([TABLE, cup], 0.5, [{"between": ["table", "cup"]}])
    assert path.outcome is Outcome.DONE
    assert path.penetration_max < 1e-9
    np.testing.assert_allclose(path.p[-1, 1, 2], 0.03, atol=1e-9)
    np.testing.assert_allclose(rotations(path, 1)[-1, 2, 2], -1.0, atol=1e-12)


def dome_of(radius: float) -> Body:
    """A shallow dome z = -x^2 - y^2 that ends at this radius."""
    return make.fixed("seat", make.revolution("t", "-t**2", domain=(0.0, radius)))


def test_a_ball_rolls_over_a_rim_as_over_an_edge() -> None:
    """It is on the dome, then on its rim, about which its centre turns until the normal force is zero."""
    radius, end = 0.05, 0.1
    start = ball("ball", [0.0, 0.0, radius], radius, velocity=[0.3, 0.0, 0.0])
    path = ran([dome_of(end), start], 0.6, CONTACT, samples=600)
    x, v = path.p[:, 1].astype(float), path.v[:, 1].astype(float)
    arm = x - np.array([end, 0.0, -end * end])
    on_rim = np.array(
        ["rim" in path.feature_pair_names[k] if k >= 0 else False for k in path.feature_pair[:, 0]]
    )
    held = on_rim & (path.force[:, 0] > 1e-6)
    assert path.outcome is Outcome.DONE
    assert held.sum() > 20
    np.testing.assert_allclose(np.linalg.norm(arm[held], axis=1), radius, atol=1e-9)
    left = np.flatnonzero(held)[-1]  # the last sample before the centripetal force exceeds the weight's share
    assert abs(v[left] @ v[left] - 9.81 * arm[left, 2]) < 0.05 * (v[left] @ v[left])
