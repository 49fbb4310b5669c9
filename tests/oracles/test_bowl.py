"""Ten ellipsoids in a bowl: each alone until the first collision, and the laws through a thousand events."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, read, simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from tests.registry import forced
from tests.running import SCENES, library_of

BEFORE = 0.5  # s, before two stones touch
UNTIL = 1.5


@cache
def path_of(form: str) -> Trajectory:
    return simulate(
        forced("ellipsoids_in_bowl", form),
        accuracy=Accuracy.tight(),
        until=UNTIL,
        samples=150,
        estimate=False,
    )


def length() -> float:
    return float(forced("ellipsoids_in_bowl", "implicit").manifest.instance["scales"]["length"])


def pair_of(contact: str) -> str:
    """The pair of bodies of a contact, which may follow one of several closest points."""
    return contact.split("#")[0]


def force_of(path: Trajectory, pair: str) -> np.ndarray[Any, Any]:
    """Normal force on a pair, over all of its contacts."""
    return path.force[:, [pair_of(name) == pair for name in path.contact_names]].sum(axis=1)


@pytest.mark.slow
def test_up_to_the_first_collision_each_stone_moves_as_if_alone() -> None:
    together = path_of("implicit")
    scene = read(SCENES / "ellipsoids_in_bowl.toml")
    bowl, *stones = scene.bodies
    pebbles = [event for event in together.events if "bowl" not in event.contact]
    assert pebbles[0].t == pytest.approx(0.519120826, abs=1e-9)
    early = together.t <= BEFORE
    for index, stone in enumerate(stones, start=1):
        contacts = tuple(
            pair for pair in scene.contacts if {stone.name, "bowl"} == {n for n, _ in pair.between}
        )
        one = replace(scene, name="one_in_bowl", bodies=(bowl, stone), contacts=contacts)
        alone = simulate(library_of(one), accuracy=Accuracy.tight(), until=UNTIL, samples=150, estimate=False)
        (landing,) = [event for event in alone.events if event.t < BEFORE and event.kind == "touch-down"]
        same = next(
            event
            for event in together.events
            if event.kind == "touch-down" and pair_of(event.contact) == pair_of(landing.contact)
        )
        assert landing.t == pytest.approx(same.t, abs=1e-11)
        assert np.abs(alone.p[early, 1] - together.p[early, index]).max() < 1e-11
        assert np.abs(alone.w[early, 1] - together.w[early, index]).max() < 1e-9
        pair = pair_of(landing.contact)
        assert force_of(alone, pair)[early] == pytest.approx(force_of(together, pair)[early], abs=1e-8)


@pytest.mark.slow
def test_two_forms_stay_together_through_collisions() -> None:
    # they part by 1e-11 m here, by 1e-9 m after 4.5 s and by 1e-6 m after 6 s
    one, other = path_of("implicit"), path_of("mixed")
    collisions = [event for event in one.events if "bowl" not in event.contact and event.kind == "touch-down"]
    assert len(collisions) > 100
    assert np.abs(one.p - other.p).max() < 1e-9
    assert np.abs(one.quaternion - other.quaternion).max() < 1e-7


@pytest.mark.cases(1)
@pytest.mark.parametrize("form", ["implicit", "mixed"])
def test_the_laws_hold_through_collisions(form: str) -> None:
    path = path_of(form)
    assert path.outcome is Outcome.DONE
    most = path.energy.max() - path.energy.min()
    assert np.diff(path.energy).max() < 1e-9 * most  # without restitution nothing gives energy back
    assert np.diff(path.work).max() < 1e-9 * most
    assert path.energy_drift < 1e-9
    assert np.abs(path.energy - path.energy[0] - path.work).max() < 1e-9 * most
    assert np.nanmin(path.gap) > -1e-10 * length()
    assert path.force.min() >= 0
    assert np.nanmax(np.minimum(path.gap / length(), path.force)) < 1e-10


def test_a_coarse_run_ends_too() -> None:
    # events are located so coarsely that contacts are found a little below the surface, approaching slowly
    path = simulate(forced("ellipsoids_in_bowl", "implicit"), accuracy=Accuracy.fast(), estimate=False)
    assert path.outcome is Outcome.DONE
    assert path.gap_max < 1e-10 * length()


def test_what_an_impact_leaves_is_removed_at_once() -> None:
    # a contact that an impact leaves separating slower than rest_speed must not drift open while it is held
    path = simulate(
        forced("ellipsoids_in_bowl", "implicit"), accuracy=Accuracy.balanced(), until=0.7, estimate=False
    )
    assert path.gap_max < 1e-13 * length()
