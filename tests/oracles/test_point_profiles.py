"""Runs on profiles through measured points: a cam under a ball, and a turned body that comes to rest."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import fsolve

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from tests.geometry.test_point_splines import chords, measured
from tests.oracles.pieces import TABLE
from tests.running import library_of

BALL, TURNS = 0.02, 2.5


@pytest.mark.slow
def test_a_ball_on_a_cam_through_points_follows_it_for_several_turns() -> None:
    """Its centre is a point of the spline plus the radius along the normal, on the line that guides it."""
    angles = 2 * np.pi * (np.arange(20) + 0.3 * np.random.default_rng(1).uniform(-1, 1, 20)) / 20
    points = np.column_stack([0.1 * np.cos(angles) * (1 + 0.1 * np.cos(2 * angles)), 0.1 * np.sin(angles)])
    around = np.vstack([points, points[:1]])
    spline = CubicSpline(chords(around), around, bc_type="periodic")

    def off(unknown: np.ndarray, angle: float) -> np.ndarray:
        t, height = unknown
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s], [s, c]])
        tangent = turn @ spline(t, nu=1)
        normal = np.array([tangent[1], -tangent[0]]) / np.linalg.norm(tangent)
        return turn @ spline(t) + BALL * normal - [0.0, height]

    nearest = min(np.linspace(0, 1, 400), key=lambda t: abs(spline(t)[0]) - spline(t)[1])
    start = fsolve(off, [nearest, spline(nearest)[1] + BALL], args=(0.0,), xtol=1e-12)
    cam = make.driven(
        "cam", make.extrusion(0.04, points=points.tolist(), smooth=True),
        path={"position": [0, 0, 0], "rotation_vector": [0, 0, "2*pi*t"]},
    )  # fmt: skip
    rate = 1e-6
    ahead, behind = (fsolve(off, start, args=(sign * 2 * np.pi * rate,), xtol=1e-12) for sign in (1, -1))
    ball = make.dynamic(
        "ball", make.sphere(BALL), density=1000.0, position=[0.0, float(start[1]), 0.005],
        velocity=[0.0, float(ahead[1] - behind[1]) / (2 * rate), 0.0],
    )  # fmt: skip
    guide = {
        "kind": "prismatic", "between": ["world", "ball"], "rotation": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
        "stiffness": 1000.0,
    }  # fmt: skip
    scene = make.scene(
        "cam", [cam, ball], gravity=[0, -200, 0], contact=[{"between": ["cam", "ball"]}], joint=[guide]
    )
    path = simulate(library_of(scene), until=TURNS, accuracy=Accuracy.tight(), samples=100)
    k = path.body_names.index("ball")
    expected, unknown = [], start
    for t in np.linspace(0, TURNS, 1001):
        unknown = fsolve(off, unknown, args=(2 * np.pi * t,), xtol=1e-12)
        expected.append(unknown[1])
    assert path.outcome.name == "DONE"
    assert path.is_trusted, path.doubts
    assert [event.kind for event in path.events if event.kind != "touch-down"] == []
    assert np.abs(path.p[:, k, 1] - expected[::10]).max() < 1e-9
    assert path.eta[:, 0].min() > -0.5
    assert path.eta[:, 0].max() < 1.5


@pytest.mark.slow
def test_a_body_turned_from_points_comes_to_rest_on_a_plane() -> None:
    points = measured(3, 12, closed=False) - [0.2, 0.0]
    points[0, 0] = points[-1, 0] = 0.0
    body = make.dynamic(
        "body", make.shape("revolution", points=points.tolist()), density=500.0, position=[0, 0, 0.3],
        rpy=[0.4, 0.3, 0.0],
    )  # fmt: skip
    scene = make.scene("drop", [TABLE, body], contact=[{"between": ["body", "table"], "restitution": 0.3}])
    path = simulate(library_of(scene), until=1.0, samples=100)
    assert path.outcome.name == "DONE"
    assert path.incomplete_searches == 0
    assert path.energy[-1] < path.energy[0]
    assert np.nanmin(path.gap) > -1e-9
