"""Ctrl-C ends a run of many contacts within a step, and what was computed is kept."""

from __future__ import annotations

import os
import signal
import threading
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from modelgen import Accuracy, derive, emit, read, require, sensitivity, simulate, simulate_batch
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, FULL, MANY, Session
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.recording import Recording
from modelgen.runtime.session_group import SessionGroup
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Outcome
from modelgen.scene.read import read_text
from tests.benchmarks.many_contacts import heap
from tests.running import compiled, library_of

FOUND = Path(__file__).parents[1] / "memory" / "scenes"
ENDLESS = 1e6  # s
CALLS_MAX, STEPS_MAX = 300, 100_000  # stopped calls of a run, steps of one call
THROWN = """
[[parameter]]
name = "m"
value = 1.0
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "ball"
shape = { kind = "ellipsoid", semi_axes = [0.1, 0.09, 0.08] }
mass = "m"
inertia = [0.004, 0.005, 0.006]
position = [0, 0, 0.3]
velocity = [1, 0, 0]
[[contact]]
between = ["ball", "floor"]
friction = 0.3
restitution = 0.5
"""
ACCURACY = Accuracy.fast().time_stepping(0.005)


@cache
def library() -> Library:
    return library_of(heap(12))


def begun() -> tuple[Session, Recording]:
    session = Session(library(), ACCURACY)
    begin(session)
    return session, Recording(session, np.array([0.0, 1.0]))


def test_a_stopped_call_takes_no_step_and_goes_on_with_the_same_bits() -> None:
    session, recording = begun()
    other, record_of_other = begun()
    session.stop[0] = 1
    assert session.advance(0.3, 1000, recording.record) == CONTINUE
    assert session.run.t == 0.0
    session.stop[0] = 0
    for each, record in ((session, recording), (other, record_of_other)):
        while each.advance(0.3, 1000, record.record) == CONTINUE:
            each.drain_events()
    assert np.array_equal(session.x, other.x)


def test_a_worker_takes_the_same_steps() -> None:
    session, recording = begun()
    other, record_of_other = begun()
    assert session.n_contact >= MANY
    code = interruptible(lambda: session.advance(0.1, 1000, recording.record), session.stop)
    assert code == other.advance(0.1, 1000, record_of_other.record)
    assert np.array_equal(session.x, other.x)


def test_ctrl_c_ends_the_run_and_keeps_what_was_computed() -> None:
    timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    path = simulate(library(), until=1e4, accuracy=ACCURACY, samples=int(1e5), estimate=False)
    assert path.outcome is Outcome.INTERRUPTED
    assert path.interrupted
    assert len(path.t) > 0
    assert path.t[-1] == path.t_end < 1e4
    assert np.isfinite(path.p).all()


def interrupting(after: float) -> threading.Timer:
    """A timer that presses Ctrl-C once."""
    timer = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


@cache
def thrown(derivatives: bool = False) -> Library:
    """A ball on a floor, whose run does not come to its end in the time of a test."""
    return compiled(emit(derive(require(read_text(THROWN, "thrown.toml"))), derivatives=derivatives))


def test_ctrl_c_ends_a_batch() -> None:
    instance = thrown().manifest.instance
    starts = [np.array([instance[name]] * 3) for name in ("initial_q", "initial_u")]
    interrupting(0.5)
    with pytest.raises(KeyboardInterrupt):
        simulate_batch(thrown(), *starts, until=ENDLESS)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_a_group_that_can_go_on(threads: int) -> None:
    group, other = (SessionGroup(thrown(), n=3) for _ in range(2))
    group.begin(), other.begin()
    interrupting(0.5)
    with pytest.raises(KeyboardInterrupt):
        group.advance(ENDLESS, threads)
    assert np.all(group.t < ENDLESS)
    came = float(group.t.max()) + 1.0
    for each in (group, other):
        each.advance(came, threads)
        assert np.all(each.codes == 0)
        assert np.all(each.t == came)
    assert np.allclose(group.x, other.x, rtol=0, atol=1e-4)  # at `balanced`, of a ball that rolls for long


def test_ctrl_c_ends_derivatives() -> None:
    library = thrown(True)  # built before: CasADi catches every exception
    interrupting(0.5)
    with pytest.raises(KeyboardInterrupt):
        sensitivity(library, ENDLESS, of=["ball.position"], by=["m", "ball.velocity"])


def test_a_start_that_was_stopped_begins_again_with_the_same_bits() -> None:
    library = library_of(read(FOUND / "pyramid32_on_l.toml"))
    session, other = (Session(library, Accuracy.balanced()) for _ in range(2))
    session.stop[0] = 1
    assert session.begin() == CONTINUE
    session.stop[0], session.x[:] = 0, other.x
    assert session.begin() == other.begin() == 0
    assert np.array_equal(session.x, other.x)
    assert np.array_equal(session.feature_pair, other.feature_pair)


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(12))
def test_a_run_that_is_stopped_often_misses_nothing(seed: int) -> None:
    """Stopped at random instants, in steps, searches and solves, and continued, a run ends where one that is
    not stopped does."""
    name = ("box_on_round_table", "stool_on_floor", "light_rim", "prism9_on_box")[seed % 4]
    library, random = library_of(read(FOUND / f"{name}.toml")), np.random.default_rng(seed)
    session, other = (Session(library, Accuracy.balanced()) for _ in range(2))
    until = min(0.3, library.manifest.instance["run"]["until"])
    for each in (session, other):
        begin(each)
    over = threading.Event()

    def stop_often() -> None:
        while not over.wait(float(random.exponential(2e-3))):
            session.stop[0] = 1

    stopping, calls = threading.Thread(target=stop_often), 0
    stopping.start()
    code = CONTINUE
    while code in (CONTINUE, FULL):
        session.stop[0], calls = 0, calls + 1
        if calls > CALLS_MAX:
            over.set(), stopping.join()
            session.stop[0] = 0
        code = session.advance(until, STEPS_MAX, session.tables.Record())
        session.drain_events()
    over.set(), stopping.join()
    while (expected := other.advance(until, STEPS_MAX, other.tables.Record())) in (CONTINUE, FULL):
        other.drain_events()
    assert code == expected
    assert session.doubts(session.run, code) == other.doubts(other.run, expected)
    n = library.manifest.instance["n_q"]
    assert np.allclose(session.x[:n], other.x[:n], rtol=0, atol=1e-5)
