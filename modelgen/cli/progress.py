"""Progress on standard error: a bar on a terminal, elsewhere a line from time to time."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import click

INTERVAL = 10.0  # s between two lines where standard error is no terminal; shorter work prints none


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Shows the share of the work that is done, from 0 to 1; before the first share, that work goes on."""
    if not sys.stderr.isatty():
        line = _lines()
        yield lambda share: line(f"{label}: {100 * share:.0f} %")
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda share: bar.update(task, total=1.0, completed=share)


@contextmanager
def activity(label: str) -> Iterator[Callable[[str], None]]:
    """Shows what is being done, in words."""
    if not sys.stderr.isatty():
        yield _lines()
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns: tuple[Any, ...] = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda text: bar.update(task, description=text)


def _lines() -> Callable[[str], None]:
    """Prints a text if none was printed, and nothing began, within the last INTERVAL."""
    last = time.monotonic()

    def line(text: str) -> None:
        nonlocal last
        if time.monotonic() - last >= INTERVAL:
            last = time.monotonic()
            click.echo(text, err=True)

    return line
