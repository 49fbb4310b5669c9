"""Advice on the step of time-stepping: the rates that it states are those of closed forms."""

from __future__ import annotations

import pytest

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of


def wheel(spin: float = 1.0, **hinge: float) -> Scene:
    """A wheel of 0.3 kg m^2 on a hinge."""
    body = make.dynamic("wheel", mass=2.0, inertia=[0.4, 0.4, 0.3], angular_velocity=[0, 0, spin])
    joint = {"kind": "revolute", "between": ["world", "wheel"], **hinge}
    return make.scene("wheel", [body], joint=[joint], gravity=[0, 0, 0])


def advice(scene: Scene, step: float, method: str = "time-stepping") -> list[str]:
    library = library_of(scene)
    record = Accuracy.balanced().time_stepping(step) if method == "time-stepping" else Accuracy.balanced()
    path = simulate(library, until=10 * step, samples=1, accuracy=record, estimate=False)
    return [warning for warning in path.warnings if "step" in warning]


@pytest.mark.parametrize(
    ("damping", "stiffness", "rate"),
    [(0.3e4, 0.0, 1e4), (0.0, 0.3e8, 1e4), (0.3e3, 0.3e6, 2e3)],
)
def test_a_step_that_is_long_for_a_spring_is_named_with_its_rate(
    damping: float, stiffness: float, rate: float
) -> None:
    scene = wheel(damping=damping, stiffness=stiffness)
    (told,) = advice(scene, 1e-3)
    assert f"the step is {1e-3 * rate:.2g} times as long" in told
    assert "between world and wheel" in told
    assert f"a step below {1 / rate:.1g} s" in told
    assert not advice(scene, 0.9 / rate)
    assert not advice(scene, 1e-3, "dop853")


def test_a_step_that_is_long_for_a_spin_is_named_with_the_turn() -> None:
    (told,) = advice(wheel(500.0), 1e-3)
    assert told.startswith("wheel turns by up to 0.5 rad in a step")
    assert "a step below 0.0006 s" in told
    assert not advice(wheel(500.0), 5e-4)


def test_a_short_step_needs_no_advice() -> None:
    assert not advice(wheel(damping=0.3, stiffness=0.3), 1e-3)
