"""Outlines of involute teeth: closest points against dense sampling, two gears against the law of gearing."""

from __future__ import annotations

from functools import cache
from math import cos, radians

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.geometry.test_outline_features import gear_teeth
from tests.oracles.test_closest_features import RADIUS, gaps_at
from tests.running import library_of, run

TEETH, MODULE = 9, 0.02
BALL = RADIUS / 10  # fits into the gaps between the teeth
TORQUE, BASE = 0.3, 0.09 * cos(radians(25))  # N m, m: load and base circle of the wheel


def gear(kind: str) -> Shape:
    pieces = gear_teeth(TEETH, MODULE)
    length = {"length": 0.1} if kind == "outline_wall" else {}
    return make.shape(kind, pieces=pieces, repeat=TEETH, **length)


@cache
def beside(kind: str) -> Library:
    bodies = [
        make.dynamic("gear", gear(kind), mass=1.0, inertia=[1e-3] * 3),
        make.dynamic("ball", make.sphere(BALL), mass=1.0, inertia=[1e-3] * 3, position=[1.0, 0.0, 0.0]),
    ]
    contact = [{"between": ["gear", "ball"]}]
    return library_of(make.scene(kind, bodies, contact=contact, gravity=[0, 0, 0]))


def to_outline(shape: Shape, at: np.ndarray) -> float:
    """The distance of a point of the plane to the outline: the best of 60 points of a piece, polished."""
    assert shape.outline is not None
    best = np.inf
    for side in shape.outline:
        t = np.linspace(0, 1, 60)
        far = [float(np.hypot(*(np.array(side.piece.point(each)) - at))) for each in t]
        k = int(np.argmin(far))
        if far[k] > best + 0.005:
            continue
        ends = (t[max(k - 1, 0)], t[min(k + 1, 59)])
        polished = minimize_scalar(
            lambda each, piece=side.piece: float(np.hypot(*(np.array(piece.point(each)) - at))),
            bounds=ends, method="bounded", options={"xatol": 1e-10},
        )  # fmt: skip
        best = min(best, *far, float(polished.fun))
    return best


def is_inside(shape: Shape, at: np.ndarray) -> bool:
    assert shape.outline is not None
    x, y = np.array([s.piece.point(t) for s in shape.outline for t in np.arange(40) / 40]).T - at[:, None]
    turns = np.arctan2(x * np.roll(y, -1) - y * np.roll(x, -1), x * np.roll(x, -1) + y * np.roll(y, -1))
    return bool(abs(turns.sum()) > np.pi)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["outline_wall", "outline"])
def test_a_ball_is_as_far_from_a_gear_as_from_the_nearest_point_of_its_outline(kind: str) -> None:
    """On flanks, tips, roots and corners, at any pose of both."""
    shape, library = gear(kind), beside(kind)
    rng, n = np.random.default_rng(17), 0
    while n < 25:
        at = rng.uniform(-0.14, 0.14, 2)
        gap = to_outline(shape, at) - BALL
        if is_inside(shape, at) or not gap > 1e-5:
            continue
        n += 1
        p, turn = rng.normal(size=3), Rotation.random(random_state=rng)
        centre = p + turn.apply([*at, 0.01 if kind == "outline_wall" else 0.0])
        found = gaps_at(library, [(p, turn), (centre, Rotation.identity())])
        assert found[:1] == pytest.approx([gap], abs=2e-9), at


def test_two_gears_turn_at_the_ratio_of_their_teeth_under_load() -> None:
    """w_2 z_2 = -w_1 z_1 at every instant.

    The flanks press with load/(base radius) along the common tangent of the base circles, whose direction is
    that of the pressure angle.
    """
    path = run("gears", Accuracy.balanced())
    pinion, wheel = (path.body_names.index(name) for name in ("pinion", "wheel"))
    assert path.outcome.name == "DONE"
    assert path.is_trusted, path.doubts
    assert path.incomplete_searches == path.unfollowed_minima == 0
    assert np.abs(path.w[:, wheel, 2] * 18 + path.w[:, pinion, 2] * 12).max() < 1e-9
    assert np.nanmin(path.gap) > -1e-12
    pressing = path.force > 1e-9
    assert (pressing.sum(axis=1) >= 1).all()
    assert np.abs(path.force.sum(axis=1) - TORQUE / BASE).max() < 1e-9 * TORQUE / BASE
    normals = path.normals[pressing]
    assert np.abs(np.abs(normals[:, 1]) - cos(radians(25))).max() < 1e-12
    carried = {int(k) for k in path.feature_pair[pressing]}
    assert len(carried) >= 12
