"""The runs of a sweep that are still to be done, handed out in chunks."""

from __future__ import annotations

from collections.abc import Iterable
from threading import Lock
from typing import NamedTuple

FIRST = 1  # runs of a chunk, until it is known how long a run takes
GROWTH = 2  # times the largest chunk so far: larger ones would let all workers wait for the same one
CHUNK_S = 2.0  # time that a chunk shall take, s: what an interruption loses
MOST = 512  # runs of a chunk
LEAST_S = 0.03  # shorter chunks, s, cost more than workers that end at different times
LAST = 3  # chunks of each worker into which the rest is divided, but for such


class Span(NamedTuple):
    first: int
    size: int


class RunQueue:
    """Runs that nobody has taken yet."""

    def __init__(self, runs: int, done: Iterable[Span], workers: int) -> None:
        self._spans = _gaps(runs, done)
        self._workers, self._lock = max(workers, 1), Lock()
        self._seconds: float | None = None  # of a run
        self._largest = 0  # chunk so far

    def take(self) -> Span | None:
        """The next chunk; None where none is left."""
        with self._lock:
            if not self._spans:
                return None
            first, count = self._spans[0]
            size = min(self._size(), count)
            self._largest = max(self._largest, size)
            if size == count:
                self._spans.pop(0)
            else:
                self._spans[0] = Span(first + size, count - size)
            return Span(first, size)

    def note(self, count: int, seconds: float) -> None:
        """Note how long a chunk took."""
        with self._lock:
            self._seconds = seconds / count

    def stop(self) -> None:
        """Hand out nothing more."""
        with self._lock:
            self._spans.clear()

    def _size(self) -> int:
        if self._seconds is None:
            return FIRST
        left = sum(count for _, count in self._spans)
        even = left // (LAST * self._workers)
        least, most = (int(min(span / self._seconds, MOST)) for span in (LEAST_S, CHUNK_S))
        return max(1, min(max(even, least), most, GROWTH * self._largest))


def _gaps(runs: int, done: Iterable[Span]) -> list[Span]:
    """The runs that are not done."""
    gaps, at = [], 0
    for first, count in sorted(done):
        if first > at:
            gaps.append(Span(at, first - at))
        at = max(at, first + count)
    return [*gaps, Span(at, runs - at)] if at < runs else gaps
