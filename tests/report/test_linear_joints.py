"""Small motions of bodies that joints hold: closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from modelgen import derive, linearise, read, require
from modelgen.errors import SimulationError
from modelgen.linearisation.equilibrium_and_modes import Linearised
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Body, Scene
from tests.oracles.pieces import G
from tests.running import SCENES, library_of

ALONG_Y = [-np.pi / 2, 0.0, 0.0]  # rpy of a joint with its axis along y of the world
LENGTH, MASS = 0.4, 1.3


def linear(scene: Scene) -> Linearised:
    return linearise(derive(require(scene)), library_of(scene))


def bar(name: str, x: float, z: float, mass: float = MASS, rod: float = LENGTH) -> Body:
    """A thin rod along z, about its centre."""
    across = mass * rod**2 / 12
    return make.dynamic(name, mass=mass, inertia=[across, across, across / 50], position=[x, 0.0, z])


def hinge(one: str, other: str, x: float, z: float, **keys: Any) -> dict[str, Any]:
    return {
        "kind": "revolute", "name": f"{one}_{other}", "between": [one, other], "position": [x, 0.0, z],
        "rpy": ALONG_Y, **keys,
    }  # fmt: skip


def hanging(bodies: Sequence[Body], joints: Sequence[dict[str, Any]]) -> Scene:
    return make.scene("hanging", bodies, joint=joints)


def test_a_pendulum_with_a_spring_and_a_damper_swings_as_its_closed_form() -> None:
    k, c, inertia = 2.0, 0.05, MASS * LENGTH**2 / 3
    spring = {"stiffness": k, "damping": c}
    found = linear(hanging([bar("rod", 0, -LENGTH / 2)], [hinge("world", "rod", 0, 0, **spring)]))
    (mode,) = found.modes
    stiffness = (k + MASS * G * LENGTH / 2) / inertia
    assert mode.growth == pytest.approx(-c / (2 * inertia), rel=1e-9)
    assert mode.frequency == pytest.approx(np.sqrt(stiffness - mode.growth**2), rel=1e-9)


def test_a_double_pendulum_swings_with_its_two_frequencies() -> None:
    """With the angles of both rods against the vertical: M a'' + K a = 0."""
    rods = [bar("upper", 0, -LENGTH / 2), bar("lower", 0, -1.5 * LENGTH)]
    found = linear(hanging(rods, [hinge("world", "upper", 0, 0), hinge("upper", "lower", 0, -LENGTH)]))
    mass = MASS * LENGTH**2 * np.array([[1 / 3 + 1, 1 / 2], [1 / 2, 1 / 3]])
    stiffness = MASS * G * LENGTH * np.diag([1.5, 0.5])
    expected = np.sqrt(eigh(stiffness, mass, eigvals_only=True))
    assert found.frequencies == pytest.approx(expected, rel=1e-10)
    assert len(found.modes) == 2


def test_an_equilibrium_is_found_from_a_tilted_start() -> None:
    """A rod on a hinge with a spring whose rest is elsewhere: k (a - rest) + m g l/2 sin a = 0."""
    k, rest, half = 1.5, 0.6, LENGTH / 2
    start = {"position": [-half * np.sin(0.2), 0.0, -half * np.cos(0.2)], "rpy": [0.0, 0.2, 0.0]}
    across = MASS * LENGTH**2 / 12
    rod = make.dynamic("rod", mass=MASS, inertia=[across, across, across / 50], **start)
    found = linear(hanging([rod], [hinge("world", "rod", 0, 0, stiffness=k, rest=rest)]))
    x, _, z = found.p["rod"]
    angle = float(np.arctan2(-x, -z))
    turned = angle - 0.2  # from the start, where the coordinate of the joint is zero
    assert k * (turned - rest) + MASS * G * half * np.sin(angle) == pytest.approx(0, abs=1e-9)
    stiffness = k + MASS * G * half * np.cos(angle)
    assert found.frequencies == pytest.approx([np.sqrt(stiffness / (MASS * LENGTH**2 / 3))], rel=1e-9)


def test_a_closed_linkage_with_redundant_rows_swings_as_a_parallelogram() -> None:
    """Two rods that hang side by side with a coupler between their ends: 20 rows of rank 17."""
    coupler, width = 0.7, 0.3
    beam = make.dynamic("beam", mass=coupler, inertia=[1e-3, 2e-3, 2e-3], position=[width / 2, 0.0, -LENGTH])
    rods = [bar("left", 0, -LENGTH / 2), bar("right", width, -LENGTH / 2)]
    joints = [
        hinge("world", "left", 0, 0), hinge("world", "right", width, 0),
        hinge("left", "beam", 0, -LENGTH), hinge("right", "beam", width, -LENGTH),
    ]  # fmt: skip
    found = linear(hanging([*rods, beam], joints))
    expected = np.sqrt(G * (MASS + coupler) / (LENGTH * (2 * MASS / 3 + coupler)))
    assert found.frequencies == pytest.approx([expected], rel=1e-10)
    assert found.redundant == 0  # forces of contacts alone are asked for


def test_a_pole_on_a_wheel_that_rolls_falls_with_its_own_rate() -> None:
    """Upright, without torque: the wheel's friction sticks, and its plane is held by a joint too."""
    text = (SCENES / "balancing_wheel.toml").read_text().replace("lean_0 = 0.15", "lean_0 = 0.0")
    found = linear(read_text(text, "upright.toml"))
    m, h, inertia, radius = 2.0, 0.4, 0.06, 0.15
    wheel = 1.5 + 0.02 / radius**2
    rate = np.sqrt(m * G * h / (inertia + m * h**2 - (m * h) ** 2 / (wheel + m)))
    growths = sorted(mode.growth for mode in found.modes if mode.growth)
    assert growths == pytest.approx([-rate, rate], rel=1e-9)
    assert found.force["floor-wheel"] == pytest.approx((m + 1.5) * G, rel=1e-9)
    assert found.friction["floor-wheel"].share == pytest.approx(0, abs=1e-9)


def test_what_joints_are_refused() -> None:
    rod = bar("rod", 0, -LENGTH / 2)
    with pytest.raises(SimulationError, match="motion of joint 'world_rod' is prescribed"):
        linear(hanging([rod], [hinge("world", "rod", 0, 0, motion="0.1*sin(t)")]))
    with pytest.raises(SimulationError, match="joint 'world_rod' is at its limit"):
        linear(hanging([rod], [hinge("world", "rod", 0, 0, limits=[0.0, 1.0])]))
    with pytest.raises(SimulationError, match="is driven"):
        linear(read(SCENES / "turntable.toml"))
