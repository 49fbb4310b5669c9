"""Long runs over poles, round a torus and across knots: a change of chart leaves no trace in the motion."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Event, Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.pieces import rotations, solid
from tests.oracles.plain_rows import PlainScene, Rows
from tests.running import library_of, scene_of

LONG = 200.0  # s
WALKS = {"bean_with_poles": 50, "ball_in_torus": 0, "egg_on_spline": 800}  # at least, in so long
TRACE = 1e-12


@cache
def long_run(name: str) -> Trajectory:
    return simulate(scene_of(name), until=LONG, accuracy=Accuracy.balanced(), samples=4000, estimate=False)


@pytest.mark.slow
@pytest.mark.parametrize("name", WALKS)
def test_two_hundred_seconds_keep_energy_and_contact(name: str) -> None:
    path = long_run(name)
    assert path.outcome is Outcome.DONE
    assert path.energy_drift < 1e-7
    assert path.gap_max < 1e-10 * scene_of(name).manifest.instance["scales"]["length"]
    assert path.force[:, 0].min() > 0
    assert {event.kind for event in path.events} <= {"feature-change"}
    assert len(path.events) >= WALKS[name]


@pytest.mark.slow
def test_the_pebble_passes_both_poles() -> None:
    seen = Counter(event.features for event in long_run("bean_with_poles").events)
    assert min(seen["pole_v_min"], seen["pole_v_max"]) > 5


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
    """One contact told on the feature pairs before and after a walk, at the same poses and twists."""

    event: Event
    feature_pairs: tuple[str, str]
    before: Rows
    after: Rows


def told(session: Session, feature_pairs: np.ndarray, eta: np.ndarray) -> Rows:
    """The contacts' rows on these feature pairs at the session's state, from a guess of eta."""
    scene, x, t = PlainScene(session.library, feature_pairs[:-1]), session.x.copy(), float(session.run.t)
    x[-1 - len(eta) : -1] = eta
    return scene.rows(t, scene.corrected(t, x))


@cache
def changes(library: Library, until: float) -> list[Change]:
    """The walks of contact 0 in a run of single steps."""
    session = Session(library, Accuracy.balanced())
    begin(session)
    recording, code, found = Recording(session, np.array([2 * until])), CONTINUE, []
    while code in (CONTINUE, FULL):
        feature_pair, eta = session.feature_pair.copy(), session.eta.copy()
        code = session.advance(until, 1, recording.record)
        for event in session.drain_events():
            if event.kind == "feature-change" and event.contact == session.contacts[0]:
                one, other = (
                    told(session, feature_pair, eta),
                    told(session, session.feature_pair, session.eta),
                )
                names = [
                    session.instance["feature_pairs"][each[0]]["name"]
                    for each in (feature_pair, session.feature_pair)
                ]
                found.append(Change(event, (names[0], names[1]), one, other))
    assert code == 0
    return found


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", ["bean_with_poles", "egg_on_spline"])
def test_a_change_leaves_no_trace(name: str) -> None:
    library = scene_of(name)
    found = changes(library, 10.0)
    bias = max(abs(change.after.bias[0]) for change in found)
    assert len(found) >= 5
    for change in found:
        one, other = change.before, change.after
        assert abs(one.d - other.d)[0] < TRACE * library.manifest.instance["scales"]["length"]
        assert np.abs(one.normal - other.normal).max() < TRACE
        assert np.abs(one.J - other.J).max() < TRACE
        assert abs(one.bias - other.bias)[0] < TRACE * bias


@pytest.mark.parametrize("name", ["bean_with_poles", "egg_on_spline"])
def test_events_name_the_features_before_and_after(name: str) -> None:
    found = changes(scene_of(name), 10.0)
    for change in found:
        assert change.event.features == change.feature_pairs[1]
        assert are_neighbours(*change.feature_pairs)
    for one, other in pairwise(found):
        assert one.feature_pairs[1] == other.feature_pairs[0]


def are_neighbours(one: str, other: str) -> bool:
    """A cell of a patch and the next, or a chart and a cap."""
    if "cell" not in one:
        return "sheet" in {one, other} and one != other
    apart = [abs(int(a) - int(b)) for a, b in zip(one.split("_")[1:], other.split("_")[1:], strict=True)]
    return max(apart) == 1


# ---- one surface in two descriptions ----

PARTS = {"a": 0.06, "c": 0.045}
SPHEROID = make.revolution("a*cos(t)", "c*sin(t)", domain=["-pi/2", "pi/2"], parameters=PARTS)
HOLLOW = {"a": 0.5, "b": 0.45, "c": 0.4}
CAVE = make.chart(
    "a*cos(v)*cos(u)", "b*cos(v)*sin(u)", "c*sin(v)",
    domain=[["-pi", "pi"], ["-pi/2", "pi/2"]], periodic=[True, False], poles=["v_min", "v_max"],
    parameters=HOLLOW, cavity=True,
)  # fmt: skip
TUBE = make.chart(
    "(M + m*cos(v))*cos(u)", "(M + m*cos(v))*sin(u)", "m*sin(v)",
    domain=[["-pi", "pi"]] * 2, periodic=[True, True], parameters={"M": 0.3, "m": 0.1}, cavity=True,
)  # fmt: skip
GRID = [-0.4, -0.22, -0.1, -0.03, 0.04, 0.15, 0.25, 0.4]
BOWL = make.height_field(GRID, GRID, [[x * x / 0.8 + y * y / 1.2 for y in GRID] for x in GRID])
EGG = (0.06, 0.05, 0.045)


def tumbler(shape: Shape) -> Body:
    return make.dynamic(
        "stone", shape, density=1000.0, position=[0.0, 0.0, 0.06], angular_velocity=[9.0, 4.0, 1.0]
    )


def slider(position: list[float], velocity: list[float]) -> Body:
    return solid("stone", EGG, position=position, velocity=velocity, angular_velocity=[1.0, 2.0, 3.0])


PAIRS = {
    "an ellipsoid on a table": (
        [(make.plane(), tumbler(shape)) for shape in (make.ellipsoid(0.06, 0.06, 0.045), SPHEROID)], 4,
    ),
    "an ellipsoidal cavity": (
        [(shape, slider([0.05, 0.02, -0.35], [1.5, 0.8, 0.0]))
         for shape in (make.ellipsoid(0.5, 0.45, 0.4, cavity=True), CAVE)], 2,
    ),
    "a hollow torus": (
        [(shape, slider([0.335, 0.0, 0.0], [0.0, 0.5, 2.5]))
         for shape in (make.torus(0.3, 0.1, cavity=True), TUBE)], 0,
    ),
    "a paraboloid": (
        [(shape, slider([0.15, 0.1, 0.1], [0.0, 0.3, 0.0]))
         for shape in (make.paraboloid(0.4, 0.6), BOWL)], 4,
    ),
}  # fmt: skip


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", PAIRS)
def test_the_motion_does_not_depend_on_how_a_surface_is_told(name: str) -> None:
    told, least = PAIRS[name]
    one, other = (fallen(base, stone) for base, stone in told)
    assert sum(event.kind == "feature-change" for event in other.events) >= least
    assert np.abs(one.p - other.p).max() < 1e-9
    assert np.abs(rotations(one, 1) - rotations(other, 1)).max() < 1e-8
    assert {event.kind for event in one.events} <= {"touch-down"}


def fallen(base: Shape, stone: Body) -> Trajectory:
    """The stone let go above the base, a second of it, tight."""
    scene = make.scene("told", [make.fixed("base", base), stone], contact=[{"between": ["stone", "base"]}])
    return simulate(library_of(scene), until=1.0, accuracy=Accuracy.tight(), samples=100, estimate=False)
