"""Ctrl-C ends a run of many contacts within a step, and what was computed is kept."""

from __future__ import annotations

import os
import signal
import threading
from functools import cache

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, Session
from modelgen.runtime.interruptible_advance import interruptible
from modelgen.runtime.recording import Recording
from modelgen.runtime.simulate import MANY_CONTACTS
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Outcome
from tests.benchmarks.many_contacts import heap
from tests.running import library_of

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
    assert session.n_contact >= MANY_CONTACTS
    with interruptible(session) as advance:
        assert advance(0.1, 1000, recording.record) == other.advance(0.1, 1000, record_of_other.record)
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
