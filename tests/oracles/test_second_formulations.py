"""A peg in a hole, a coin in a bowl, a helix on a cylinder: each against one that knows no contact kernel."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from tests.oracles.implied import Equations, Slid, Slider
from tests.oracles.pieces import rotations
from tests.running import run

PEG = 800.0 * np.pi * 0.04**2 * 0.2  # kg
SIZE = {"peg_in_hole": 0.2, "coin_in_bowl": 0.05, "helix_on_cylinder": 0.1}  # m


def rim(height: float) -> Equations:
    """A rim of the peg in the hole about x: |point|^2 in yz is the hole's, and stationary along the rim."""

    def equations(p: ca.SX, R: ca.SX, s: ca.SX) -> ca.SX:
        point = p + R @ ca.vertcat(0.04 * ca.cos(s), 0.04 * ca.sin(s), height)
        tangent = R @ ca.vertcat(-ca.sin(s), ca.cos(s), 0)
        return ca.vertcat((ca.sumsqr(point[1:]) - 0.06**2) / 0.12, ca.dot(point[1:], tangent[1:]))

    return equations


def coin(p: ca.SX, R: ca.SX, s: ca.SX) -> ca.SX:
    """The rim point t is the point (x, y) of the bowl, and the rim is tangent there."""
    x, y, t = ca.vertsplit(s)
    point = p + 0.05 * R @ ca.vertcat(ca.cos(t), ca.sin(t), 0)
    tangent, normal = R @ ca.vertcat(-ca.sin(t), ca.cos(t), 0), ca.vertcat(-x / 0.3, -y / 0.25, 1)
    return ca.vertcat(point - ca.vertcat(x, y, x * x / 0.6 + y * y / 0.5), 0.05 * ca.dot(normal, tangent))


def helix(p: ca.SX, R: ca.SX, s: ca.SX) -> ca.SX:
    """The wire point t is the point (angle, y) of the bar about y, and the wire is tangent there."""
    angle, y, t = ca.vertsplit(s)
    normal = ca.vertcat(ca.sin(angle), 0, ca.cos(angle))
    point = p + R @ ca.vertcat(0.15 + 0.1 * ca.cos(t), 0.1 * ca.sin(t), 0.1 * t)
    tangent = R @ ca.vertcat(-ca.sin(t), ca.cos(t), 1)
    return ca.vertcat(point - 0.05 * normal - ca.vertcat(0, y, 0), 0.1 * ca.dot(normal, tangent))


ACROSS, ALONG = (3 * 0.04**2 + 0.2**2) / 12, 0.04**2 / 2  # moments of the peg by its mass, m^2
SLIDERS = {
    "peg_in_hole": Slider(
        PEG, [PEG * ACROSS, PEG * ACROSS, PEG * ALONG], [(rim(0.1), [0.3]), (rim(-0.1), [-0.3])]
    ),
    "coin_in_bowl": Slider(0.1, [6.25e-5, 6.25e-5, 1.25e-4], [(coin, [0.0, 0.0, -np.pi / 2])]),
    "helix_on_cylinder": Slider(0.3, [0.002, 0.004, 0.004], [(helix, [0.0, 0.0, 0.0])]),
}  # fmt: skip


@cache
def both(name: str) -> tuple[Trajectory, Slid]:
    path = run(name, Accuracy.tight(), samples=40)
    spin = rotations(path, 1)[0].T @ path.w[0, 1]
    other = SLIDERS[name].run(path.p[0, 1], path.quaternion[0, 1], path.v[0, 1], spin, path.t)
    return path, other


def compared(name: str) -> None:
    """Positions within 1e-8 of the size, orientations within 1e-8, forces within 1e-7 of the weight."""
    path, other = both(name)
    turned = Rotation.from_quat(np.roll(other.quaternion, -1, axis=-1)).as_matrix()
    closed = path.force[:, path.force.max(axis=0) > 0]
    weight = SLIDERS[name].mass * 9.81
    assert path.outcome.name == "DONE"
    assert path.events == ()
    assert other.apart < 1e-12
    assert np.abs(path.p[:, 1] - other.p).max() < 1e-8 * SIZE[name]
    assert np.abs(rotations(path, 1) - turned).max() < 1e-8
    assert closed.shape[1] == other.force.shape[1]
    assert np.abs(np.sort(closed) - np.sort(other.force)).max() < 1e-7 * weight


def test_a_peg_in_a_hole_follows_a_second_formulation() -> None:
    compared("peg_in_hole")


@pytest.mark.slow
def test_a_coin_in_a_bowl_follows_a_second_formulation() -> None:
    compared("coin_in_bowl")


@pytest.mark.slow
def test_a_helix_on_a_cylinder_follows_a_second_formulation() -> None:
    compared("helix_on_cylinder")


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["peg_in_hole", "helix_on_cylinder", pytest.param("coin_in_bowl", marks=pytest.mark.slow)]
)
def test_the_motion_is_not_a_small_one(name: str) -> None:
    path, _ = both(name)
    assert np.ptp(path.p[:, 1], axis=0).max() > 0.02
    assert np.abs(rotations(path, 1) - rotations(path, 1)[0]).max() > 0.1
    assert path.energy_drift < 1e-11
