"""What a run costs: CPU time of the core alone, the least of several runs, beside a yardstick."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.recording import Recording
from modelgen.runtime.session import CONTINUE, FULL, Session

REPEATS, ENOUGH_S = 9, 0.15  # runs of one setting, and the time after which three are enough
CHUNK = 20_000  # steps between two looks at the keyboard
YARD = 400  # steps of the yardstick


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time of one run, s: the least; its noise; and the least of the yardstick in between, s."""

    seconds: float
    noise: float | None  # median over least, less one; None for a single run
    yard: float


def core_time(library: Library, accuracy: Accuracy, until: float, steps: int | None = None) -> float:
    """CPU seconds of this thread in the core, from a settled start to the end, or for some steps."""
    session = Session(library, accuracy)
    session.begin()
    recording = Recording(session, np.array([until]))
    begun = time.thread_time()
    while session.advance(until, steps or CHUNK, recording.record) in (CONTINUE, FULL) and steps is None:
        session.events.count = 0
    return time.thread_time() - begun


def cost_of(run: Callable[[], float], yard: Callable[[], float]) -> Cost:
    """Runs and yardstick in turn, so that a slower machine slows both; few runs where one is long."""
    spent, yards = [run()], [yard()]
    while len(spent) < REPEATS and (sum(spent) < ENOUGH_S or len(spent) < 3) and sum(spent) < 10 * ENOUGH_S:
        spent.append(run())
        yards.append(yard())
    noise = median(spent) / min(spent) - 1 if len(spent) > 1 else None
    return Cost(min(spent), noise, min(yards))
