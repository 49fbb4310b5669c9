"""An order of blows that the error of a run leaves open is named, and only such a one."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.error_estimate import ORDERED, estimate_of
from modelgen.runtime.event_matching import in_pairs, undecided_impacts
from modelgen.runtime.order_of_impacts import led_elsewhere, ties_left
from modelgen.runtime.simulate import in_other_order
from modelgen.runtime.trajectory import Event, Trajectory
from modelgen.scene.read import read_text
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.benchmarks.verdict_scenes import drawn
from tests.running import library_of, scene_of

LEFT, RIGHT = "cube-table:top_back_left", "cube-table:top_front_left"
FALLS_ON_AN_EDGE = (
    Event(0.3014110598, "impact", LEFT, speed=0.93),
    Event(0.3014110932, "impact", RIGHT, speed=0.36),
)
Events = tuple[Event, ...]


def found(mine: Events, theirs: Events, least: float = 1e-6) -> Events | None:
    instance, pairs = scene_of("cube_toss").manifest.instance, in_pairs(mine, theirs)
    ties = undecided_impacts(pairs, instance, ORDERED, least, 0.36)
    return ties[0] if ties else None


def shifted(event: Event, by: float) -> Event:
    return replace(event, t=event.t + by)


@given(late=st.floats(1e-12, 1e-9), shift=st.floats(-1e-3, 1e-3))
def test_two_blows_nearer_than_their_error_are_named(late: float, shift: float) -> None:
    a, b = FALLS_ON_AN_EDGE
    nearer = (shifted(a, shift), replace(b, t=a.t + shift + late))
    assert found(FALLS_ON_AN_EDGE, nearer) == FALLS_ON_AN_EDGE
    assert found(nearer, FALLS_ON_AN_EDGE) == nearer


@given(error=st.floats(-1e-8, 1e-8), shift=st.floats(-1e-3, 1e-3))
def test_two_blows_farther_apart_than_their_error_are_not(error: float, shift: float) -> None:
    a, b = FALLS_ON_AN_EDGE
    assert found(FALLS_ON_AN_EDGE, (shifted(a, shift), shifted(b, shift + error))) is None


def test_blows_at_once_or_in_another_order_show_in_the_motion() -> None:
    a, b = FALLS_ON_AN_EDGE
    at_once = (a, replace(b, t=a.t))
    assert found(at_once, at_once) is None
    assert found(FALLS_ON_AN_EDGE, at_once) is None
    assert found(FALLS_ON_AN_EDGE, (b, shifted(a, 1e-7))) is None


@given(late=st.floats(1e-12, 1e-9), error=st.floats(-1e-9, 1e-9))
def test_a_blow_at_a_contact_that_did_not_approach_at_the_one_before_comes_after_it(
    late: float, error: float
) -> None:
    a, b = FALLS_ON_AN_EDGE
    mine, theirs = ((a, replace(b, t=a.t + by, after_t=a.t)) for by in (late, abs(late + error) + 1e-12))
    assert found(mine, theirs) is None
    in_turn = (a, replace(b, t=a.t + late, after_t=a.t - late))
    assert found(in_turn, (a, replace(b, t=a.t + late / 9, after_t=a.t - late))) is not None
    assert found(in_turn, (a, replace(b, t=a.t + late / 9, after_t=a.t))) is not None


def test_blows_too_weak_to_matter_are_left_aside() -> None:
    a, b = FALLS_ON_AN_EDGE
    nearer = (a, replace(b, t=a.t + 1e-10))
    assert found(FALLS_ON_AN_EDGE, nearer, least=0.1) is None


def test_an_estimate_says_so() -> None:
    library = scene_of("cube_toss")
    path = simulate(library, until=0.2, estimate=False)
    path = replace(path, events=tuple(shifted(event, -0.2) for event in FALLS_ON_AN_EDGE))
    twin = replace(path, events=(path.events[0], replace(path.events[1], t=path.events[0].t + 1e-10)))
    stated = estimate_of(path, twin, Accuracy.balanced(), library.manifest.instance)
    assert stated.status == "uncertified"
    assert np.isfinite(stated.position).all()
    assert f"which of the impacts at {LEFT} and {RIGHT} (t = 0.101411 s, 3.3e-08 s apart)" in stated.statement


@given(true=st.floats(1e-9, 1e-6), late=st.floats(-1e-3, 1e-3))
def test_a_third_run_tells_an_order_once_the_time_between_two_blows_has_settled(
    true: float, late: float
) -> None:
    """Run and companion are off by ten and by one times the time between the blows, the third run by a tenth
    of it; or by as much as the companion."""
    a, b = FALLS_ON_AN_EDGE
    path = simulate(scene_of("cube_toss"), until=0.01, estimate=False)

    def told(between: float, shift: float) -> Trajectory:
        return replace(path, events=(shifted(a, shift), replace(b, t=a.t + shift + between)))

    run, twin = told(11 * true, 0.0), told(2 * true, late)
    common = in_pairs(run.events, twin.events)
    settled, not_yet = (told(part * true, 1.1 * late) for part in (1.9, 1.0))
    until: list[float] = []

    def third(of: Trajectory | None, end: float) -> Trajectory | None:
        until.append(end)
        return of

    assert not ties_left(common, twin, [run.events], partial(third, settled), ORDERED)
    for other in (not_yet, replace(path, events=(a,)), None):
        assert ties_left(common, twin, [run.events], partial(third, other), ORDERED) == [run.events]
    assert set(until) == {run.events[1].t}


def test_a_capsule_that_patters_on_both_ends_has_a_certain_order() -> None:
    """Its bounces end at a threshold, and so run and companion differ in when the ends strike."""
    tables = drawn("stacks and piles", 52)
    path = simulate(library_of(scene_from_tables("patters", tables, "<drawn>")))
    assert path.is_trusted
    fine = simulate(library_of(scene_from_tables("patters", tables, "<drawn>")), accuracy="tight")
    assert np.abs(path.p - fine.p).max() <= path.position_error[-1] + fine.position_error[-1]


FALLING = """
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "bar"
shape = {{ kind = "polyhedron", vertices = [[-0.2, 0, 0], [0.2, 0, 0], [0, -0.1, 0.1], [0, 0.1, 0.1]] }}
mass = 1.0
inertia = [0.01, 0.02, 0.02]
center_of_mass = [0, 0, 0.05]
position = [0.0, 0.0, 0.35]
rpy = [0.0, {tilt}, 0.0]
[[contact]]
between = ["bar", "floor"]
friction = {friction}
restitution = {restitution}
[run]
until = 0.6
samples = 30
"""


def bar(tilt: float, friction: float, restitution: float) -> Library:
    """A bar that falls on its lower edge, of which one end is lower by the tilt."""
    text = FALLING.format(tilt=tilt, friction=friction, restitution=restitution)
    return library_of(read_text(text, "bar.toml"))


@pytest.mark.parametrize("seed", range(4))
def test_the_other_order_is_that_of_a_body_turned_by_as_much_as_one_end_is_late(seed: int) -> None:
    random = np.random.default_rng(seed)
    tilt = 10 ** random.uniform(-7, -4)
    numbers = random.uniform(0, 0.5), random.uniform(0.1, 0.7)
    path, mirrored = (simulate(bar(sign * tilt, *numbers)) for sign in (1, -1))
    first, second = path.events[:2]
    schedule = [(float(path.t[-1]), np.zeros(1))]
    other = in_other_order(bar(tilt, *numbers), Accuracy.balanced(), schedule, path, (first, second))
    assert other is not None
    for turned in (other, mirrored):
        assert [event.contact for event in turned.events[:2]] == [second.contact, first.contact]
    soon = path.t < second.t + 0.02
    assert other.p[soon] == pytest.approx(mirrored.p[soon], abs=10 * tilt)


def test_orders_that_lead_to_one_motion_are_no_doubt_and_the_error_covers_both() -> None:
    library = bar(1e-6, 0.3, 0.5)
    path, instance = simulate(library), library.manifest.instance
    tie, errors = (path.events[0], path.events[1]), np.full((4, len(path.t)), 1e-9)

    def shifted_by(size: float) -> tuple[list[str], float]:
        doubts, apart = led_elsewhere(
            path, [tie], errors, lambda _: replace(path, p=path.p + size), instance, 1e-4
        )
        return doubts, float(apart[0].max())

    doubts, apart = shifted_by(1e-7)
    assert not doubts
    assert apart == pytest.approx(1e-7 * np.sqrt(3))
    doubts, apart = shifted_by(1e-3)
    assert "in the other order bodies come 0.0017 m and 0 rad elsewhere" in doubts[0]
    assert apart == 0
    doubts, _ = led_elsewhere(path, [tie], errors, lambda _: None, instance, 1e-4)
    assert "comes first is within the error" in doubts[0]


@pytest.mark.parametrize("seed", [1, 15])
def test_a_box_whose_bounces_settle_in_either_order_is_trusted_within_both(seed: int) -> None:
    tables = drawn("mixed sizes and masses", seed)
    path = simulate(library_of(scene_from_tables("settles", tables, "<drawn>")))
    assert path.is_trusted
    fine = simulate(library_of(scene_from_tables("settles", tables, "<drawn>")), accuracy="tight")
    assert np.abs(path.p - fine.p).max() <= path.position_error[-1] + fine.position_error[-1]


@pytest.mark.parametrize("name", ["box_dropped", "newton_cradle", "bouncing_ellipsoid", "cylinder_dropped"])
def test_shipped_scenes_of_blows_have_a_certain_order(name: str) -> None:
    path = simulate(scene_of(name))
    assert path.estimate is not None
    assert "which of the impacts" not in path.estimate.statement
