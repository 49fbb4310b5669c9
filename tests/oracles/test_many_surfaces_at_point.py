"""Solids with any number of faces at a point may start touching there, and are refused where they overlap."""

from __future__ import annotations

from math import cos, pi, sin

import pytest

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of

HEIGHT, RADIUS = 0.08, 0.05


def on_foot_of_l(sides: int, turn: float, depth: float) -> Scene:
    """A pyramid on its tip on the foot of an L, its axis upright, `depth` below the foot's face."""
    ring = [
        [RADIUS * cos(2 * pi * k / sides + turn), RADIUS * sin(2 * pi * k / sides + turn), HEIGHT]
        for k in range(sides)
    ]
    outline = [[-0.2, -0.02], [0.2, -0.02], [0.2, 0.02], [-0.12, 0.02], [-0.12, 0.3], [-0.2, 0.3]]
    base = make.fixed("base", make.extrusion(0.4, points=outline), rpy=[pi / 2, 0.0, 0.0])
    pyramid = make.dynamic(
        "pyramid",
        make.polyhedron([[0.0, 0.0, 0.0], *ring]),
        density=1000.0,
        position=[0.05, 0.03, 0.02 - depth],
    )
    return make.scene("tips", [base, pyramid], contact=[{"between": ["pyramid", "base"], "friction": 0.2}])


@pytest.mark.parametrize(("sides", "turn"), [(5, 0.1), (16, 0.2), (29, 0.05), (48, 0.3)])
def test_a_tip_that_touches_is_accepted(sides: int, turn: float) -> None:
    path = simulate(library_of(on_foot_of_l(sides, turn, 0.0)), until=1e-6, samples=1, estimate=False)
    assert path.outcome.succeeded
    assert not path.doubts
    weight = path.force[0]
    assert (weight > 0).sum() == 1


@pytest.mark.parametrize("sides", [5, 29])
def test_a_tip_within_the_material_is_refused(sides: int) -> None:
    with pytest.raises(SimulationError, match=r"interpenetrate|within"):
        simulate(library_of(on_foot_of_l(sides, 0.1, 2e-3)), until=1e-6, samples=1, estimate=False)
