"""Calls of the core that Ctrl-C ends early: Python hears it only between calls of the core."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from threading import current_thread, main_thread
from typing import TypeVar

from modelgen.runtime.tables.ctypes_structures import Array

Result = TypeVar("Result")
_worker: ThreadPoolExecutor | None = None  # of the main thread, which makes one call at a time


def _forget_worker() -> None:
    global _worker
    _worker = None


os.register_at_fork(after_in_child=_forget_worker)


def interruptible(call: Callable[[], Result], *stops: Array) -> Result:
    """The result of a call of the core, made in a thread beside the main one, which hears Ctrl-C.

    KeyboardInterrupt sets the `stop` of the runs, so that the call ends soon, and is raised after it. They
    stay set: who goes on with the runs clears them. In other threads, to which no signals come, it is a
    plain call.
    """
    global _worker
    if current_thread() is not main_thread():
        return call()
    if _worker is None:
        _worker = ThreadPoolExecutor(max_workers=1)
    made = _worker.submit(call)
    try:
        return made.result()
    except KeyboardInterrupt:
        for stop in stops:
            stop[:] = 1
        while not made.done():
            try:
                wait([made])
            except KeyboardInterrupt:  # pressed again: the core ends its call as soon as it can
                continue
        raise
