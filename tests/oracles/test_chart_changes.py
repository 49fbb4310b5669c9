"""Long runs over poles, round a torus and across knots: a change of chart leaves no trace in the motion."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.recording import Recording
from modelgen.runtime.session import CONTINUE, FULL, Session
from modelgen.runtime.trajectory import Event, Outcome, Trajectory
from modelgen.scene import build as make
from modelgen.scene.types import Body, Shape
from tests.oracles.pieces import rotations, solid
from tests.oracles.plain_rows import PlainScene, Rows
from tests.running import library_of, scene_of

LONG = 200.0  # s
WALKS = {"bean_with_poles": 100, "ball_in_torus": 0, "egg_on_spline": 800}  # at least, in so long
TRACE = 1e-12


@cache
def long_run(name: str) -> Trajectory:
    return simulate(scene_of(name), until=LONG, accuracy=Accuracy.balanced(), samples=4000)


@pytest.mark.slow
@pytest.mark.parametrize("name", WALKS)
def test_two_hundred_seconds_keep_energy_and_contact(name: str) -> None:
    path = long_run(name)
    assert path.outcome is Outcome.DONE
    assert path.energy_drift < 1e-7
    assert path.gap_max < 1e-10 * scene_of(name).manifest.sentence["scales"]["length"]
    assert path.force[:, 0].min() > 0
    assert {event.kind for event in path.events} <= {"walk"}
    assert len(path.events) >= WALKS[name]


@pytest.mark.slow
def test_the_pebble_passes_both_poles() -> None:
    seen = Counter(event.features for event in long_run("bean_with_poles").events)
    assert min(seen["pole_v_min"], seen["pole_v_max"]) > 20


@pytest.mark.slow
def test_the_ball_visits_all_regions_of_the_torus() -> None:
    x, y, z = np.moveaxis(long_run("ball_in_torus").points_f[:, 0], -1, 0)
    around_tube = np.arctan2(z, np.hypot(x, y) - 0.3)
    for angle in (around_tube, np.arctan2(y, x)):
        assert np.histogram(angle, 8, (-np.pi, np.pi))[0].min() > len(x) / 40


@pytest.mark.slow
def test_the_egg_crosses_knots_of_both_directions() -> None:
    seen = {event.features for event in long_run("egg_on_spline").events}
    assert len({name.split("_")[1] for name in seen}) >= 4
    assert len({name.split("_")[2] for name in seen}) >= 3


# ---- what is kept at one change ----


@dataclass(frozen=True)
class Change:
    """One contact told on the links before and after a walk, at the same poses and twists."""

    event: Event
    links: tuple[str, str]
    before: Rows
    after: Rows
    normals: tuple[np.ndarray, np.ndarray]


def changes(library: Library, until: float) -> list[Change]:
    """The walks of contact 0 in a run of single steps."""
    session = Session(library, Accuracy.balanced())
    session.begin()
    record, code, found = Recording(session, np.array([2 * until])).record, CONTINUE, []
    while code in (CONTINUE, FULL):
        link, eta = session.link.copy(), session.eta.copy()
        code = session.advance(until, 1, record)
        for event in session.drain_events():
            if event.kind == "walk" and event.contact == session.contacts[0]:
                found.append(told_twice(session, event, link, eta))
    assert code == 0
    return found


def told_twice(session: Session, event: Event, link: np.ndarray, eta: np.ndarray) -> Change:
    rows, normals = [], []
    for links, start in ((link, eta), (session.link, session.eta)):
        scene, x = PlainScene(session.library, links[:-1]), session.x.copy()
        x[-1 - len(eta) : -1] = start
        x = scene.corrected(float(session.run.t), x)
        rows.append(scene.rows(float(session.run.t), x))
        contact = scene.contacts[0]
        pose = scene.states(float(session.run.t), x).pose
        name = scene.kind("contact", contact)["name"]
        sides = pose[contact["o"]], pose[contact["f"]]
        normals.append(scene._call(f"{name}_place", *sides, x[scene.eta_of(contact)], contact["parameters"])[4])
    names = [session.sentence["links"][each[0]]["name"] for each in (link, session.link)]
    return Change(event, (names[0], names[1]), rows[0], rows[1], (normals[0], normals[1]))


@cache
def changes_of(name: str) -> list[Change]:
    return changes(scene_of(name), 10.0)


@pytest.mark.parametrize("name", ["bean_with_poles", "egg_on_spline"])
def test_a_change_leaves_no_trace(name: str) -> None:
    length = scene_of(name).manifest.sentence["scales"]["length"]
    found = changes_of(name)
    bias = max(abs(change.after.bias[0]) for change in found)
    assert len(found) >= 5
    for change in found:
        assert abs(change.after.d[0] - change.before.d[0]) < TRACE * length
        assert np.abs(change.normals[1] - change.normals[0]).max() < TRACE
        assert np.abs(change.after.J - change.before.J).max() < TRACE
        assert abs(change.after.bias[0] - change.before.bias[0]) < TRACE * bias
