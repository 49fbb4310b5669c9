"""Runs that once went wrong, found by random scenes: they keep their energy and stay above the floor."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

HALF_TORUS = """
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}

[[body]]
name = "arch"
shape = {{ kind = "half_torus", major = 0.07, minor = {minor} }}
mass = {mass}
inertia = {inertia}
position = {position}
quaternion = {quaternion}
velocity = {velocity}
angular_velocity = {spin}

[[contact]]
between = ["arch", "floor"]
{contact}
"""
FALLS_FLAT = {
    "minor": 0.03756, "mass": 1.21575, "inertia": [0.00538706786605, 0.00469493495464, 0.00521180438306],
    "position": [-0.35, 0.35, 0.2],
    "quaternion": [0.544835078327, -0.827953172305, 0.118744964449, -0.0595643795573],
    "velocity": [-1.2851013197, 0.791904581447, -1.69194692837],
    "spin": [5.9316618122, -2.54483889422, 1.87026210563], "contact": "friction = 0.393",
}  # fmt: skip
TUMBLES = {
    "minor": 0.03288, "mass": 0.524761, "inertia": [0.0022618390425, 0.00195010939765, 0.00231338658442],
    "position": [0.0, 0.0, 0.55],
    "quaternion": [-0.00246381742784, -0.486965991292, 0.866952883831, 0.106069553342],
    "velocity": [-0.0907233616674, -0.120948637202, 1.07672195606],
    "spin": [3.91542808343, 1.82958978953, 3.99414663541], "contact": "restitution = 0.84",
}  # fmt: skip
SADDLE = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ring"
mass = 1.0
inertia = [0.004, 0.004, 0.006]
position = [0.0, 0.0, 0.2]
angular_velocity = [0.3, 0.1, 0.0]
[[body.shape]]
kind = "curve"
x = "0.07 * cos(t)"
y = "0.09 * sin(t)"
z = "0.02 * cos(2 * t)"
domain = [0.0, 6.283185307179586]
periodic = true

[[contact]]
between = ["ring", "floor"]
"""


def ran(text: str, until: float, accuracy: str) -> Trajectory:
    return simulate(library_of(read_text(text, "found.toml")), until=until, accuracy=accuracy, samples=400)


def test_a_rim_that_passes_flat_within_a_step_is_not_set_back_without_a_blow() -> None:
    path = ran(HALF_TORUS.format(**FALLS_FLAT), 0.5, "fast")
    assert path.energy_drift < 1e-6
    assert path.p[:, 1, 2].min() > 0


def test_while_one_end_of_an_arch_is_near_the_floor_the_other_does_not_pass_it() -> None:
    path = ran(HALF_TORUS.format(**TUMBLES), 3.0, "balanced")
    assert path.outcome.succeeded
    assert path.p[:, 1, 2].min() > 0.03


def test_a_curve_stands_on_as_many_of_its_points_as_are_lowest() -> None:
    path = ran(SADDLE, 0.5, "fast")
    turned = 2 * np.arccos(np.abs(path.quaternion[:, 1]).max(axis=1))
    assert path.p[:, 1, 2].min() == pytest.approx(0.02, abs=1e-3)
    assert turned.max() < 0.1


BESIDE_A_BOX = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "box"
shape = { kind = "box", size = [0.1, 0.12, 0.0676] }
mass = 1.33
inertia = [0.006, 0.0063, 0.006]
position = [0.0, 0.0, 0.0338]

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.0454 }
mass = 2.0
inertia = [0.008, 0.008, 0.008]
position = [0.5, 0.0, 0.3]
angular_velocity = [1.0, 2.0, 3.0]

[[contact]]
between = ["box", "floor"]
friction = 0.3

[[contact]]
between = ["ball", "floor"]
restitution = 0.591
"""


def test_bounces_too_low_to_be_seen_end_however_finely_they_are_followed() -> None:
    path = simulate(library_of(read_text(BESIDE_A_BOX, "bounces.toml")), until=1.5)
    assert path.estimate is not None
    assert np.isfinite(path.estimate.position).all()
    assert path.estimate.rhs_evals < 4 * path.rhs_evals


ZIGZAG = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "wire"
mass = 1.17663
inertia = [0.0048, 0.0042, 0.0046]
position = [0.0, 0.0, 0.15]
quaternion = [0.8, 0.4, -0.3, 0.33]
velocity = [0.6, -0.3, -1.0]
angular_velocity = [3.0, -4.0, 2.0]
[body.shape]
kind = "polyline"
points = [[0.07, 0.0, 0.0], [0.0, 0.06, 0.02], [-0.07, 0.0, 0.0], [0.0, -0.06, -0.02]]
radius = 0.01
closed = true

[[contact]]
between = ["wire", "floor"]
friction = 0.5
restitution = 0.4
"""


def test_a_wire_with_rounded_corners_stays_above_the_floor() -> None:
    path = ran(ZIGZAG, 3.0, "fast")
    corners = np.array([[0.07, 0.0, 0.0], [0.0, 0.06, 0.02], [-0.07, 0.0, 0.0], [0.0, -0.06, -0.02]])
    middles = (corners + np.roll(corners, -1, axis=0)) / 2  # on its straight parts
    turned = Rotation.from_quat(path.quaternion[:, 1], scalar_first=True)
    lowest = min(float((turned.apply(x) + path.p[:, 1])[:, 2].min()) for x in middles)
    assert lowest > -1e-7
    assert path.p[-1, 1, 2] < 0.05
