"""Scenes of blows, against their references: a thrown ellipsoid, a cradle, a measured toss."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from tests.oracles.friction.bouncing import Blow, bounced, bouncing_ellipsoid
from tests.oracles.friction.cradle import Cradle
from tests.oracles.friction.cube_toss import HALF_WIDTH, MU, corners, errors, in_flight, toss
from tests.oracles.friction.extrapolation import Array
from tests.oracles.friction.impact import quarter_swing
from tests.oracles.friction.on_plane import P, rotation_of
from tests.oracles.pieces import imbalance, rotations, times
from tests.running import run

BOTH = pytest.mark.parametrize(("accuracy", "off"), [("balanced", 1e-9), ("tight", 1e-12)])
ROW = Cradle(0.0401 * np.arange(5), 0.3, 0.02, 0.3 + 4e-5 / (0.25 * 0.3))


@cache
def thrown() -> tuple[Array, list[Blow]]:
    return bounced(*bouncing_ellipsoid(0.2), np.linspace(0, 1.2, 4), 0.8)


@cache
def swung() -> tuple[Array, list[tuple[float, int]]]:
    return ROW.run(np.array([-0.7, 0, 0, 0, 0]), np.linspace(0, 2, 5))


@pytest.mark.slow
@BOTH
def test_a_bouncing_ellipsoid_follows_its_reference(accuracy: str, off: float) -> None:
    path = run("bouncing_ellipsoid", Accuracy.named(accuracy), samples=3)
    states, blows = thrown()
    assert times(path, "impact") == pytest.approx([float(blow.t) for blow in blows], abs=off)
    assert len(path.events) == len(blows) == 7
    assert np.abs(path.p[:, 1] - states[:, P]).max() < off
    assert np.abs(rotations(path, 1) - [rotation_of(x) for x in states]).max() < 10 * off
    assert path.energy[0] - path.energy[-1] == pytest.approx(
        float(sum(blow.taken for blow in blows)), abs=off
    )
    assert imbalance(path) < off


@BOTH
def test_a_newton_cradle_follows_pendulums_that_strike(accuracy: str, off: float) -> None:
    path = run("newton_cradle", Accuracy.named(accuracy), samples=4)
    states, blows = swung()
    assert [event.kind for event in path.events] == ["impact"] * len(blows)
    assert [event.t for event in path.events] == pytest.approx([t for t, _ in blows], abs=off)
    named = [event.contact for event in path.events]
    assert named == [f"ball_{pair}-ball_{pair + 1}" for _, pair in blows]
    places = np.array([ROW.centres(state[:5]) for state in states])
    assert np.abs(path.p[:, :5, [0, 2]] - places).max() < off
    assert np.ptp(path.energy) < off


def test_its_last_ball_flies_as_far_as_the_first_came() -> None:
    path = run("newton_cradle", Accuracy.tight())
    first = path.events[0]
    assert first.t == pytest.approx(quarter_swing(0.7, ROW.reduced), abs=1e-4 / 1.17)
    angle = np.arctan2(path.p[:, 4, 0] - ROW.pivots[4], -path.p[:, 4, 2])
    assert angle.max() == pytest.approx(0.7, abs=1e-3)
    between = (path.t > path.events[3].t) & (path.t < path.events[4].t)
    assert np.abs(path.v[between, :4]).max() < 2e-3


def test_a_cube_toss_goes_as_measured() -> None:
    measured = toss(0)
    frames = len(measured.t)
    path = run("cube_toss", Accuracy.balanced(), samples=frames - 1)
    turned = Rotation.from_quat(np.roll(path.quaternion[:, 1], -1, axis=1))
    p, rotation = in_flight(measured)
    flies = path.t < path.events[0].t
    assert flies.sum() > 10
    assert np.abs(path.p[flies, 1] - p[flies]).max() < 1e-12
    assert (rotation.inv() * turned).magnitude()[flies].max() < 1e-12
    distance, angle = errors(measured, path.p[:, 1], turned)
    assert distance < 0.02
    assert angle < np.radians(11)
    low = corners(path.p[:, 1], turned)[..., 2].min(axis=1)
    assert np.abs(low.min()) < 1e-9
    assert path.p[-1, 1, 2] == pytest.approx(HALF_WIDTH, abs=1e-12)


def test_a_cube_toss_slows_by_friction_within_its_cone() -> None:
    path = run("cube_toss", Accuracy.balanced())
    assert (np.diff(path.energy) < 1e-9).all()
    assert imbalance(path) < 1e-11
    size = np.linalg.norm(path.friction, axis=-1)
    assert (size <= MU * path.force + 1e-9).all()
    # it slides on its face at last, and its face carries m g and mu m g
    assert path.patch_force[-1].sum() == pytest.approx(0.37 * 9.81, rel=1e-9)
    assert np.linalg.norm(path.patch_friction[-1].sum(axis=0)) <= MU * 0.37 * 9.81 * (1 + 1e-9)
