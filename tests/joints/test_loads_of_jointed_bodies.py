"""Time-stepping evaluates loads in the middle of a step where the joints have led the bodies, not where these
would be without joints."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of

UNTIL = 0.3  # s
INERTIA = [1e-4, 1e-4, 1e-4]


def servo() -> Scene:
    """A light hand on a slide, with a damped servo, carries a body ten times as heavy."""
    bodies = [
        make.fixed("ground"),
        make.dynamic("hand", mass=0.1, inertia=INERTIA),
        make.dynamic("load", mass=1.0, inertia=INERTIA),
    ]
    joints = [
        {"kind": "prismatic", "name": "lift", "between": ["ground", "hand"]},
        {"kind": "weld", "name": "grip", "between": ["hand", "load"]},
    ]
    force = "900*(0.05 - coordinate) - 60*rate"
    return make.scene("servo", bodies, joint=joints, actuator=[{"joint": "lift", "force": force}])


def test_a_servo_sees_the_inertia_of_what_its_body_carries() -> None:
    """Steps of 10 ms follow its rate, 60/1.1 1/s; they would not follow that of the hand alone, 600 1/s."""
    library = library_of(servo())
    exact = simulate(library, until=UNTIL, accuracy="balanced", samples=1, estimate=False)
    errors = []
    for step in (0.01, 0.005, 0.0025):
        accuracy = Accuracy.fast().time_stepping(step)
        path = simulate(library, until=UNTIL, accuracy=accuracy, samples=1, estimate=False)
        errors.append(float(np.abs(path.p[-1] - exact.p[-1]).max()))
    assert errors[0] < 1e-5  # m; diverging without the joints
    assert all(finer < coarser / 3 for coarser, finer in pairwise(errors))
