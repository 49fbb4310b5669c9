"""The first step of a face that begins to roll, cut short: by the end of the run, by steps from outside, by
an event of another body, by a load that is switched."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, hypot, sin

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.planar.scenes import HEIGHT, MASS, RADIUS, TIGHT, G, events, standing, table
from tests.running import library_of

BALANCED = Accuracy.balanced()
TIP = RADIUS * MASS * G / (0.03 * hypot(2.0, 0.4))  # s; of the glass
LAST = 0.03  # s after it, the last sample


def glass_pushed(
    force: Sequence[str] = ("2.0*t", "0.4*t", "0"), *others: Body, shape: Shape | None = None
) -> Library:
    body = standing(shape or make.cylinder(RADIUS, HEIGHT))
    scene = make.scene(
        "first_step", [table(), body, *others],
        contact=[{"between": [each.name, "table"]} for each in (body, *others)],
        force=[{"body": "body", "force": list(force), "point": [0, 0, 0.03]}],
        torque=[{"body": "body", "torque": ["0", "0", "0.0004"]}],
    )  # fmt: skip
    return library_of(scene)


def stepped(
    library: Library, stops: Sequence[float], times: Sequence[float]
) -> tuple[Session, dict[str, np.ndarray]]:
    """A run stopped at each of `stops`, with its samples at `times`."""
    session = Session(library, TIGHT)
    begin(session)
    recording = Recording(session, np.array(times))
    for stop in stops:
        assert session.advance(stop, 100_000, recording.record) == 0
    return session, recording.columns()


def apart(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> float:
    """Of the glass, body 1: m and rad."""
    return float(max(np.abs(a[name][:, 1] - b[name][:, 1]).max() for name in ("p", "quaternion")))


AFTER = [0.0, 1e-7, 1e-5, 1e-4, 1e-3, 3e-3, 0.012]


@pytest.mark.cases(1)
@pytest.mark.parametrize("shape", ["circle", "ellipse"])
def test_a_run_may_end_as_soon_as_it_likes_after_a_face_has_begun_to_roll(shape: str) -> None:
    """As the same run that goes on; once in steps of those lengths, too."""
    numbers = {"a": 0.04, "b": 0.03}
    ellipse = make.extrusion(HEIGHT, x="a*cos(t)", y="b*sin(t)", domain=["-pi", "pi"], parameters=numbers)
    library = glass_pushed(shape=ellipse if shape == "ellipse" else None)
    path = simulate(library, until=2.5, accuracy=TIGHT, estimate=False)
    times = [events(path, "tipping")[0].t + after for after in AFTER]
    _, whole = stepped(library, [times[-1] + LAST], [*times, times[-1] + LAST])
    session, parts = stepped(library, [*times, times[-1] + LAST], [*times, times[-1] + LAST])
    assert apart(whole, parts) < 1e-12
    assert [event.kind for event in session.drain_events()] == ["face-contact", "tipping"]
    for number, end in enumerate(times):
        _, one = stepped(library, [end], [end])
        assert apart({name: whole[name][number : number + 1] for name in ("p", "quaternion")}, one) < 1e-12


def test_a_glass_that_begins_to_roll_may_be_stepped_from_outside() -> None:
    library = glass_pushed()
    times = [TIP + LAST * share for share in (0.1, 0.4, 0.7, 1.0)]
    _, whole = stepped(library, times[-1:], times)
    stops = [*np.arange(TIP - 0.01, times[-1], 5e-4).tolist(), times[-1]]
    session, parts = stepped(library, stops, times)
    assert apart(whole, parts) < 1e-12
    assert [event.kind for event in session.drain_events()] == ["face-contact", "tipping"]


def test_samples_are_right_in_a_first_step_that_an_event_ends() -> None:
    """A ball lands elsewhere 4.5e-4 s after the tip."""
    height = 0.5 * G * (TIP + 4.5e-4) ** 2 + 0.03
    ball = standing(make.sphere(0.03), "ball", position=[0.0, 2.0, float(height)])
    times = [TIP + after for after in (1e-4, 2e-4, 3e-4, 4e-4, 1e-3, 1e-2)]
    _, alone = stepped(glass_pushed(), times[-1:], times)
    session, both = stepped(glass_pushed(("2.0*t", "0.4*t", "0"), ball), times[-1:], times)
    assert [event.kind for event in session.drain_events()] == ["face-contact", "tipping", "touch-down"]
    assert apart(alone, both) < 1e-11


def pushed_to(library: Library, end: float, accuracy: Accuracy) -> Trajectory:
    path = simulate(library, until=end, samples=4, accuracy=accuracy, estimate=False)
    kinds = [event.kind for event in path.events if event.kind != "load-switch"]
    assert kinds == ["face-contact", "tipping"]
    return path


@pytest.mark.parametrize("after", [1e-4])
def test_a_load_that_is_switched_on_while_a_glass_begins_to_roll_is_not_missed(after: float) -> None:
    """Nothing rubs: across the table the glass goes as its forces say, exactly."""
    start = TIP + after
    library = glass_pushed(("2.0*t", f"0.4*t + 0.15*(1 + sign(t - {start!r}))", "0"))
    end = TIP + 0.05
    coarse, fine = (pushed_to(library, end, accuracy) for accuracy in (BALANCED, TIGHT))
    y = 0.4 * end**3 / (6 * MASS) + 0.3 * (end - start) ** 2 / (2 * MASS)
    assert coarse.p[-1, 1, 1] == pytest.approx(y, abs=1e-10)
    assert fine.p[-1, 1, 1] == pytest.approx(y, abs=1e-12)
    assert coarse.quaternion[-1, 1] == pytest.approx(fine.quaternion[-1, 1], abs=2e-9)


@pytest.mark.parametrize("force", [3.95])  # N; from 3.924 N on it tips
@pytest.mark.parametrize("start", [0.5])
def test_a_glass_tips_at_once_where_a_load_is_switched_on_that_tips_it(force: float, start: float) -> None:
    switch = f"(1 + sign(t - {start!r}))/2"
    library = glass_pushed((f"{force * cos(2.0)!r}*{switch}", f"{force * sin(2.0)!r}*{switch}", "0"))
    coarse, fine = (pushed_to(library, start + 0.05, accuracy) for accuracy in (BALANCED, TIGHT))
    for path in (coarse, fine):
        assert events(path, "tipping")[0].t == pytest.approx(start, abs=1e-13)
    assert coarse.quaternion[-1, 1] == pytest.approx(fine.quaternion[-1, 1], abs=2e-9)


def test_a_frustum_tips_on_a_can_that_is_named_after_it() -> None:
    """So its rim and the faces name their bodies in different orders."""
    time = RADIUS * MASS * G / (20 * 0.03)
    can = make.fixed("table", make.cylinder(0.25, 0.1, position=[0, 0, -0.05]))
    body = standing(make.frustum(RADIUS, 0.05, HEIGHT))
    load = {
        "body": "body",
        "force": [f"{20 * cos(1.0)!r}*t", f"{20 * sin(1.0)!r}*t", "0"],
        "point": [0, 0, 0.03],
    }
    library = library_of(
        make.scene("named", [can, body], contact=[{"between": ["body", "table"]}], force=[load])
    )
    path = pushed_to(library, time + 0.02, BALANCED)
    assert events(path, "tipping")[0].t == pytest.approx(time, abs=1e-9)
    assert path.energy_drift < 1e-12
    assert path.incomplete_searches == 0  # the apex, where the cone has no normal, is not on the frustum
