"""A blow on a body that touches another, with no contact closed there, is one event with their blow.

A ball is about to leave a table, on which it still lies to within the tolerance of gaps, when another falls
on it: it strikes the table at once, and both stay.
"""

from __future__ import annotations

import pytest

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene
from tests.running import library_of

RISE, FALL = 1e-4, 1.0  # m/s, of the lower ball and of the upper one
APART = 1e-8  # m, between the balls


def ball(name: str, height: float, velocity: float) -> Body:
    return make.dynamic(
        name,
        make.sphere(0.1),
        mass=1.0,
        inertia=[0.004, 0.004, 0.004],
        position=[0.0, 0.0, height],
        velocity=[0.0, 0.0, velocity],
    )


def chain() -> Scene:
    above = 1e-12
    balls = (ball("lower", 0.1 + above, RISE), ball("upper", 0.3 + above + APART, -FALL))
    contacts = [{"between": ["table", "lower"]}, {"between": ["lower", "upper"]}]
    return make.scene("chain", [make.fixed("table", make.plane()), *balls], contact=contacts)


@pytest.mark.parametrize("accuracy", [Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()])
def test_the_blow_goes_through_at_once(accuracy: Accuracy) -> None:
    path = simulate(library_of(chain()), accuracy=accuracy, estimate=False, until=0.01)
    first, second = path.events
    assert (first.contact, second.contact) == ("lower-upper", "table-lower")
    assert first.kind == second.kind == "touch-down"
    assert first.t == second.t == pytest.approx(APART / (RISE + FALL), rel=1e-3)
    assert first.speed == pytest.approx(RISE + FALL)
    assert second.speed == pytest.approx((FALL - RISE) / 2)  # of the two balls after the first blow
    assert abs(path.v[-1]).max() < 1e-12
