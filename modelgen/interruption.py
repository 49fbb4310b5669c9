"""Signals that end a command: none is lost in Python code that catches every exception, as CasADi's does in
conversions, hashes and imports, where a result would then be taken for what it is not."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_heard = 0  # signals so far


def hear_signals() -> None:
    """Let SIGINT and SIGTERM raise KeyboardInterrupt in the main thread, and be counted.

    SIGINT stays ignored where the process was started so, as by `nohup` or in the background of a script.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _interrupt)


def hear_no_more() -> None:
    """Let no signal break into the end of the process: the command is done."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


def was_heard() -> bool:
    """Whether a signal came."""
    return _heard > 0


@contextmanager
def nothing_swallowed() -> Iterator[None]:
    """Raise KeyboardInterrupt at the end of the block if it was raised within and caught there."""
    before = _heard
    yield
    if _heard != before:
        raise KeyboardInterrupt


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _heard
    _heard += 1
    raise KeyboardInterrupt
