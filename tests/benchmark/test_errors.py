"""What counts as an error, on motions whose distance is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modelgen.benchmark.motion_errors import beyond, errors, separation
from modelgen.benchmark.sampled_motion import Bodies, Motion
from modelgen.runtime.trajectory import Event

BODIES = Bodies(length=0.5, moving=(1, 2), turning=(True, False), mass=(1.0, 2.0))
T = np.linspace(0.0, 1.0, 11)


def motion() -> Motion:
    p = np.stack([np.stack([T, 0 * T, T**2], -1), np.stack([0 * T, T, 0 * T], -1)], axis=1)
    turned = np.zeros((11, 2, 4))
    turned[..., 0] = 1.0
    force = np.stack([1 + T, 2 - T], axis=-1)
    events = [Event(0.3, "impact", "a"), Event(0.7, "impact", "a"), Event(0.5, "lift-off", "b")]
    return Motion(T, p, turned, np.gradient(p, T, axis=0), force, events, {"energy": 1e-9, "gap": 0.0})


def test_a_motion_is_no_distance_from_itself() -> None:
    found = errors(motion(), motion(), BODIES, None)
    assert found["position"] == found["rotation"] == found["force"] == found["events"] == 0.0
    assert found["events_unmatched"] == 0
    assert not separation(motion(), motion(), BODIES).any()


def test_a_shift_counts_in_position_and_over_the_length() -> None:
    moved = replace(motion(), p=motion().p + np.array([3e-4, 0.0, 4e-4]))
    assert errors(moved, motion(), BODIES, None)["position"] == pytest.approx(5e-4)
    assert separation(moved, motion(), BODIES) == pytest.approx(np.full(11, 1e-3))


@pytest.mark.parametrize("angle", [1e-12, 1e-6, 0.1, 3.0])
def test_a_turn_counts_as_its_angle_and_by_the_way_of_body_points(angle: float) -> None:
    turned = motion().rotation.copy()
    turned[:, 0] = [np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)]
    found = replace(motion(), rotation=turned)
    assert errors(found, motion(), BODIES, None)["rotation"] == pytest.approx(angle, rel=1e-3)
    assert separation(found, motion(), BODIES) == pytest.approx(np.full(11, 2 * np.sin(angle / 2)), rel=1e-3)


def test_the_turn_of_a_body_whose_rotation_is_not_followed_does_not_count() -> None:
    turned = motion().rotation.copy()
    turned[:, 1] = [0.0, 1.0, 0.0, 0.0]
    assert not separation(replace(motion(), rotation=turned), motion(), BODIES).any()


def test_events_are_matched_with_the_nearest_of_their_like() -> None:
    late = [replace(event, t=event.t + 1e-5) for event in motion().events or ()][1:]
    found = errors(replace(motion(), events=late), motion(), BODIES, None)
    assert found["events"] == pytest.approx(1e-5)
    assert found["events_unmatched"] == 1


def test_beyond_the_horizon_only_distributions_count() -> None:
    late = motion().p.copy()
    late[6:] = late[:5:-1]
    shuffled = replace(motion(), p=late)
    found = errors(shuffled, motion(), BODIES, 0.55)
    assert found["position"] == 0.0
    assert found["beyond"]["positions"] < 1e-12
    assert errors(shuffled, motion(), BODIES, None)["position"] > 0.1
    wider = replace(motion(), p=2 * motion().p, v=2 * motion().v)
    assert beyond(wider, motion(), BODIES, 6)["speeds"] > 0.5
