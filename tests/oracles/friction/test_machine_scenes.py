"""Scenes of machines with friction, against their references: brake, wheel, gripper."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.scene.read import read_text
from tests.oracles.friction.extrapolation import Array
from tests.oracles.friction.grasp import RolledBetween, least_squeeze
from tests.oracles.friction.painleve import BrakeShoe
from tests.oracles.friction.wheel_on_rail import WheelOnRail
from tests.oracles.pieces import imbalance, rotations, times
from tests.running import SCENES, library_of, run

BOTH = pytest.mark.parametrize(("accuracy", "off"), [("balanced", 1e-9), ("tight", 1e-11)])
EGG = RolledBetween(0.022, 0.06, 1.1616e-5, 2.0)


@cache
def rolled() -> Array:
    """[p, e, w] of the wheel at four times; it starts on the rail, rolling about its axle at 22 rad/s."""
    wheel = WheelOnRail()
    turn = Rotation.from_euler("xz", [0.004 - np.pi / 2, 0.002])
    e = np.roll(turn.as_quat(), 1)
    p = wheel.place(np.array([0, 0.001, 0.46]), e)
    return wheel.run(p, e, 22 * turn.as_matrix()[:, 2], np.linspace(0, 0.65, 4))


@BOTH
def test_a_brake_shoe_is_pressed_on_by_its_friction_and_off_again(accuracy: str, off: float) -> None:
    path = run("brake_shoe", Accuracy.named(accuracy))
    assert [event.kind for event in path.events] == ["slip-reversal"] * 4
    assert times(path, "slip-reversal") == pytest.approx([0.25, 0.75, 1.25, 1.75], abs=off)
    shoe, speed = BrakeShoe(), np.cos(2 * np.pi * path.t)
    towards, away = speed > 1e-6, speed < -1e-6  # samples at the reversals lie before or after them
    assert path.force[towards, 0] == pytest.approx(shoe.force(0.3, 1), abs=1e2 * off)
    assert path.force[away, 0] == pytest.approx(shoe.force(0.3, -1), abs=1e2 * off)
    signed = np.where(towards, 1, -1) * 0.3 * path.force[:, 0]
    assert path.friction[towards | away, 0, 0] == pytest.approx(signed[towards | away])
    assert np.abs(path.p[:, 1] - path.p[0, 1]).max() < off


@pytest.mark.slow
@BOTH
def test_a_wheel_on_rail_follows_a_second_formulation(accuracy: str, off: float) -> None:
    path = run("wheel_on_rail", Accuracy.named(accuracy), samples=3)
    states = rolled()
    assert [event.kind for event in path.events] == ["feature-change"]
    assert np.abs(path.p[:, 1] - states[:, :3]).max() < off
    assert np.abs(path.w[:, 1] - states[:, 7:]).max() < 1e3 * off
    assert np.ptp(path.energy) < 1e-10 * path.energy[0]
    assert (np.linalg.norm(path.friction[:, 0], axis=1) < 0.05 * path.force[:, 0]).all()


@BOTH
def test_a_gripper_rolls_an_egg_in_place(accuracy: str, off: float) -> None:
    path = run("gripper", Accuracy.named(accuracy))
    assert not path.events
    egg, shift = path.body_names.index("egg"), 0.02 * (1 - np.cos(np.pi * path.t))
    assert np.abs(path.p[:, egg]).max() < off
    exact = Rotation.from_rotvec(np.outer(shift, [0, 0, EGG.spin(1.0)])).as_matrix()
    assert np.abs(rotations(path, egg) - exact).max() < 10 * off
    assert path.force == pytest.approx(2.0, abs=1e2 * off)
    needed = [EGG.needed_mu(0.02 * np.pi**2 * np.cos(np.pi * t)) for t in path.t]
    assert np.linalg.norm(path.friction, axis=-1) == pytest.approx(
        2.0 * np.array([needed, needed]).T, abs=off
    )
    assert imbalance(path) < 0.1 * off


@pytest.mark.cases(1)
@pytest.mark.parametrize(("share", "falls"), [(1.01, False), (0.99, True)])
def test_it_holds_the_egg_if_it_squeezes_enough(share: float, falls: bool) -> None:
    text = (SCENES / "gripper.toml").read_text(encoding="utf-8")
    still = text.replace("0.02*(1 - cos(pi*t))", "0*t")
    squeeze = share * least_squeeze(0.06 * 9.81, 0.5)
    weak = still.replace("force = [0.0, 2.0, 0.0]", f"force = [0.0, {squeeze!r}, 0.0]")
    path = simulate(library_of(read_text(weak, "gripper.toml")), until=0.5, accuracy="tight")
    fallen = 9.81 * (1 - share) / 2 * path.t**2 if falls else 0.0 * path.t
    assert path.p[:, path.body_names.index("egg"), 2] == pytest.approx(-fallen, abs=1e-9)
