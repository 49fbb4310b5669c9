"""What happens to one body changes nothing for another that it does not touch."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body
from tests.planar.scenes import HEIGHT, TIGHT, G, standing, table
from tests.running import library_of

TIP = 1.962  # of the glass, s


def together(*others: Body, pushed: tuple[str, ...] = ("glass",)) -> Trajectory:
    glass = standing(make.cylinder(0.04, HEIGHT), "glass")
    bodies = [glass, *others]
    scene = make.scene(
        "together", [table(), *bodies],
        contact=[{"between": [body.name, "table"]} for body in bodies],
        force=[{"body": name, "force": ["2.0*t", "0.4*t", "0"], "point": [0, 0, 0.03]} for name in pushed],
        torque=[{"body": name, "torque": ["0", "0", "0.0004"]} for name in pushed],
    )  # fmt: skip
    return simulate(library_of(scene), until=2.05, samples=40, accuracy=TIGHT)


def landing(after: float) -> Body:
    """A ball that touches the table so long after the glass has tipped, s."""
    tip = TIP / np.hypot(1.0, 0.2)
    height = 0.5 * G * (tip + after) ** 2 + 0.03
    return standing(make.sphere(0.03), "ball", position=[0.0, 2.0, float(height)])


@pytest.mark.parametrize("after", [4.5e-4, 1e-5, 0.01])
def test_a_ball_that_lands_while_a_glass_begins_to_roll_does_not_disturb_it(after: float) -> None:
    alone, both = together(), together(landing(after))
    assert sum(event.contact.startswith("ball") for event in both.events) == 1
    assert np.abs(alone.p[:, 1] - both.p[:, 1]).max() < 1e-12
    assert np.abs(alone.quaternion[:, 1] - both.quaternion[:, 1]).max() < 1e-10


def test_two_glasses_tip_each_in_its_own_time_however_near() -> None:
    """At once; and one after the other by less than the margin of a pressure is resolved to."""
    apart = 5e-10  # of the forces
    bodies = [
        standing(make.cylinder(0.04, HEIGHT), name, position=[0.0, y, HEIGHT / 2])
        for name, y in (("first", 0.0), ("twin", 1.0), ("last", 2.0))
    ]
    forces = [2.0, 2.0, 2.0 * (1 - apart)]
    scene = make.scene(
        "twins", [table(), *bodies], contact=[{"between": [body.name, "table"]} for body in bodies],
        force=[
            {"body": body.name, "force": [f"{force!r}*t", "0.4*t", "0"], "point": [0, 0, 0.03]}
            for body, force in zip(bodies, forces, strict=True)
        ],
        torque=[{"body": body.name, "torque": ["0", "0", "0.0004"]} for body in bodies],
    )  # fmt: skip
    path = simulate(library_of(scene), until=1.95, samples=40, accuracy=TIGHT, estimate=False)
    tips = [event for event in path.events if event.kind == "tipping"]
    assert [event.contact for event in tips] == ["first-table", "twin-table", "last-table"]
    for event, force in zip(tips, forces, strict=True):
        assert event.t == pytest.approx(TIP * 2.0 / float(np.hypot(force, 0.4)), abs=1e-12)
    assert path.energy_drift < 1e-14
    assert not path.warnings
