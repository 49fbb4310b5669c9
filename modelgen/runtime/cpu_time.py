"""CPU time of the core alone, in a run without samples."""

from __future__ import annotations

import time

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.start import begin

CHUNK = 20_000  # steps between two looks at the keyboard


def core_time(library: Library, accuracy: Accuracy, until: float, steps: int | None = None) -> float:
    """CPU seconds of the core from a settled start to the end, or for a number of steps."""
    session = Session(library, accuracy)
    begin(session)
    recording = Recording(session, np.array([until]))
    begun = time.thread_time()
    while session.advance(until, steps or CHUNK, recording.record) in (CONTINUE, FULL) and steps is None:
        session.events.count = 0
    return time.thread_time() - begun
