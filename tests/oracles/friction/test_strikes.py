"""Impacts with friction, and laws that hold wherever there is friction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, rotations, solid, times

speeds = st.floats(-3, 3)
restitutions = st.just(0.0) | st.floats(1e-3, 1)  # between them a rebound may be slower than a touch-down
AXES = (0.12, 0.09, 0.07)


@settings(max_examples=12, deadline=None)
@given(st.tuples(speeds, speeds), st.tuples(*[st.floats(-30, 30)] * 3), restitutions, st.floats(0.02, 1.0))
def test_a_thrown_ball_strikes_sliding_or_gripping(
    v: tuple[float, float], w: tuple[float, float, float], e: float, mu: float
) -> None:
    thrown = ball("ball", [0, 0, 0.2], velocity=[*v, -1.5], angular_velocity=list(w))
    contact = [{"between": ["ball", "table"], "friction": mu, "restitution": e}]
    down = np.sqrt(1.5**2 + 2 * G * 0.1)
    path = ran([thrown, TABLE], (down - 1.5) / G + 1e-9, contact, samples=1)
    slip = np.array([v[0] - 0.1 * w[1], v[1] + 0.1 * w[0]])
    size = np.linalg.norm(slip)
    push = min(mu * (1 + e) * down, 2 / 7 * size)
    assert len(path.events) == 1
    assert path.v[-1, 0, :2] == pytest.approx(np.array(v) - push * slip / max(size, 1e-300), abs=1e-7)
    assert path.v[-1, 0, 2] == pytest.approx(e * down, abs=1e-7)
    assert imbalance(path) < 1e-12


@pytest.mark.parametrize("seed", range(8))
def test_a_blow_with_resistance_to_spin_and_rolling_is_on_its_cones_to_rounding(seed: int) -> None:
    """Impulses on the edge of their cones, against what slips, spins and rolls after the blow."""
    mu, spinning, rolling, e, r, inertia = 0.2, 2e-3, 1e-3, 0.7, 0.1, 0.4 * 0.1**2
    rng = np.random.default_rng(seed)
    v, w = np.append(rng.uniform(-3, 3, 2), -0.3), rng.uniform(-40, 40, 3)
    hit = ball("ball", [0, 0, r], velocity=list(v), angular_velocity=list(w))
    contact = {
        "between": ["ball", "table"], "friction": mu, "restitution": e,
        "spinning_resistance": spinning, "rolling_resistance": rolling,
    }  # fmt: skip
    path = ran([hit, TABLE], 1e-3, [contact], gravity=[0, 0, 0], samples=1)
    push, turn = path.v[-1, 0] - v, inertia * (path.w[-1, 0] - w)
    torque = turn - np.cross([0, 0, -r], push)  # about the point that was struck
    slip = path.v[-1, 0, :2] + np.cross(path.w[-1, 0], [0, 0, -r])[:2]
    along = [
        (push[:2], slip, mu),
        (torque[:2], path.w[-1, 0, :2], rolling),
        (torque[2:], path.w[-1, 0, 2:], spinning),
    ]
    assert push[2] == pytest.approx((1 + e) * 0.3, rel=1e-14)
    for impulse, motion, coefficient in along:
        edge = -coefficient * push[2] * motion / np.linalg.norm(motion)
        assert np.linalg.norm(impulse - edge) <= 4e-15


def thrown(turn: Rotation) -> list[Body]:
    tilted = (turn * Rotation.from_rotvec([0.4, 0.3, 0])).as_quat()[[3, 0, 1, 2]]
    egg = solid(
        "egg", AXES, position=[0, 0, 0.2], quaternion=tilted.tolist(),
        velocity=turn.apply([2.0, 0.8, 0.0]).tolist(), angular_velocity=turn.apply([2.0, -3.0, 6.0]).tolist(),
    )  # fmt: skip
    return [egg, TABLE]


def bounced(turn: Rotation) -> Trajectory:
    contact = [
        {"between": ["egg", "table"], "friction": {"static": 0.2, "kinetic": 0.15}, "restitution": 0.4}
    ]
    return ran(thrown(turn), 2.5, contact, samples=60)


def test_turning_the_scene_about_the_normal_changes_nothing() -> None:
    turn = Rotation.from_rotvec([0, 0, 0.7])
    here, there = bounced(Rotation.identity()), bounced(turn)
    assert {"impact", "touch-down", "slip-stop"} <= {e.kind for e in here.events}
    assert [e.kind for e in here.events] == [e.kind for e in there.events]
    assert [e.t for e in here.events] == pytest.approx([e.t for e in there.events], abs=1e-9)
    assert np.abs(turn.apply(here.p[:, 0]) - there.p[:, 0]).max() < 1e-9
    assert np.abs(turn.as_matrix() @ rotations(here, 0) - rotations(there, 0)).max() < 1e-8
    assert np.abs(turn.apply(here.friction[:, 0]) - there.friction[:, 0]).max() < 1e-6


def test_friction_stays_within_its_cone_against_slip_and_takes_energy() -> None:
    path = bounced(Rotation.identity())
    size, slip = np.linalg.norm(path.friction[:, 0], axis=1), np.linalg.norm(path.slip[:, 0], axis=1)
    assert (size <= 0.2 * path.force[:, 0] * (1 + 1e-9) + 1e-9).all()
    slips = slip > 1e-6
    assert slips.any()
    assert size[slips] == pytest.approx(0.15 * path.force[slips, 0], rel=1e-9)
    power = np.einsum("ni,ni->n", path.friction[:, 0], path.slip[:, 0])
    assert power[slips] == pytest.approx(-size[slips] * slip[slips], rel=1e-9)
    assert (np.diff(path.energy) < 1e-12).all()
    assert imbalance(path) < 1e-11


@pytest.mark.parametrize(("spin", "makes"), [(3.0, True), (0.0, False)])
def test_an_impact_that_makes_energy_is_named(spin: float, makes: bool) -> None:
    """A rod strikes with one end; Newton's restitution with friction (Kane and Levinson, Dynamics, 1985)."""
    angle = 0.8
    rod = make.dynamic(
        "rod", make.point(0.5, 0.0, 0.0), mass=1.0, inertia=[0.01, 1 / 12, 1 / 12], rpy=[0, angle, 0],
        position=[-0.5 * np.cos(angle), 0, 0.5 * np.sin(angle) + 1e-3],
        velocity=[0.0, 0.0, -1.0], angular_velocity=[0, spin, 0],
    )  # fmt: skip
    contact = [{"between": ["rod", "table"], "friction": 0.7, "restitution": 0.9}]
    path = ran([rod, TABLE], 0.004, contact, samples=1, gravity=[0, 0, 0])
    gain = path.energy[-1] - path.energy[0]
    named = [warning for warning in path.warnings if f"made {gain:.2e} J at the contact rod-table" in warning]
    assert times(path, "impact") != []
    assert imbalance(path) < 1e-12
    assert (gain > 0) == makes
    assert len(named) == makes
