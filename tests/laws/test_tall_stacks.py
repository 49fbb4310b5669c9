"""Stacks and pyramids at `coarse` come to their end, and what rests stays where it is."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import pyramid, stack
from tests.running import library_of

UNTIL = 1.0  # s


def ran(scene: Scene) -> Trajectory:
    run = simulate(library_of(scene), until=UNTIL, accuracy="coarse", samples=4, estimate=False)
    assert run.outcome.name == "DONE", run.outcome.value
    return run


@pytest.mark.parametrize("boxes", [3, 12, 40])
def test_a_stack_stays(boxes: int) -> None:
    run = ran(stack(boxes))
    assert np.abs(run.p[-1] - run.p[0]).max() < 1e-6
    assert run.penetration_max < 1e-9


@pytest.mark.parametrize("rows", [3, 7])
def test_a_pyramid_that_is_struck_does_not_sink(rows: int) -> None:
    """Its corners lie on each other, so that corrections of one contact close others."""
    assert ran(pyramid(rows)).penetration_max < 1e-6
