"""The runs of a sweep in threads of this process. The core works in them; Python does what is between."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Queue
from threading import Thread

from modelgen.parameter_study.chunk_runs import Chunk
from modelgen.parameter_study.run_queue import RunQueue, Span

SWITCH_S = 1e-4  # s: longest wait of a thread that comes back from the core for one that works in Python


@contextmanager
def _short_waits() -> Iterator[None]:
    """Let threads of the process wait less long for Python's lock than by its default."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(min(before, SWITCH_S))
    try:
        yield
    finally:
        sys.setswitchinterval(before)


def chunks_of_threads(queue: RunQueue, run: Callable[[Span], Chunk], threads: int) -> Iterator[Chunk]:
    """The chunks that `run` makes of the queued runs, as they come.

    When the caller is interrupted, threads end with the chunk that they are at, and the process need not wait
    for them.
    """
    made: Queue[Chunk | BaseException | None] = Queue()

    def work() -> None:
        try:
            while (span := queue.take()) is not None:
                begun = time.perf_counter()
                chunk = run(span)
                queue.note(span.size, time.perf_counter() - begun)
                made.put(chunk)
            made.put(None)
        except BaseException as error:
            made.put(error)

    with _short_waits():
        for _ in range(threads):
            Thread(target=work, daemon=True).start()
        try:
            left = threads
            while left:
                chunk = made.get()
                if isinstance(chunk, BaseException):
                    raise chunk
                if chunk is None:
                    left -= 1
                else:
                    yield chunk
        finally:
            queue.stop()
