"""Standard streams that end the command quietly once nobody reads them, as `head` does when it has enough."""

from __future__ import annotations

import io
import os
import sys
from typing import NoReturn

CLOSED = 141  # 128 and the number of SIGPIPE, as shells have it


class Output(io.TextIOWrapper):
    """A stream whose closed pipe raises SystemExit, and which loses what is written from then on."""

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except BrokenPipeError:
            self._end()

    def flush(self) -> None:
        try:
            super().flush()
        except BrokenPipeError:
            self._end()

    def _end(self) -> NoReturn:
        os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
        raise SystemExit(CLOSED)


def guard_streams() -> None:
    """Let standard output and standard error be such streams."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            encoding, errors, by_line = stream.encoding, stream.errors, stream.line_buffering
            at_once, raw = stream.write_through, stream.detach()
            output = Output(raw, encoding, errors, line_buffering=by_line, write_through=at_once)
            setattr(sys, name, output)
