"""Calls of the core that Ctrl-C ends within a solve: Python hears it only between calls of the core."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from typing import Any, Protocol

from modelgen.runtime.core_session import Session


class Advance(Protocol):
    def __call__(self, t_stop: float, max_steps: int, record: Any) -> int: ...


@contextmanager
def interruptible(session: Session) -> Iterator[Advance]:
    """`session.advance` in a thread of its own, so that KeyboardInterrupt ends a call soon.

    The interrupted session keeps its `stop` set: it takes no more steps.
    """
    with ThreadPoolExecutor(max_workers=1) as worker:

        def advance(t_stop: float, max_steps: int, record: Any) -> int:
            call = worker.submit(session.advance, t_stop, max_steps, record)
            try:
                return call.result()
            except KeyboardInterrupt:
                session.stop[0] = 1
                while not call.done():
                    try:
                        wait([call])
                    except KeyboardInterrupt:  # pressed again: the core ends its call as soon as it can
                        continue
                raise

        yield advance
