"""A run advanced in many calls is the run that one call makes: events, errors, steps; no call allocates."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.trajectory import SEARCH_EVENTS, Event
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import heap
from tests.c_compiler import needs_c
from tests.oracles import test_flat_places as flat_places
from tests.running import NAMES, library_of, scene_of
from tests.runtime.c_programs import program_of

BALANCED, TIGHT = Accuracy.balanced(), Accuracy.tight()
LONGEST = 1.0  # s: how much of a run is compared
SLIP = ("slip-stop", "slip-reversal")  # slip is stopped a little before, and told where it would have stopped


@dataclass
class Ran:
    session: Session
    events: list[Event]
    code: int


def ran(scene: str | Scene, accuracy: Accuracy, stops: Iterable[float]) -> Ran:
    """A run of a scene, of a shipped one by its name, in one call for each stop."""
    session = Session(scene_of(scene) if isinstance(scene, str) else library_of(scene), accuracy)
    assert session.begin() == 0
    record, events, code = session.tables.Record(), list[Event](), 0
    for stop in stops:
        code = FULL
        while code == FULL:
            code = session.advance(float(stop), 10**8, record)
            events += session.drain_events()
        if code:
            break
    return Ran(session, events, code)


def span_of(name: str) -> float:
    return min(float(scene_of(name).manifest.instance["run"]["until"]), LONGEST)


def stops_of(name: str, n: int) -> list[float]:
    return [span_of(name) * (k + 1) / n for k in range(n)]


@cache
def whole(name: str, accuracy: Accuracy) -> Ran:
    return ran(name, accuracy, stops_of(name, 1))


def located(run: Ran) -> list[Event]:
    return [event for event in run.events if event.kind not in SEARCH_EVENTS]


def order(run: Ran) -> list[tuple[str, str]]:
    return [(event.kind, event.contact) for event in located(run)]


def latest(one: Ran, other: Ran, slip: bool) -> float:
    """The largest difference of the times of events of slip, or of the others, s."""
    both = zip(located(one), located(other), strict=True)
    return max((abs(a.t - b.t) for a, b in both if (a.kind in SLIP) == slip), default=0.0)


def error(run: Ran, truth: Ran) -> float:
    n_q = run.session.instance["n_q"]
    return float(np.abs(run.session.x[:n_q] - truth.session.x[:n_q]).max())


@pytest.mark.cases(4)
@pytest.mark.parametrize(("name", "n"), [(name, n) for n in (7, 1000) for name in NAMES])
def test_many_calls_make_the_run_of_one(name: str, n: int) -> None:
    """Errors are less than twice those of one call, beside ten local errors of a step. So are those of
    events, where the truth has the same events; slip stops within slip_speed."""
    one, many, truth = whole(name, BALANCED), ran(name, BALANCED, stops_of(name, n)), whole(name, TIGHT)
    scales = one.session.instance["scales"]
    assert (one.code, many.code) == (0, 0)
    assert many.session.run.t == one.session.run.t == span_of(name)
    assert error(many, truth) <= 2 * error(one, truth) + 10 * BALANCED.tolerance * scales["length"]
    if order(one) == order(truth):
        assert order(many) == order(one)
        slack = 10 * BALANCED.tolerance * scales["time"]
        assert latest(many, truth, False) <= 2 * latest(one, truth, False) + slack
        assert (
            latest(many, truth, True) <= 2 * latest(one, truth, True) + BALANCED.slip_speed * scales["time"]
        )


FLAT_SHOE = """
gravity = [0.0, 0.0, -10.0]
[[body]]
name = "belt"
motion = "driven"
shape = { kind = "plane" }
path = { position = ["0.1*sin(2*pi*t)", 0.0, 0.0] }
[[body]]
name = "shoe"
shape = { kind = "box", size = [0.03, 0.02, 0.01] }
density = 1000.0
position = [0.0, 0.0, 0.005]
[[joint]]
kind = "cylindrical"
between = ["world", "shoe"]
[[contact]]
between = ["shoe", "belt"]
friction = 0.3
"""


@pytest.mark.parametrize("before", [0.0, 1e-15, 1e-12, 1e-9, 1e-8, 1.5e-8, 1e-7])  # s
@pytest.mark.parametrize("shoe", ["round", "flat"])
def test_a_stop_at_a_reversal_of_slip_makes_no_second_one(shoe: str, before: float) -> None:
    """The belt prescribes the slip, which reverses at 0.25 s and 0.75 s: no impulse can take away what is
    left of it where the reversal is seen, up to slip_speed."""
    scene = "brake_shoe" if shoe == "round" else read_text(FLAT_SHOE, "shoe.toml")
    stops = [0.25 - before, 0.25 + before, 0.75 - before, 0.75 + before, 1.0]
    events = [event for event in ran(scene, BALANCED, stops).events if event.kind != "face-contact"]
    assert [event.kind for event in events] == ["slip-reversal"] * 2
    assert [event.t for event in events] == pytest.approx([0.25, 0.75], abs=1e-12)


@pytest.mark.cases(8)
@pytest.mark.parametrize("name", NAMES)
def test_the_sequence_of_steps_resumes_after_a_stop(name: str) -> None:
    """A stop costs the step that it cuts and little more: the next one is as long as if it were not there."""
    one, many = whole(name, BALANCED).session.run, ran(name, BALANCED, stops_of(name, 7)).session.run
    assert many.steps + many.rejected <= one.steps + one.rejected + 3 * 7


@pytest.mark.cases(4)
@pytest.mark.parametrize("accuracy", [BALANCED, Accuracy(method="rk4", step=1e-3)], ids=lambda a: a.method)
@pytest.mark.parametrize("name", ["ellipsoid_on_plane", "four_bar", "gears", "bouncing_ellipsoid"])
def test_calls_for_a_number_of_steps_change_no_bit(name: str, accuracy: Accuracy) -> None:
    one, many = (Session(scene_of(name), accuracy) for _ in range(2))
    record = one.tables.Record()
    for session, steps in ((one, 10**8), (many, 1)):
        assert session.begin() == 0
        while session.advance(0.4, steps, record):
            session.events.count = 0
    assert many.save() == one.save()


def test_a_fallback_lasts_as_long_when_it_is_chopped() -> None:
    one = whole("painleve_rod", BALANCED).session.run
    assert one.report.fallbacks == 1
    step = BALANCED.thresholds.fallback_step * scene_of("painleve_rod").manifest.instance["scales"]["time"]
    fine = [*np.arange(step / 10, one.fallback_end + 10 * step, step / 10), 1.0]
    many = ran("painleve_rod", BALANCED, fine).session.run
    assert many.report.fallbacks == 1
    assert many.report.fallback_time == pytest.approx(one.report.fallback_time, abs=0.6 * step)


def test_a_stop_just_after_a_step_takes_no_step_of_its_own() -> None:
    """One unit in the last place after the end of a step: time is not resolved so far."""
    accuracy, n = Accuracy(method="time-stepping", step=1e-3), 300
    stops = [np.nextafter(1e-3 * (k + 1), 1.0) for k in range(n)]
    run = ran("box_dropped", accuracy, stops)
    assert run.session.run.steps == n
    assert run.session.run.t == stops[-1]


SPRING = {"between": ["s0", "s11"], "rest_length": 0.2, "stiffness": 50.0, "damping": 1.0}


@pytest.mark.parametrize("springs", [[], [SPRING]], ids=["by its graph", "by its matrix"])
def test_a_heap_is_the_same_bit_for_bit_in_calls_of_few_steps(springs: list[dict[str, object]]) -> None:
    """Impulses of its island are sought from those of the step before."""
    scene = make.scene("pile", heap(12).bodies, contacts={"between": "all", "friction": 0.5}, spring=springs)
    one, many = (Session(library_of(scene), Accuracy.fast().time_stepping(0.004)) for _ in range(2))
    for session, steps in ((one, 10**8), (many, 7)):
        record = session.tables.Record()
        assert session.begin() == 0
        while session.advance(0.4, steps, record):
            session.events.count = 0
    assert many.save() == one.save()


def test_short_calls_are_no_slow_progress() -> None:
    """A run falls back where many tries hardly advance it; stops are no such tries."""
    period = scene_of("bouncing_ball").manifest.instance["scales"]["time"]
    run = ran("bouncing_ball", BALANCED, [1e-8 * period * k for k in range(1, 5000)])
    assert run.code == 0
    assert run.session.run.report.fallbacks == 0
    assert run.session.run.steps == 4999


COUNTED = """
#include <stddef.h>
#include <stdio.h>
static long allocations;
static _Alignas(16) unsigned char arena[1 << 20];
static size_t used;
void *malloc(size_t n) {{
  allocations++;
  const size_t at = used;
  used += (n + 15) / 16 * 16;
  return used <= sizeof arena ? arena + at : NULL;
}}
void *calloc(size_t n, size_t size) {{ return malloc(n * size); }}
void *realloc(void *old, size_t n) {{ (void)old; return malloc(n); }}
void free(void *at) {{ (void)at; allocations++; }}
int main(void) {{
  static unsigned char state[{size}];
  mg_record none = {{0}};
  mg_run *run = &the_run;
  the_system.kernels = mg_kernel_table();
  void *volatile probe = malloc(1);
  if (!probe || allocations != 1) return 1;
  allocations = 0;
  if (mg_begin(&the_system, &the_settings, &the_run, &the_events, work, iwork)) return 2;
  for (int k = 1; k <= 300; k++) {{
    int code;
    do {{
      the_events.count = 0;
      code = mg_advance(&the_system, &the_settings, run, k * 1e-3, 1000, &none, &the_events, work, iwork);
    }} while (code == MG_CONTINUE || code == MG_LIST_FULL);
    if (code) return 3;
  }}
  mg_save(&the_system, &the_settings, &the_run, state);
  if (mg_load(&the_system, &the_settings, &the_run, state, (long)sizeof state)) return 4;
  return allocations ? 5 : 0;
}}
"""


@needs_c
@pytest.mark.cases(1)
@pytest.mark.parametrize("name", ["gears", "sliding_puck"])
def test_no_call_allocates_memory(name: str, tmp_path: Path) -> None:
    program = program_of(name, tmp_path, COUNTED, BALANCED)
    assert subprocess.run([program], check=False).returncode == 0


def test_a_stop_within_a_singular_passage_does_not_end_the_run() -> None:
    """The passage of a place without curvature pauses at the stop, and goes on from there."""
    library = flat_places.library(flat_places.superellipsoid(), "rocker")
    until, inside = 0.12, list[float]()
    one = Session(library, BALANCED)
    record = one.tables.Record()
    assert one.begin() == 0
    code = CONTINUE
    while code == CONTINUE:
        before, passed = float(one.run.t), one.run.report.singular_passages
        code = one.advance(until, 1, record)
        if one.run.report.singular_passages > passed:
            inside += [before + (one.run.t - before) * part for part in (1e-3, 0.1, 0.5, 0.9, 0.999)]
    assert code == 0
    assert len(inside) >= 5
    for stop in inside:
        many = Session(library, BALANCED)
        assert many.begin() == many.advance(stop, 10**8, record) == 0
        assert many.run.t == stop
        assert many.advance(until, 10**8, record) == 0
        assert many.run.report.singular_passages == one.run.report.singular_passages
        assert many.x == pytest.approx(one.x, abs=1e-7)
