"""Events of two runs: which are the same, and for how long the runs are in different modes.

Judged by the times at which random histories of a contact were written.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen import simulate
from modelgen.runtime.event_matching import alone, in_pairs, modes_apart
from modelgen.runtime.trajectory import Event, EventKind
from modelgen.scene import python_scenes as make
from tests.running import library_of

END = 10.0
BARE: dict[str, Any] = {"contacts": [], "patches": [], "feature_pairs": []}
seeds = st.integers(0, 2**32 - 1)


def history(random: np.random.Generator, n: int) -> list[Event]:
    """A contact that is open, closes and slides, sticks, and opens again, n times, 0.1 s apart or more."""
    t, told = 0.0, []
    kinds: Sequence[EventKind] = ("touch-down", "slip-stop", "slip-start", "lift-off")
    for _ in range(n):
        for kind in kinds:
            t += 0.1 + random.uniform(0, 0.1)
            told.append(Event(t, kind, "a", speed=1.0 if kind == "touch-down" else 0.0))
    return told


@given(seeds, st.integers(1, 10), st.floats(0, 0.04))
def test_events_that_come_later_are_the_same_and_modes_differ_for_as_long(
    seed: int, n: int, late: float
) -> None:
    random = np.random.default_rng(seed)
    mine = history(random, n)
    by = late * random.uniform(0, 1, len(mine))
    theirs = [replace(event, t=event.t + shift) for event, shift in zip(mine, by, strict=True)]
    assert in_pairs(mine, theirs) == list(zip(mine, theirs, strict=True))
    apart = modes_apart(mine, theirs, BARE, END)
    assert set(apart) == {("touch", "a"), ("slip", "a")}
    touches = [
        shift for event, shift in zip(mine, by, strict=True) if event.kind in ("touch-down", "lift-off")
    ]
    assert apart["touch", "a"] == pytest.approx(sum(touches), abs=1e-12)
    assert apart["slip", "a"] <= sum(by) + 1e-12


@given(seeds, st.integers(2, 10), st.floats(1e-9, 0.05))
def test_a_contact_that_opens_and_closes_in_one_run_counts_for_the_time_between(
    seed: int, n: int, brief: float
) -> None:
    random = np.random.default_rng(seed)
    mine = history(random, n)
    k = 4 * int(random.integers(n)) + 3  # a lift-off: the contact sticks before it
    t = mine[k].t - 0.05 - brief / 2
    more = [Event(t, "lift-off", "a"), Event(t + brief, "touch-down", "a")]
    theirs = [*mine[:k], *more, *mine[k:]]
    for one, other in ((mine, theirs), (theirs, mine)):
        pairs = in_pairs(one, other)
        assert sorted(event.t for event in alone(one, other, pairs)) == [event.t for event in more]
        assert modes_apart(one, other, BARE, END)["touch", "a"] == pytest.approx(brief, rel=1e-6)


@given(seeds, st.integers(1, 10))
def test_a_contact_that_does_not_open_counts_until_it_does_in_the_other_run_or_to_the_end(
    seed: int, n: int
) -> None:
    mine = history(np.random.default_rng(seed), n)
    apart = modes_apart(mine, mine[:-1], BARE, END)
    assert apart["touch", "a"] == pytest.approx(END - mine[-1].t)
    assert apart["slip", "a"] == 0.0


def test_slip_that_starts_and_stops_in_one_run_counts_for_the_time_between() -> None:
    slips = [Event(1.0, "slip-start", "a"), Event(1.25, "slip-stop", "a")]
    assert modes_apart([], slips, BARE, END) == {("slip", "a"): 0.25}
    assert modes_apart(slips[:1], slips, BARE, END) == {("slip", "a"): END - 1.25}
    held = [Event(2.0, "slip-start", "a"), Event(3.0, "slip-reversal", "a"), Event(4.0, "lift-off", "a")]
    assert modes_apart(held, [held[0], held[2]], BARE, END)["slip", "a"] == 0.0


def test_a_load_that_switches_in_one_run_counts_until_it_switches_back() -> None:
    there, back = Event(1.0, "load-switch", "force on b"), Event(1.5, "load-switch", "force on b")
    assert modes_apart([there, back], [], BARE, END) == {("load", "force on b"): 0.5}
    assert modes_apart([there], [], BARE, END) == {("load", "force on b"): END - 1.0}


def test_a_face_that_rests_takes_the_place_of_its_corners() -> None:
    """Of which one run lets one slip and the other does not, just before."""
    instance = {
        "contacts": [{"name": f"floor-box:{k}", "pair": 0} for k in range(4)],
        "patches": [{"name": "floor-box:bottom", "pair": 0, "feature_pairs": []}],
        "feature_pairs": [],
    }
    rests = Event(2.0, "face-contact", "floor-box")
    slips = Event(1.75, "slip-start", "floor-box:2")
    assert modes_apart([rests], [slips, rests], instance, END)["slip", "floor-box:2"] == 0.25
    slides, opens = Event(3.0, "slip-start", "floor-box"), Event(4.0, "lift-off", "floor-box:2")
    stops = Event(4.0, "slip-stop", "floor-box")
    assert modes_apart([rests, slides, opens], [rests, slides, opens, stops], instance, END)[
        "slip", "floor-box"
    ] == pytest.approx(0.0)


def test_a_face_that_slides_on_in_one_run_counts_from_when_it_rests() -> None:
    """The other run, in which it sticks at once, tells nothing of its slip."""
    rests, stops = Event(2.0, "face-contact", "floor-box"), Event(2.25, "slip-stop", "floor-box")
    assert modes_apart([rests, stops], [rests], BARE, END)["slip", "floor-box"] == 0.25


def test_blows_of_one_speed_are_the_same_at_one_time_too() -> None:
    """Of two blows at one instant, and a third that only one run has."""
    first, second = (Event(1.0, "impact", "a", speed=speed) for speed in (1.0, 0.5))
    more = Event(1.0 + 1e-12, "touch-down", "a", speed=0.01)
    pairs = in_pairs([first, second, more], [first, second])
    assert pairs == [(first, first), (second, second)]
    assert alone([first, second, more], [first, second], pairs) == [more]


@given(seeds, st.integers(2, 5))
def test_blows_of_a_pair_are_the_same_however_its_contacts_are_numbered(seed: int, n: int) -> None:
    random = np.random.default_rng(seed)
    ends = random.integers(n, size=12)
    mine = [Event(1.0 + k, "impact", f"a-b#{end}", f"end{end}", 1.0) for k, end in enumerate(ends.tolist())]
    number = random.permutation(n)
    theirs = [replace(event, contact=f"a-b#{number[int(event.features[3:])]}") for event in mine]
    assert in_pairs(mine, theirs) == list(zip(mine, theirs, strict=True))


def test_features_count_while_their_contact_is_closed() -> None:
    """In a run whose contact changes from one edge to a face by way of a corner, or at once."""
    by_corner = [Event(1.0, "feature-change", "a", "corner"), Event(1.5, "feature-change", "a", "face")]
    at_once = [replace(by_corner[1], t=1.0)]
    touches, opens = Event(0.5, "touch-down", "a", "edge", 1.0), Event(0.75, "lift-off", "a", "edge")
    for before, apart in (([], 0.5), ([touches], 0.5), ([touches, opens], 0.0)):
        found = modes_apart([*before, *by_corner], [*before, *at_once], BARE, END)
        assert found.get(("feature", "a"), 0.0) == pytest.approx(apart)
    assert not modes_apart(by_corner, at_once, BARE, END, unloaded=["a"])


@given(seeds)
def test_bounces_that_settle_leave_no_event_alone(seed: int) -> None:
    """A ball that is thrown on a floor: run and companion give up its bounces at different speeds."""
    random = np.random.default_rng(seed)
    radius, restitution = random.uniform(0.02, 0.2), random.uniform(0, 0.9)
    velocity, spin = ([float(each) for each in row] for row in random.normal(size=(2, 3)) * [[1.0], [3.0]])
    ball = make.dynamic(
        "ball", make.sphere(radius), density=1e3, position=[0, 0, radius + random.uniform(0, 0.1)],
        velocity=velocity, angular_velocity=spin,
    )  # fmt: skip
    between = {"between": ["floor", "ball"], "restitution": restitution, "friction": random.uniform(0, 0.8)}
    library = library_of(make.scene("settles", [make.fixed("floor", make.plane()), ball], contact=[between]))
    path = simulate(library, until=2.0, samples=20)
    assert path.estimate is not None
    assert path.estimate.events_unmatched == 0
    fine = simulate(library, until=2.0, samples=20, accuracy="tight", estimate=False)
    assert np.abs(path.p[-1] - fine.p[-1]).max() <= 2 * path.position_error[-1]
