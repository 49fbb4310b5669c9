"""Signals that end a command: none is lost in Python code that catches every exception, as CasADi's does in
conversions, hashes and imports, where a result would then be taken for what it is not."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

ENDING = (signal.SIGINT, signal.SIGTERM)  # signals that end a command
AGAIN = signal.SIGALRM  # raised by this process where Python ignored what one of them raised
PAUSE_S = 1e-3  # s, before that
_heard = 0  # signals so far


def hear_signals() -> None:
    """Let SIGINT and SIGTERM raise KeyboardInterrupt in the main thread, and be counted.

    SIGINT stays ignored where the process was started so, as by `nohup` or in the background of a script.
    Python ignores what is raised in a callback of its garbage collection: then it is raised once more.
    """
    for number in ENDING:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _interrupt)
    signal.signal(AGAIN, _interrupt)
    sys.unraisablehook = _raise_again


def hear_no_more() -> None:
    """Let no signal break into the end of the process: the command is done."""
    for number in (*ENDING, AGAIN):
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


@contextmanager
def cleared(clear: Callable[[], object]) -> Iterator[None]:
    """Clear up at the end of the block, however it ends: twice, since an interruption may break into the
    first time."""
    try:
        try:
            yield
        finally:
            clear()
    finally:
        clear()


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _heard
    _heard += 1
    raise KeyboardInterrupt


def _raise_again(ignored: sys.UnraisableHookArgs) -> None:
    if isinstance(ignored.exc_value, KeyboardInterrupt):
        signal.setitimer(signal.ITIMER_REAL, PAUSE_S)
    else:
        sys.__unraisablehook__(ignored)
