"""Searches for closest points that are long or given up: what they may cost, and what they may not miss.

Where surfaces conform, a search looks at very many pairs of cells, or gives up. `search_effort` counts them.
"""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import ran

FIRST = 1_000_000  # pairs of cells: what searches take before the first one is given up, and that one
AGAIN = 15_000  # the most that one takes on the average after others were given up


def frustum_in_ring(off: float) -> Trajectory:
    """A frustum that falls into a ring, its axis beside that of the ring by `off` metres."""
    ring = make.fixed("ring", make.torus(0.1, 0.02))
    frustum = make.dynamic("frustum", make.frustum(0.05, 0.12, 0.1), density=1000.0, position=[off, 0, 0.08])
    return ran([ring, frustum], 0.2, [{"between": ["frustum", "ring"]}], Accuracy.balanced(), samples=20)


def ball_in_bowl(drop: float) -> Trajectory:
    """A ball that falls on the bottom of a paraboloid of its own curvature."""
    bowl = make.fixed("bowl", make.paraboloid(0.1, 0.1))
    ball = make.dynamic("ball", make.sphere(0.1), density=1000.0, position=[0, 0, 0.1 + drop])
    return ran([bowl, ball], 0.2, [{"between": ["ball", "bowl"]}], Accuracy.balanced(), samples=20)


@pytest.mark.parametrize("decade", range(3, 9))
def test_a_search_is_not_repeated_at_every_step_while_it_is_given_up(decade: int) -> None:
    path = frustum_in_ring(10.0**-decade)
    assert path.search_effort < FIRST + AGAIN * path.incomplete_searches
    assert path.is_trusted <= (path.incomplete_searches == 0)


@pytest.mark.parametrize("decade", [1, 3, 5])
def test_a_fall_onto_a_surface_that_conforms_is_searched_a_bounded_number_of_times(decade: int) -> None:
    path = ball_in_bowl(10.0**-decade)
    assert path.search_effort < 2 * FIRST
    assert not path.is_trusted


@pytest.mark.parametrize("decade", range(7, 9))
def test_a_face_that_nothing_touches_makes_no_search_due(decade: int) -> None:
    """The plane of the lower face of the frustum meets the ring all around, outside of the face."""
    path = frustum_in_ring(10.0**-decade)
    assert path.outcome is Outcome.DONE
    assert path.is_trusted
    assert path.steps < 40
    assert np.abs(path.p[-1, 1, :2]).max() < 1e-7


def test_the_gap_after_a_search_that_was_given_up_is_not_taken_to_be_large() -> None:
    """A ball almost at the centre of a cup that it almost fills: no closest point is found at the start."""
    cup = make.revolution("0.1*sin(t)", "-0.1*cos(t)", domain=[0.0, float(np.pi / 2)], cavity=True)
    ball = make.dynamic("ball", make.sphere(0.0999), density=1000.0, position=[0, 0, 1e-5])
    scene = [make.fixed("cup", cup), ball]
    path = ran(scene, 0.05, [{"between": ["ball", "cup"]}], Accuracy.balanced(), samples=20)
    assert path.incomplete_searches
    assert not path.is_trusted
    assert path.penetration_max < 1e-9
    assert path.p[-1, 1, 2] == pytest.approx(-1e-4, abs=1e-9)
