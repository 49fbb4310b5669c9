"""The C core against a second, plain implementation of its logic over the same kernels."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Event
from modelgen.scene import python_scenes as make
from tests.oracles.plain_stepper import Change, PlainStepper
from tests.running import library_of, scene_of

STONES = (
    ((0.092, 0.092, 0.081), [0.05, 0.0, 0.131], [-0.26, -0.54, -0.14]),
    ((0.076, 0.062, 0.062), [0.26, 0.05, 0.145], [0.6, 0.18, -0.32]),
    ((0.097, 0.082, 0.076), [-0.1, -0.18, 0.15], [-0.31, 0.29, 0.21]),
)


def core_run(library: Library, until: float) -> tuple[PlainStepper, np.ndarray, list[Event]]:
    """The plain stepper from the feature pairs and eta found at the start; state at the end, events."""
    session = Session(library, Accuracy.tight())
    begin(session)
    plain = PlainStepper(library, session.feature_pair[:-1], session.eta)
    recording = Recording(session, np.array([2 * until]))
    events, code = session.drain_events(), CONTINUE
    while code in (CONTINUE, FULL):
        code = session.advance(until, 100, recording.record)
        events += session.drain_events()
    assert code == 0
    return plain, session.x.copy(), events


def in_order(changes: list[Event] | list[Change]) -> list[Event | Change]:
    """By time; those at one time by kind and contact."""
    return sorted(changes, key=lambda change: (round(change.t, 9), change.kind, change.contact))


def agree(library: Library, until: float) -> list[str]:
    """Asserts that core and plain stepper agree; returns the kinds of event that happened."""
    plain, state, events = core_run(library, until)
    assert np.abs(plain.run(until) - state).max() < 1e-10
    first, second = in_order(events), in_order(plain.changes)
    assert [(each.kind, each.contact) for each in first] == [(each.kind, each.contact) for each in second]
    assert np.abs([a.t - b.t for a, b in zip(first, second, strict=True)]).max(initial=0.0) < 1e-9
    return [each.kind for each in first]


@pytest.mark.cases(1)
@pytest.mark.parametrize("form", ["implicit", "support"])
def test_an_ellipsoid_on_a_plane(form: str) -> None:
    assert agree(scene_of("ellipsoid_on_plane", form), 1.0) == []


def test_a_ball_that_leaves_a_sphere() -> None:
    assert agree(scene_of("ball_leaves_sphere"), 1.2) == ["lift-off"]


def test_a_bouncing_ball() -> None:
    assert agree(scene_of("bouncing_ball"), 2.2) == ["impact"] * 5


def test_a_bouncing_ball_that_comes_to_rest() -> None:
    kinds = agree(scene_of("bouncing_ball"), 2.7)
    assert kinds == ["impact"] * (len(kinds) - 1) + ["touch-down"]


def test_an_ellipsoid_that_lifts_off_an_ellipsoid() -> None:
    assert agree(scene_of("ellipsoid_on_ellipsoid"), 0.6) == ["lift-off"]


@pytest.mark.slow
@pytest.mark.parametrize(("restitution", "until"), [(0.0, 0.5), (0.5, 0.35)])
def test_three_ellipsoids_that_fall_into_a_bowl_and_collide(restitution: float, until: float) -> None:
    stones = [
        make.dynamic(f"stone{i}", make.ellipsoid(*axes), density=500.0, position=place, rpy=turn)
        for i, (axes, place, turn) in enumerate(STONES)
    ]
    pairs = [("stone0", "bowl"), ("stone1", "bowl"), ("stone2", "bowl")]
    pairs += [("stone1", "stone0"), ("stone2", "stone0"), ("stone2", "stone1")]
    contact = [{"between": list(pair), "restitution": restitution} for pair in pairs]
    bowl = make.fixed("bowl", make.paraboloid(0.6, 0.6))
    kinds = agree(library_of(make.scene("three_in_a_bowl", [bowl, *stones], contact=contact)), until)
    assert {"touch-down", "lift-off" if restitution == 0 else "impact"} <= set(kinds)
    assert len(kinds) == (6 if restitution == 0 else 95)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rate", "kinds"),
    [
        pytest.param(9, {"impact", "touch-down"}, marks=pytest.mark.slow),
        (25, {"impact", "touch-down", "lift-off"}),
    ],
)
def test_an_egg_on_a_shaking_plate_with_loads(rate: int, kinds: set[str]) -> None:
    plate = make.driven("plate", make.plane(), path={"position": ["0", "0", f"0.02*sin({rate}*t)"]})
    egg = make.dynamic(
        "egg", make.ellipsoid(0.12, 0.09, 0.07), density=400.0, position=[0.0, 0.0, 0.1], rpy=[0.3, 0.2, 0.0]
    )
    loads = {
        "force": [{"body": "egg", "force": ["-0.5*vx", "0.3*sin(5*t) - 0.5*vy", "0"]}],
        "spring": [{"between": ["egg", "plate"], "stiffness": 20.0, "damping": 0.1, "rest_length": 0.05}],
    }
    contact = [{"between": ["egg", "plate"], "restitution": 0.3, "form": "implicit"}]
    scene = make.scene(f"shaking_{rate}", [plate, egg], contact=contact, **loads)
    assert set(agree(library_of(scene), 0.6)) == kinds


def test_an_approach_too_slow_to_bounce_is_stopped_where_the_contact_opens_at_once() -> None:
    ball = make.dynamic("ball", make.sphere(0.1), density=100.0, position=[0, 0, 0.1], velocity=[0, 0, -4e-6])
    lift = {"body": "ball", "force": ["0", "0", "400*pi/3*1e-3*9.81*1.0001"]}
    floor, contact = make.fixed("floor", make.plane()), [{"between": ["ball", "floor"]}]
    scene = make.scene("lifted", [floor, ball], contact=contact, force=[lift])
    path = simulate(library_of(scene), accuracy=Accuracy.fast(), until=0.5, samples=500)
    assert [event.kind for event in path.events] == ["lift-off"]
    assert path.gap.min() > -1e-12
